#include "app/report/ResultFile.h"

#include <fstream>
#include <thread>
#include <utility>

#include "app/report/AsideFile.h"

namespace app {

nlohmann::ordered_json toJson(const Timing& timing) {
    if (timing.n == 0) return nullptr;
    return {{"min", timing.min}, {"median", timing.median}, {"max", timing.max}, {"n", timing.n}};
}

std::string processorName() {
    std::ifstream in("/proc/cpuinfo");
    std::string line;
    while (std::getline(in, line)) {
        // x86 says "model name"; some arm64 kernels say "Model" or nothing at all.
        if (!line.starts_with("model name") && !line.starts_with("Model")) continue;
        const std::size_t colon = line.find(": ");
        if (colon != std::string::npos) return line.substr(colon + 2);
    }
    return "unknown";
}

ResultFile::ResultFile(std::string bench, std::string version, std::string renderer)
    : head_{{"bench", std::move(bench)},
            {"version", std::move(version)},
            {"renderer", std::move(renderer)},
            {"cpu", processorName()},
            {"threads", std::thread::hardware_concurrency()}} {}

void ResultFile::add(nlohmann::ordered_json row) {
    rows_.push_back(std::move(row));
}

nlohmann::ordered_json ResultFile::document(bool partial) const {
    nlohmann::ordered_json document = head_;
    if (partial) document["partial"] = true;
    document["rows"] = rows_;
    return document;
}

void ResultFile::write(const std::filesystem::path& file, bool partial) const {
    writeTextFile(file, document(partial).dump(2) + "\n");
}

}  // namespace app
