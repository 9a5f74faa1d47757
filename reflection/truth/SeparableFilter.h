#pragma once

#include <cstddef>
#include <vector>

namespace reflection {

/// One channel of an image, row-major.
struct Channel {
    Channel(int w, int h)
        : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
    int width;
    int height;
    std::vector<float> values;
};

/// Weights at offsets -radius..radius; size 2 radius + 1.
using Kernel = std::vector<float>;

/// A Gaussian with weights that sum to 1.
Kernel gaussianKernel(double sigma, int radius);

/// Correlation along rows or columns; the border's pixels go on for ever outside. Cost: pixels * weights, on
/// all processors.
Channel filterRows(const Channel& image, const Kernel& kernel);
Channel filterColumns(const Channel& image, const Kernel& kernel);

}  // namespace reflection
