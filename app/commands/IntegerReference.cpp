#include "app/commands/IntegerReference.h"

#include <cmath>
#include <limits>

namespace app {

namespace {

__extension__ using Wide = __int128;

constexpr std::int64_t emptyColumn = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t endlessColumn = std::numeric_limits<std::int64_t>::max();
constexpr int placeBits = 12;
constexpr int directionBits = 24;
constexpr int heightBits = 44;

std::optional<std::int64_t> units(double value, int bits, double limit) {
    const double scaled = std::ldexp(value, bits);
    if (!(std::abs(value) <= limit) || scaled != std::floor(scaled)) return std::nullopt;
    return static_cast<std::int64_t>(scaled);
}

/// A fraction n / d, d > 0. Heights give numerators of 2^59, so comparisons need 128 bits.
struct Parameter {
    Wide n;
    std::int64_t d;
};

}  // namespace

std::optional<IntegerReference> IntegerReference::of(const city::Heightfield& field) {
    IntegerReference result;
    result.width_ = field.width();
    result.height_ = field.height();
    const auto cell = units(static_cast<double>(field.cellSize()), placeBits, 0x1p10);
    const auto x = units(field.origin().x, placeBits, 0x1p14);
    const auto y = units(field.origin().y, placeBits, 0x1p14);
    if (!cell || !x || !y || field.width() > 16384 || field.height() > 16384) return std::nullopt;
    result.cell_ = *cell;
    result.cornerX_ = *x;
    result.cornerY_ = *y;
    result.columns_.reserve(field.cells().size());
    for (const float h : field.cells()) {
        if (!(h > -std::numeric_limits<float>::infinity())) {
            result.columns_.push_back(emptyColumn);
        } else if (h == std::numeric_limits<float>::infinity()) {
            result.columns_.push_back(endlessColumn);
        } else {
            const auto z = units(static_cast<double>(h), heightBits, 0x1p14);
            if (!z) return std::nullopt;
            result.columns_.push_back(*z);
        }
    }
    return result;
}

bool IntegerReference::confirms(const city::Ray& ray, const reflection::TraceResult& result) const {
    const auto place = [](float v) {
        return static_cast<std::int64_t>(std::ldexp(static_cast<double>(v), placeBits));
    };
    const auto slope = [](float v) {
        return static_cast<std::int64_t>(std::ldexp(static_cast<double>(v), directionBits));
    };
    const std::int64_t ox = place(ray.origin.x), oy = place(ray.origin.y);
    const std::int64_t dx = slope(ray.direction.x), dy = slope(ray.direction.y), dz = slope(ray.direction.z);
    const auto oz = static_cast<std::int64_t>(std::ldexp(static_cast<double>(ray.origin.z), heightBits));
    std::int64_t i = (ox - cornerX_) / cell_;
    std::int64_t j = (oy - cornerY_) / cell_;

    // Parameters in units of 2^(directionBits - placeBits): n / d with n a length and d a direction
    // component.
    const auto atOrBelow = [&](const Parameter& t, std::int64_t h) {
        if (h == endlessColumn) return true;
        if (h == emptyColumn) return false;
        // oz + dz t <= h, multiplied by d; lengths have 12 bits behind the point, heights 44, so n is shifted
        // by 32.
        return static_cast<Wide>(oz) * t.d + static_cast<Wide>(dz) * (t.n << (heightBits - placeBits)) <=
               static_cast<Wide>(h) * t.d;
    };
    const auto agrees = [&](const Parameter& t, bool throughTop) {
        if (result.status != reflection::TraceStatus::hit || result.cell != glm::ivec2(i, j)) return false;
        // Both products are below 2^64: exact in a long double (x87) or nearly so (2^-53 of the bound
        // elsewhere).
        const long double scale = std::ldexp(1.0L, directionBits - (throughTop ? heightBits : placeBits));
        const long double exact = static_cast<long double>(t.n) * scale;
        const long double error =
            std::abs(static_cast<long double>(result.t) * static_cast<long double>(t.d) - exact);
        return error <= (0x1p-24L + 0x1p-51L) * exact;
    };

    Parameter in{0, 1};
    for (;;) {
        if (i < 0 || j < 0 || i >= width_ || j >= height_)
            return result.status == reflection::TraceStatus::miss;
        const std::int64_t h = columns_[static_cast<std::size_t>(j * width_ + i)];
        if (atOrBelow(in, h)) return agrees(in, false);
        const std::int64_t toX = dx > 0 ? cornerX_ + (i + 1) * cell_ - ox : ox - cornerX_ - i * cell_;
        const std::int64_t toY = dy > 0 ? cornerY_ + (j + 1) * cell_ - oy : oy - cornerY_ - j * cell_;
        const std::int64_t speedX = std::abs(dx), speedY = std::abs(dy);
        const bool byX =
            dx != 0 && (dy == 0 || static_cast<Wide>(toX) * speedY <= static_cast<Wide>(toY) * speedX);
        const bool byY = !byX && dy != 0;
        const Parameter out = byX ? Parameter{toX, speedX} : Parameter{toY, speedY};
        if (dz < 0 && h != emptyColumn && (!(byX || byY) || atOrBelow(out, h)))
            return agrees({static_cast<Wide>(oz) - h, -dz}, true);
        if (!byX && !byY) return result.status == reflection::TraceStatus::miss;
        in = out;
        if (byX)
            i += dx > 0 ? 1 : -1;
        else
            j += dy > 0 ? 1 : -1;
    }
}

}  // namespace app
