#include "reflection/gl/ShaderSource.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace reflection::gl {

namespace fs = std::filesystem;

fs::path dataFolder() {
    std::vector<fs::path> candidates;
    if (const char* fromEnvironment = std::getenv("MIRRORSTREET_DATA");
        fromEnvironment != nullptr && *fromEnvironment != '\0') {
        candidates.emplace_back(fromEnvironment);  // an explicit wish: nothing else is tried
    } else {
        std::error_code ignored;
        fs::path folder = fs::read_symlink("/proc/self/exe", ignored).parent_path();
        for (int up = 0; up < 4 && !folder.empty(); ++up) {
            candidates.push_back(folder / "data");
            candidates.push_back(folder / "../share/mirrorstreet");
            folder = folder.parent_path();
        }
        candidates.emplace_back(MIRRORSTREET_SOURCE_DATA);
    }
    std::string tried;
    for (const fs::path& candidate : candidates) {
        std::error_code ignored;
        if (fs::is_directory(candidate / "shaders", ignored)) return candidate;
        tried += (tried.empty() ? "" : ", ") + candidate.string();
    }
    throw std::runtime_error("The folder data/shaders was found in none of: " + tried +
                             "; set MIRRORSTREET_DATA to the program's data folder.");
}

namespace {

void expand(const fs::path& folder, const std::string& name, const std::string& askedBy,
            std::span<const std::string> defines, ShaderSource& result) {
    if (std::find(result.files.begin(), result.files.end(), name) != result.files.end()) return;
    const fs::path path = folder / name;
    std::ifstream file(path);
    if (!file) {
        throw std::runtime_error(path.string() + ": cannot read this shader" +
                                 (askedBy.empty() ? std::string() : ", included by " + askedBy) +
                                 "; the data folder is incomplete, install it again.");
    }
    const std::size_t number = result.files.size();
    result.files.push_back(name);
    std::string line;
    for (int lineNumber = 1; std::getline(file, line); ++lineNumber) {
        std::istringstream words(line);
        std::string first;
        words >> first;
        const auto mark = [&] {
            result.text += "#line " + std::to_string(lineNumber + 1) + " " + std::to_string(number) + "\n";
        };
        if (first == "#include") {
            const auto open = line.find('"');
            const auto close = line.rfind('"');
            if (open == std::string::npos || close <= open) {
                throw std::runtime_error(
                    path.string() + ", line " + std::to_string(lineNumber) +
                    ": #include without a file name in double quotes; write #include \"file\".");
            }
            result.text += "#line 1 " + std::to_string(result.files.size()) + "\n";
            expand(folder, line.substr(open + 1, close - open - 1), name, {}, result);
            mark();
        } else if (first == "#version") {
            result.text += line + "\n";
            for (const std::string& define : defines) result.text += "#define " + define + "\n";
            mark();
        } else {
            result.text += line + "\n";
        }
    }
}

}  // namespace

ShaderSource loadShader(std::string_view name, std::span<const std::string> defines) {
    ShaderSource result;
    expand(dataFolder() / "shaders", std::string(name), {}, defines, result);
    return result;
}

}  // namespace reflection::gl
