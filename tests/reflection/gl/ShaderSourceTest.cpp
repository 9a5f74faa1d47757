#include "reflection/gl/ShaderSource.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

namespace reflection::gl {
namespace {

class ShaderSourceTest : public testing::Test {
  protected:
    ShaderSourceTest()
        : folder_(std::filesystem::temp_directory_path() /
                  ("mirrorstreet-shaders-" + std::to_string(getpid()))) {
        std::filesystem::create_directories(folder_ / "shaders");
        setenv("MIRRORSTREET_DATA", folder_.c_str(), 1);
    }
    ~ShaderSourceTest() override {
        unsetenv("MIRRORSTREET_DATA");
        std::filesystem::remove_all(folder_);
    }
    void write(const char* name, const char* text) { std::ofstream(folder_ / "shaders" / name) << text; }
    std::filesystem::path folder_;
};

TEST_F(ShaderSourceTest, definesFollowTheVersionAndIncludesAreTakenOnce) {
    write("a.glsl", "float a;\n");
    write("b.glsl", "#include \"a.glsl\"\nfloat b;\n");
    write("main.frag", "#version 450 core\n#include \"a.glsl\"\n#include \"b.glsl\"\nvoid main() {}\n");
    const std::vector<std::string> defines{"FAST", "COUNT 3"};
    const ShaderSource source = loadShader("main.frag", defines);
    EXPECT_THAT(source.text, testing::StartsWith("#version 450 core\n#define FAST\n#define COUNT 3\n"));
    EXPECT_EQ(source.text.find("float a;"), source.text.rfind("float a;"));
    EXPECT_LT(source.text.find("float a;"), source.text.find("float b;"));
    EXPECT_THAT(source.files, testing::ElementsAre("main.frag", "a.glsl", "b.glsl"));
}

TEST_F(ShaderSourceTest, filesThatIncludeEachOtherEnd) {
    write("a.glsl", "#include \"b.glsl\"\nfloat a;\n");
    write("b.glsl", "#include \"a.glsl\"\nfloat b;\n");
    EXPECT_THAT(loadShader("a.glsl").files, testing::ElementsAre("a.glsl", "b.glsl"));
}

TEST_F(ShaderSourceTest, aMissingFileIsNamedWithWhoAskedForIt) {
    write("main.frag", "#version 450 core\n#include \"lost.glsl\"\n");
    try {
        loadShader("main.frag");
        FAIL();
    } catch (const std::runtime_error& error) {
        EXPECT_THAT(error.what(),
                    testing::AllOf(testing::HasSubstr("lost.glsl"), testing::HasSubstr("main.frag")));
    }
}

TEST_F(ShaderSourceTest, aWrongDataFolderIsNamed) {
    setenv("MIRRORSTREET_DATA", "/nowhere/at/all", 1);
    try {
        dataFolder();
        FAIL();
    } catch (const std::runtime_error& error) {
        EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("/nowhere/at/all"),
                                                 testing::HasSubstr("MIRRORSTREET_DATA")));
    }
}

TEST(DataFolderTest, isFoundWithoutTheEnvironment) {
    unsetenv("MIRRORSTREET_DATA");
    EXPECT_TRUE(std::filesystem::exists(dataFolder() / "shaders/frame.glsl"));
}

}  // namespace
}  // namespace reflection::gl
