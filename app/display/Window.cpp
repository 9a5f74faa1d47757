#include "app/display/Window.h"

#include <epoxy/gl.h>
// GLFW must find the GL declarations already there.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <cstdlib>
#include <stdexcept>
#include <utility>

#include "app/display/FreedMemory.h"
#include "app/display/GlInfo.h"
#include "app/display/RasteriserThreads.h"

namespace app {

struct Window::Impl {
    GLFWwindow* window = nullptr;
    std::vector<WindowEvent> events;
    std::string renderer;
    std::string version;

    ~Impl() {
        if (window != nullptr) glfwDestroyWindow(window);
        glfwTerminate();
    }

    static Impl& of(GLFWwindow* window) { return *static_cast<Impl*>(glfwGetWindowUserPointer(window)); }

    WindowEvent& add(WindowEventKind kind) {
        WindowEvent event;
        event.kind = kind;
        glfwGetCursorPos(window, &event.cursor.x, &event.cursor.y);
        events.push_back(event);
        return events.back();
    }

    void listen() {
        glfwSetWindowUserPointer(window, this);
        glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int modifiers) {
            WindowEvent& event = of(w).add(WindowEventKind::key);
            event.key = key;
            event.pressed = action != GLFW_RELEASE;
            event.repeated = action == GLFW_REPEAT;
            event.modifiers = modifiers;
        });
        glfwSetCharCallback(window, [](GLFWwindow* w, unsigned character) {
            of(w).add(WindowEventKind::character).character = character;
        });
        glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int button, int action, int modifiers) {
            WindowEvent& event = of(w).add(WindowEventKind::mouseButton);
            event.button = button;
            event.pressed = action == GLFW_PRESS;
            event.modifiers = modifiers;
        });
        glfwSetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) {
            of(w).add(WindowEventKind::mouseMove).cursor = {x, y};
        });
        glfwSetScrollCallback(window, [](GLFWwindow* w, double x, double y) {
            of(w).add(WindowEventKind::scroll).scroll = {x, y};
        });
        glfwSetFramebufferSizeCallback(window,
                                       [](GLFWwindow* w, int, int) { of(w).add(WindowEventKind::resize); });
        glfwSetWindowFocusCallback(window, [](GLFWwindow* w, int focused) {
            of(w).add(WindowEventKind::focus).pressed = focused != 0;
        });
    }
};

namespace {

std::string lastError() {
    const char* text = nullptr;
    glfwGetError(&text);
    return text == nullptr ? "no reason given" : text;
}

}  // namespace

bool Window::possible() {
    const auto set = [](const char* name) {
        const char* value = std::getenv(name);
        return value != nullptr && *value != '\0';
    };
    return set("DISPLAY") || set("WAYLAND_DISPLAY");
}

Window::Window(const WindowOptions& options) {
    if (glfwInit() != GLFW_TRUE) {
        throw std::runtime_error("No window can be opened (" + lastError() +
                                 "): set DISPLAY to a running X server, or draw offscreen by unsetting it.");
    }
    impl_ = std::make_unique<Impl>();  // from here on it terminates GLFW
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    glfwWindowHint(GLFW_DEPTH_BITS, 0);  // views bring their own depth
    glfwWindowHint(GLFW_STENCIL_BITS, 0);
    GLFWmonitor* monitor = options.fullscreen ? glfwGetPrimaryMonitor() : nullptr;
    glm::ivec2 size = options.size;
    if (const GLFWvidmode* mode = monitor != nullptr ? glfwGetVideoMode(monitor) : nullptr; mode != nullptr)
        size = {mode->width, mode->height};
    impl_->window = glfwCreateWindow(size.x, size.y, options.title.c_str(), monitor, nullptr);
    if (impl_->window == nullptr) {
        throw std::runtime_error("No OpenGL 4.5 core window can be opened (" + lastError() +
                                 "): install libgl1-mesa-dri (Debian) or the graphics vendor's driver, or "
                                 "draw offscreen by unsetting DISPLAY.");
    }
    glfwMakeContextCurrent(impl_->window);
    impl_->listen();
    setVsync(options.vsync);
    impl_->renderer = glText(GL_RENDERER);
    impl_->version = glText(GL_VERSION);
    spreadRasteriserThreads();
    keepFreedMemory(impl_->renderer);
}

Window::~Window() = default;

std::vector<WindowEvent> Window::pollEvents() {
    glfwPollEvents();
    return std::exchange(impl_->events, {});
}

void Window::present() {
    glfwSwapBuffers(impl_->window);
}
bool Window::closeRequested() const {
    return glfwWindowShouldClose(impl_->window) != 0;
}
void Window::requestClose() {
    glfwSetWindowShouldClose(impl_->window, GLFW_TRUE);
}

glm::ivec2 Window::framebufferSize() const {
    glm::ivec2 size(0);
    glfwGetFramebufferSize(impl_->window, &size.x, &size.y);
    return size;
}

bool Window::minimised() const {
    return glfwGetWindowAttrib(impl_->window, GLFW_ICONIFIED) != 0;
}

glm::dvec2 Window::cursor() const {
    glm::dvec2 at(0);
    glfwGetCursorPos(impl_->window, &at.x, &at.y);
    return at;
}

bool Window::keyDown(int key) const {
    return glfwGetKey(impl_->window, key) == GLFW_PRESS;
}
bool Window::buttonDown(int button) const {
    return glfwGetMouseButton(impl_->window, button) == GLFW_PRESS;
}
void Window::setTitle(const std::string& title) {
    glfwSetWindowTitle(impl_->window, title.c_str());
}
void Window::setVsync(bool on) {
    glfwSwapInterval(on ? 1 : 0);
}
void Window::captureCursor(bool on) {
    glfwSetInputMode(impl_->window, GLFW_CURSOR, on ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL);
}

const std::string& Window::renderer() const {
    return impl_->renderer;
}
const std::string& Window::version() const {
    return impl_->version;
}
bool Window::software() const {
    return isSoftwareRenderer(impl_->renderer);
}
GLFWwindow* Window::handle() const {
    return impl_->window;
}

}  // namespace app
