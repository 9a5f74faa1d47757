#include "reflection/truth/SeparableFilter.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace reflection {

Kernel gaussianKernel(double sigma, int radius) {
    std::vector<double> weights;
    double sum = 0;
    for (int x = -radius; x <= radius; ++x) {
        weights.push_back(std::exp(-x * x / (2 * sigma * sigma)));
        sum += weights.back();
    }
    Kernel kernel;
    for (double w : weights) kernel.push_back(static_cast<float>(w / sum));
    return kernel;
}

// Both filters add one weighted row at a time, which compilers turn into vector code; the order of the
// additions does not depend on the number of threads.
Channel filterRows(const Channel& image, const Kernel& kernel) {
    const int radius = static_cast<int>(kernel.size() / 2);
    Channel result(image.width, image.height);
    const auto width = static_cast<std::size_t>(image.width);
    tbb::parallel_for(0, image.height, [&](int row) {
        const float* from = image.values.data() + static_cast<std::size_t>(row) * width;
        float* to = result.values.data() + static_cast<std::size_t>(row) * width;
        std::vector<float> padded(width + 2 * static_cast<std::size_t>(radius));
        for (std::size_t i = 0; i < padded.size(); ++i)
            padded[i] = from[std::clamp(static_cast<int>(i) - radius, 0, image.width - 1)];
        for (std::size_t k = 0; k < kernel.size(); ++k) {
            const float weight = kernel[k];
            const float* shifted = padded.data() + k;
            for (std::size_t i = 0; i < width; ++i) to[i] += weight * shifted[i];
        }
    });
    return result;
}

Channel filterColumns(const Channel& image, const Kernel& kernel) {
    const int radius = static_cast<int>(kernel.size() / 2);
    Channel result(image.width, image.height);
    const auto width = static_cast<std::size_t>(image.width);
    tbb::parallel_for(0, image.height, [&](int row) {
        float* to = result.values.data() + static_cast<std::size_t>(row) * width;
        for (std::size_t k = 0; k < kernel.size(); ++k) {
            const int source = std::clamp(row + static_cast<int>(k) - radius, 0, image.height - 1);
            const float* from = image.values.data() + static_cast<std::size_t>(source) * width;
            const float weight = kernel[k];
            for (std::size_t i = 0; i < width; ++i) to[i] += weight * from[i];
        }
    });
    return result;
}

}  // namespace reflection
