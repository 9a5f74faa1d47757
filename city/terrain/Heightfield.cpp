#include "city/terrain/Heightfield.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace city {

Heightfield::Heightfield(int width, int height, float cellSize, glm::dvec2 origin)
    : width_(width), height_(height), cellSize_(cellSize), origin_(origin) {
    if (width < 1 || height < 1)
        throw std::invalid_argument("a heightfield needs at least one cell in each direction");
    if (!std::isfinite(cellSize) || cellSize <= 0)
        throw std::invalid_argument("a heightfield's cell size must be finite and positive");
    if (!std::isfinite(origin.x) || !std::isfinite(origin.y))
        throw std::invalid_argument("a heightfield's origin must be finite");
    cells_.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                  -std::numeric_limits<float>::infinity());
}

float Heightfield::heightAt(double x, double y) const {
    const double i = std::floor((x - origin_.x) / cellSize_);
    const double j = std::floor((y - origin_.y) / cellSize_);
    if (!(i >= 0 && i < width_ && j >= 0 && j < height_)) return -std::numeric_limits<float>::infinity();
    return at(static_cast<int>(i), static_cast<int>(j));
}

float Heightfield::highest() const {
    float top = -std::numeric_limits<float>::infinity();
    for (float z : cells_)
        if (std::isfinite(z)) top = std::max(top, z);
    return top;
}

}  // namespace city
