#include "app/display/OffscreenContext.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <array>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "app/display/FreedMemory.h"
#include "app/display/GlInfo.h"
#include "app/display/RasteriserThreads.h"

namespace app {

namespace {

constexpr const char* remedy =
    "mirrorstreet needs OpenGL 4.5 core through EGL; on Debian install libegl1 and libgl1-mesa-dri (software "
    "or Mesa "
    "hardware drivers), or the vendor's driver.";

bool hasExtension(const char* list, std::string_view name) {
    if (list == nullptr) return false;
    std::string_view rest(list);
    while (!rest.empty()) {
        const auto space = rest.find(' ');
        if (rest.substr(0, space) == name) return true;
        if (space == std::string_view::npos) break;
        rest.remove_prefix(space + 1);
    }
    return false;
}

/// Displays to try, best first: no window system at all, then each device, then whatever the default is.
std::vector<EGLDisplay> candidateDisplays() {
    std::vector<EGLDisplay> displays;
    const char* client = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    if (hasExtension(client, "EGL_EXT_platform_base")) {
        if (hasExtension(client, "EGL_MESA_platform_surfaceless"))
            displays.push_back(
                eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
        if (hasExtension(client, "EGL_EXT_platform_device") &&
            hasExtension(client, "EGL_EXT_device_enumeration")) {
            std::array<EGLDeviceEXT, 16> devices{};
            EGLint count = 0;
            if (eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count) == EGL_TRUE) {
                for (EGLint i = 0; i < count; ++i)
                    displays.push_back(eglGetPlatformDisplayEXT(
                        EGL_PLATFORM_DEVICE_EXT, devices[static_cast<std::size_t>(i)], nullptr));
            }
        }
    }
    displays.push_back(eglGetDisplay(EGL_DEFAULT_DISPLAY));
    return displays;
}

}  // namespace

struct OffscreenContext::Impl {
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLContext context = EGL_NO_CONTEXT;
    EGLSurface surface = EGL_NO_SURFACE;
    std::string renderer;
    std::string version;

    ~Impl() { release(); }

    void release() {
        if (display == EGL_NO_DISPLAY) return;
        eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        if (context != EGL_NO_CONTEXT) eglDestroyContext(display, context);
        if (surface != EGL_NO_SURFACE) eglDestroySurface(display, surface);
        eglTerminate(display);
        display = EGL_NO_DISPLAY;
        context = EGL_NO_CONTEXT;
        surface = EGL_NO_SURFACE;
    }

    /// An empty string on success, else what went wrong.
    std::string tryDisplay(EGLDisplay candidate) {
        if (candidate == EGL_NO_DISPLAY) return "no display";
        EGLint major = 0;
        EGLint minor = 0;
        if (eglInitialize(candidate, &major, &minor) != EGL_TRUE) return "eglInitialize failed";
        display = candidate;
        if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) return "desktop OpenGL is not offered";
        const char* extensions = eglQueryString(display, EGL_EXTENSIONS);
        const bool surfaceless = hasExtension(extensions, "EGL_KHR_surfaceless_context");
        const std::array<EGLint, 5> wanted{EGL_SURFACE_TYPE, surfaceless ? EGL_DONT_CARE : EGL_PBUFFER_BIT,
                                           EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
        EGLConfig config = nullptr;
        EGLint count = 0;
        if (eglChooseConfig(display, wanted.data(), &config, 1, &count) != EGL_TRUE || count == 0) {
            if (!hasExtension(extensions, "EGL_KHR_no_config_context") || !surfaceless)
                return "no framebuffer configuration";
            config = nullptr;
        }
        const std::array<EGLint, 7> version45{EGL_CONTEXT_MAJOR_VERSION,
                                              4,
                                              EGL_CONTEXT_MINOR_VERSION,
                                              5,
                                              EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                              EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                              EGL_NONE};
        context = eglCreateContext(display, config, EGL_NO_CONTEXT, version45.data());
        if (context == EGL_NO_CONTEXT) return "OpenGL 4.5 core is not offered";
        if (!surfaceless) {
            const std::array<EGLint, 5> one{EGL_WIDTH, 1, EGL_HEIGHT, 1, EGL_NONE};
            surface = eglCreatePbufferSurface(display, config, one.data());
        }
        if (eglMakeCurrent(display, surface, surface, context) != EGL_TRUE) return "eglMakeCurrent failed";
        renderer = glText(GL_RENDERER);
        version = glText(GL_VERSION);
        spreadRasteriserThreads();
        keepFreedMemory(renderer);
        return {};
    }
};

OffscreenContext::OffscreenContext() : impl_(std::make_unique<Impl>()) {
    std::string reasons;
    for (EGLDisplay display : candidateDisplays()) {
        const std::string reason = impl_->tryDisplay(display);
        if (reason.empty()) return;
        reasons += (reasons.empty() ? "" : "; ") + reason;
        impl_->release();
    }
    throw std::runtime_error("No offscreen OpenGL context could be created (" + reasons + "): " + remedy);
}

OffscreenContext::~OffscreenContext() = default;

const std::string& OffscreenContext::renderer() const {
    return impl_->renderer;
}
const std::string& OffscreenContext::version() const {
    return impl_->version;
}
bool OffscreenContext::software() const {
    return isSoftwareRenderer(impl_->renderer);
}

}  // namespace app
