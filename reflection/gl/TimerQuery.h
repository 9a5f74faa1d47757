#pragma once

#include <epoxy/gl.h>

#include <optional>

#include "reflection/gl/Handle.h"

namespace reflection::gl {

inline void destroyQuery(std::uint32_t name) {
    glDeleteQueries(1, &name);
}

/// GPU time between `begin` and `end`. Only one may be open at a time.
class TimerQuery {
  public:
    TimerQuery() = default;
    static TimerQuery create() {
        GLuint name = 0;
        glCreateQueries(GL_TIME_ELAPSED, 1, &name);
        TimerQuery q;
        q.handle_ = Handle<destroyQuery>(name);
        return q;
    }
    void begin() { glBeginQuery(GL_TIME_ELAPSED, handle_.name()); }
    void end() { glEndQuery(GL_TIME_ELAPSED); }
    /// Milliseconds, or nothing while the GPU has not come that far. Never waits.
    std::optional<double> milliseconds() const {
        GLint available = 0;
        glGetQueryObjectiv(handle_.name(), GL_QUERY_RESULT_AVAILABLE, &available);
        if (available == 0) return std::nullopt;
        GLuint64 nanoseconds = 0;
        glGetQueryObjectui64v(handle_.name(), GL_QUERY_RESULT, &nanoseconds);
        return static_cast<double>(nanoseconds) * 1e-6;
    }

  private:
    Handle<destroyQuery> handle_;
};

}  // namespace reflection::gl
