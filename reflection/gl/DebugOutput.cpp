#include "reflection/gl/DebugOutput.h"

#include <epoxy/gl.h>

namespace reflection::gl {

namespace {

void GLAPIENTRY receive(GLenum, GLenum type, GLuint, GLenum severity, GLsizei length, const GLchar* message,
                        const void* user) {
    const bool wrong = type == GL_DEBUG_TYPE_ERROR || type == GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR;
    if (!wrong || severity == GL_DEBUG_SEVERITY_NOTIFICATION) return;
    auto* errors = const_cast<std::vector<std::string>*>(static_cast<const std::vector<std::string>*>(user));
    errors->emplace_back(
        message, length >= 0 ? static_cast<std::size_t>(length) : std::char_traits<char>::length(message));
}

}  // namespace

DebugOutput::DebugOutput() : errors_(std::make_unique<std::vector<std::string>>()) {
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(receive, errors_.get());
}

DebugOutput::~DebugOutput() {
    glDebugMessageCallback(nullptr, nullptr);
    glDisable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDisable(GL_DEBUG_OUTPUT);
}

std::vector<std::string> DebugOutput::errors() const {
    for (GLenum error = glGetError(); error != GL_NO_ERROR; error = glGetError()) {
        errors_->push_back("glGetError: " + std::to_string(error));
        if (errors_->size() > 100) break;
    }
    return *errors_;
}

}  // namespace reflection::gl
