// The rules by which the modules may know each other, checked on every file of the tree.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

constexpr int maxLines = 500;
const std::vector<std::string> roots{"app", "city", "reflection", "tests", "vehicles"};
const std::set<std::string> forbiddenFolders{"utils", "util", "common", "misc", "core", "helpers", "helper"};

bool under(const std::string& path, const std::string& folder) {
    return path.starts_with(folder + "/");
}
bool underAny(const std::string& path, const std::vector<std::string>& folders) {
    return std::any_of(folders.begin(), folders.end(), [&](const std::string& f) { return under(path, f); });
}

struct Include {
    int line = 0;
    std::string name;
    bool quoted = false;
};

/// The #include lines of a source text.
std::vector<Include> includesOf(const std::string& text) {
    std::vector<Include> found;
    std::istringstream lines(text);
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
        std::size_t at = line.find_first_not_of(" \t");
        if (at == std::string::npos || line[at] != '#') continue;
        at = line.find_first_not_of(" \t", at + 1);
        if (at == std::string::npos || line.compare(at, 7, "include") != 0) continue;
        const std::size_t open = line.find_first_of("<\"", at + 7);
        if (open == std::string::npos) continue;
        const std::size_t close = line.find(line[open] == '<' ? '>' : '"', open + 1);
        if (close == std::string::npos) continue;
        found.push_back({number, line.substr(open + 1, close - open - 1), line[open] == '"'});
    }
    return found;
}

/// A rule: files under one of `owners` (but not under `butNot`) may include project files only from
/// `mayKnow`.
struct ModuleRule {
    std::string owner;
    std::vector<std::string> butNot;
    std::vector<std::string> mayKnow;
};
const std::vector<ModuleRule> moduleRules{
    {"city/geometry", {}, {"city/geometry"}},
    {"city/terrain", {}, {"city/geometry", "city/terrain"}},
    {"city/import", {}, {"city"}},
    {"city",
     {"city/import"},
     {"city/geometry", "city/terrain", "city/geodesy", "city/roads", "city/model", "city/generate"}},
    {"vehicles/import", {}, {"vehicles", "city"}},
    {"vehicles", {"vehicles/import"}, {"vehicles/traffic", "vehicles/models", "city"}},
    {"reflection/gl", {}, {"reflection", "city/geometry", "city/terrain"}},
    {"reflection/truth", {}, {"reflection", "city/geometry", "city/terrain"}},
    {"reflection",
     {"reflection/gl", "reflection/truth"},
     {"reflection/tracing", "reflection/reference_maps", "reflection/local_map", "reflection/planar",
      "reflection/chrome", "city/geometry", "city/terrain"}},
    {"app", {}, {"app", "city", "vehicles", "reflection"}},
    {"tests", {}, {"app", "city", "vehicles", "reflection", "tests"}},
};

/// A rule: headers with one of these beginnings are included only by files under one of `allowed` (or their
/// tests).
struct LibraryRule {
    std::vector<std::string> headers;
    std::vector<std::string> allowed;
};
const std::vector<LibraryRule> libraryRules{
    {{"epoxy/", "GL/", "GLES", "EGL/", "GLFW/", "KHR/", "openxr/"},
     {"reflection/gl", "app/render", "app/display", "app/panel"}},
    {{"imgui", "backends/imgui"}, {"app/panel", "app/display"}},
    {{"OpenImageIO/"}, {"city/import", "vehicles/import", "app"}},
    {{"osmium/", "protozero/"}, {"city/import"}},
    {{"tiny_gltf", "nlohmann/"}, {"city/import", "vehicles/import", "app"}},
    {{"geotiff", "xtiffio", "geo_"}, {"city/import"}},
    {{"embree"}, {"reflection/truth", "reflection/tracing", "app/commands"}},
    {{"CLI/", "spdlog/"}, {"app"}},
};

/// What is wrong with a file's including another, in words; nothing when it is allowed.
std::optional<std::string> forbidden(const std::string& file, const Include& include) {
    if (include.quoted) {
        if (!underAny(include.name, roots)) return "is not named from the repository root";
        for (const ModuleRule& rule : moduleRules) {
            if (!under(file, rule.owner) || underAny(file, rule.butNot)) continue;
            if (!underAny(include.name, rule.mayKnow)) return rule.owner + " may not know it";
            break;
        }
        return std::nullopt;
    }
    for (const LibraryRule& rule : libraryRules) {
        const bool speaksOfIt =
            std::any_of(rule.headers.begin(), rule.headers.end(),
                        [&](const std::string& h) { return include.name.starts_with(h); });
        if (!speaksOfIt) continue;
        std::vector<std::string> allowed = rule.allowed;
        for (const std::string& folder : rule.allowed) allowed.push_back("tests/" + folder);
        if (!underAny(file, allowed)) return "belongs to " + testing::PrintToString(rule.allowed) + " alone";
    }
    return std::nullopt;
}

struct SourceFile {
    std::string path;  ///< from the repository root
    std::string text;
};

std::vector<SourceFile> sourceFiles() {
    const fs::path root = MIRRORSTREET_SOURCE_DIR;
    std::vector<SourceFile> files;
    for (const std::string& folder : roots)
        for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
            const std::string ending = entry.path().extension();
            if (!entry.is_regular_file() || (ending != ".h" && ending != ".cpp")) continue;
            std::ifstream in(entry.path(), std::ios::binary);
            files.push_back({fs::relative(entry.path(), root).generic_string(),
                             {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()}});
        }
    return files;
}

TEST(HouseTest, modulesIncludeOnlyWhatTheyMayKnow) {
    const auto files = sourceFiles();
    ASSERT_GT(files.size(), 30u);
    std::size_t includes = 0;
    for (const SourceFile& file : files)
        for (const Include& include : includesOf(file.text)) {
            ++includes;
            const auto fault = forbidden(file.path, include);
            EXPECT_FALSE(fault) << file.path << ":" << include.line << " includes " << include.name
                                << ", which " << *fault;
        }
    EXPECT_GT(includes, 100u);
}

TEST(HouseTest, plantedViolationsAreFound) {
    const auto quoted = [](const char* name) { return Include{1, name, true}; };
    const auto angled = [](const char* name) { return Include{1, name, false}; };
    EXPECT_TRUE(forbidden("city/geometry/Ray.h", quoted("city/model/CityModel.h")));
    EXPECT_TRUE(forbidden("city/model/CityModel.h", quoted("vehicles/traffic/Traffic.h")));
    EXPECT_TRUE(forbidden("city/model/CityModel.cpp", quoted("city/import/LoadCity.h")));
    EXPECT_TRUE(forbidden("vehicles/traffic/Traffic.cpp", quoted("reflection/tracing/GridTracer.h")));
    EXPECT_TRUE(forbidden("reflection/tracing/GridTracer.h", quoted("city/model/CityModel.h")));
    EXPECT_TRUE(forbidden("reflection/local_map/X.h", quoted("reflection/gl/SceneDrawer.h")));
    EXPECT_TRUE(forbidden("reflection/gl/X.cpp", quoted("app/frame/View.h")));
    EXPECT_TRUE(forbidden("app/frame/X.cpp", quoted("View.h")));
    EXPECT_TRUE(forbidden("app/frame/X.cpp", angled("epoxy/gl.h")));
    EXPECT_TRUE(forbidden("app/commands/X.cpp", angled("GLFW/glfw3.h")));
    EXPECT_TRUE(forbidden("reflection/tracing/X.cpp", angled("OpenImageIO/imageio.h")));
    EXPECT_TRUE(forbidden("tests/city/model/XTest.cpp", angled("tiny_gltf.h")));
    EXPECT_FALSE(forbidden("tests/reflection/gl/XGlTest.cpp", angled("epoxy/gl.h")));
    EXPECT_FALSE(forbidden("vehicles/import/X.cpp", quoted("vehicles/models/VehicleModel.h")));
    EXPECT_FALSE(forbidden("city/import/X.cpp", quoted("city/import/LoadCity.h")));
    EXPECT_FALSE(forbidden("app/main.cpp", quoted("app/commands/Commands.h")));
}

TEST(HouseTest, includesAreReadFromText) {
    const auto found =
        includesOf("#pragma once\n #  include <a/b.h> // why\n#include \"c.h\"\n// #include <no.h>\n");
    ASSERT_EQ(found.size(), 2u);
    EXPECT_EQ(found[0].name, "a/b.h");
    EXPECT_EQ(found[0].line, 2);
    EXPECT_FALSE(found[0].quoted);
    EXPECT_EQ(found[1].name, "c.h");
    EXPECT_TRUE(found[1].quoted);
}

TEST(HouseTest, filesStayShortAndHoldNoReminders) {
    // Split, so that this file does not find itself.
    const std::vector<std::string> reminders{std::string("TO") + "DO", std::string("FIX") + "ME"};
    for (const SourceFile& file : sourceFiles()) {
        EXPECT_LE(std::count(file.text.begin(), file.text.end(), '\n'), maxLines)
            << file.path << ": split it by idea";
        for (const std::string& reminder : reminders)
            EXPECT_EQ(file.text.find(reminder), std::string::npos) << file.path << " contains " << reminder;
    }
}

TEST(HouseTest, noFolderWithoutAnIdea) {
    const fs::path root = MIRRORSTREET_SOURCE_DIR;
    std::vector<std::string> folders = roots;
    folders.push_back("data");
    for (const std::string& folder : folders) {
        if (!fs::exists(root / folder)) continue;
        for (const auto& entry : fs::recursive_directory_iterator(root / folder))
            if (entry.is_directory()) {
                EXPECT_FALSE(forbiddenFolders.contains(entry.path().filename()))
                    << fs::relative(entry.path(), root);
            }
    }
}

TEST(HouseTest, everyHeaderOpensWithPragmaOnce) {
    for (const SourceFile& file : sourceFiles())
        // Highway's -inl.h files are included once for each instruction set.
        if (file.path.ends_with(".h") && !file.path.ends_with("-inl.h")) {
            EXPECT_TRUE(file.text.starts_with("#pragma once\n")) << file.path;
        }
}

}  // namespace
