#include "app/display/OffscreenContext.h"

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include "app/display/GlInfo.h"
#include "app/display/Window.h"

namespace app {
namespace {

TEST(OffscreenContextGlTest, isCurrentAndCore45) {
    const OffscreenContext context;
    GLint major = 0;
    GLint minor = 0;
    GLint profile = 0;
    glGetIntegerv(GL_MAJOR_VERSION, &major);
    glGetIntegerv(GL_MINOR_VERSION, &minor);
    glGetIntegerv(GL_CONTEXT_PROFILE_MASK, &profile);
    EXPECT_GE(10 * major + minor, 45);
    EXPECT_NE(profile & GL_CONTEXT_CORE_PROFILE_BIT, 0);
    EXPECT_FALSE(context.renderer().empty());
    EXPECT_NE(glInfo().find(context.renderer()), std::string::npos);
    EXPECT_EQ(context.software(), isSoftwareRenderer(context.renderer()));
}

TEST(OffscreenContextGlTest, oneAfterAnother) {
    for (int i = 0; i < 3; ++i) {
        const OffscreenContext context;
        EXPECT_NE(glGetString(GL_VERSION), nullptr);
    }
}

TEST(OffscreenContextGlTest, softwareIsToldByName) {
    EXPECT_TRUE(isSoftwareRenderer("llvmpipe (LLVM 15.0.6, 256 bits)"));
    EXPECT_FALSE(isSoftwareRenderer("NVIDIA H100 PCIe/PCIe/SSE2"));
}

TEST(WindowTest, withoutADisplayTheMessageSaysWhatToDo) {
    if (Window::possible()) GTEST_SKIP() << "there is a display";
    try {
        const Window window({});
        FAIL() << "a window opened without a display";
    } catch (const std::runtime_error& error) {
        EXPECT_NE(std::string(error.what()).find("DISPLAY"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace app
