// Runs a fuzz target without libFuzzer: every file of the folders named, as it is and, so that the smoke run
// tries more than what is known, with seeded damage. Usage: TARGET [--damaged N] FOLDER...
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "tests/fuzz/FuzzTarget.h"

namespace {

using Bytes = std::vector<std::uint8_t>;

/// splitmix64: the same damage on every machine.
std::uint64_t next(std::uint64_t& state) {
    std::uint64_t z = (state += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
}

Bytes damaged(Bytes bytes, std::uint64_t& random) {
    if (bytes.empty()) return bytes;
    for (std::uint64_t k = 1 + next(random) % 4; k > 0 && !bytes.empty(); --k) {
        const auto at = static_cast<std::ptrdiff_t>(next(random) % bytes.size());
        switch (next(random) % 6) {
            case 0:
                bytes[static_cast<std::size_t>(at)] ^= static_cast<std::uint8_t>(1u << (next(random) % 8));
                break;
            case 1:
                bytes[static_cast<std::size_t>(at)] = static_cast<std::uint8_t>(next(random));
                break;
            case 2:
                bytes.resize(static_cast<std::size_t>(at));
                break;
            case 3:
                bytes.erase(bytes.begin() + at, std::min(bytes.end(), bytes.begin() + at + 7));
                break;
            case 4:
                std::fill(bytes.begin() + at, std::min(bytes.end(), bytes.begin() + at + 4),
                          next(random) % 2 == 0 ? 0xff : 0);
                break;
            default: {
                const Bytes piece(bytes.begin() + at, std::min(bytes.end(), bytes.begin() + at + 16));
                bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(next(random) % bytes.size()),
                             piece.begin(), piece.end());
            }
        }
    }
    return bytes;
}

}  // namespace

int main(int argc, char** argv) {
    std::uint64_t extra = 0;
    std::vector<std::filesystem::path> files;
    for (int k = 1; k < argc; ++k) {
        if (std::string(argv[k]) == "--damaged" && k + 1 < argc) {
            extra = std::strtoull(argv[++k], nullptr, 10);
            continue;
        }
        if (std::filesystem::is_directory(argv[k]))
            for (const auto& entry : std::filesystem::recursive_directory_iterator(argv[k]))
                if (entry.is_regular_file()) files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    if (files.empty()) {
        std::fprintf(stderr, "there is no file in the folders named; name a corpus\n");
        return 1;
    }
    std::vector<Bytes> seeds;
    for (const auto& file : files) {
        std::ifstream in(file, std::ios::binary);
        seeds.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
        LLVMFuzzerTestOneInput(seeds.back().data(), seeds.back().size());
    }
    std::uint64_t random = 1;
    for (std::uint64_t k = 0; k < extra; ++k) {
        const Bytes input = damaged(seeds[k % seeds.size()], random);
        LLVMFuzzerTestOneInput(input.data(), input.size());
    }
    std::printf("%zu files and %llu damaged ones were read or refused\n", files.size(),
                static_cast<unsigned long long>(extra));
    return 0;
}
