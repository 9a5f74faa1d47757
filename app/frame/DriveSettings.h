#pragma once

#include <cstdint>

#include "app/frame/ReflectionMethod.h"

namespace app {

/// What a drive can be asked to change while it runs.
struct DriveSettings {
    ReflectionMethod method = ReflectionMethod::mem;
    MemVariant mem = MemVariant::ours;
    Quality quality = Quality::medium;
    std::uint32_t cars = 60;
    double hour = 15;

    bool operator==(const DriveSettings&) const = default;
};

}  // namespace app
