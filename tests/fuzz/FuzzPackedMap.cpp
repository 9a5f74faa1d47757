// The cache's reader of packed reference maps. The hash at the end is put right, or nothing would get past
// it.
#include <cstring>
#include <vector>

#include "reflection/reference_maps/PackedFile.h"
#include "tests/fuzz/FuzzTarget.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::vector<std::uint8_t> bytes(data, data + size);
    if (size >= sizeof(std::uint64_t)) {
        const std::size_t end = size - sizeof(std::uint64_t);
        const std::uint64_t hash = reflection::packedFileHash(std::span(bytes).first(end));
        std::memcpy(bytes.data() + end, &hash, sizeof hash);
    }
    fuzz::feed(bytes, "input.packed", [](const auto& file) {
        const auto map = reflection::loadPacked(file, {7, 8, 9});
        if (!map) return;
        // What was read can be used.
        for (const auto& level : map->levels())
            for (int face = 0; face < 6; ++face) {
                level.distanceAt(face, -1, -1);
                level.colourAt(face, level.faceSize(), level.faceSize());
            }
        map->levelFor(32);
    });
    return 0;
}
