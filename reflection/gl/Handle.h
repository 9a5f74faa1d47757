#pragma once

#include <cstdint>
#include <utility>

namespace reflection::gl {

/// Sole owner of one GL name: movable, not copyable, destroyed with `destroy` (never called for 0). The
/// context that made the name must be current when the handle dies.
template <void (*destroy)(std::uint32_t)>
class Handle {
  public:
    Handle() = default;
    explicit Handle(std::uint32_t name) : name_(name) {}
    Handle(Handle&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
    Handle& operator=(Handle&& other) noexcept {
        if (this != &other) {
            reset();
            name_ = std::exchange(other.name_, 0);
        }
        return *this;
    }
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    ~Handle() { reset(); }

    std::uint32_t name() const { return name_; }
    explicit operator bool() const { return name_ != 0; }

  private:
    void reset() {
        if (name_ != 0) destroy(name_);
        name_ = 0;
    }
    std::uint32_t name_ = 0;
};

}  // namespace reflection::gl
