#include "reflection/truth/ImageError.h"

#include <cmath>
#include <glm/common.hpp>
#include <limits>

#include "reflection/truth/SeparableFilter.h"

namespace reflection {

namespace {

bool comparable(const ImageView& a, const ImageView& b, PixelMask mask) {
    if (a.width < 1 || a.height < 1 || a.width != b.width || a.height != b.height) return false;
    const std::size_t count = static_cast<std::size_t>(a.width) * static_cast<std::size_t>(a.height);
    return a.pixels.size() >= count && b.pixels.size() >= count && (mask.empty() || mask.size() >= count);
}

constexpr double notANumber = std::numeric_limits<double>::quiet_NaN();

}  // namespace

double psnr(const ImageView& test, const ImageView& reference, PixelMask mask) {
    if (!comparable(test, reference, mask)) return notANumber;
    const std::size_t count = static_cast<std::size_t>(test.width) * static_cast<std::size_t>(test.height);
    double sum = 0;
    std::size_t counted = 0;
    for (std::size_t i = 0; i < count; ++i) {
        if (!mask.empty() && mask[i] == 0) continue;
        const glm::dvec3 difference = glm::dvec3(test.pixels[i]) - glm::dvec3(reference.pixels[i]);
        sum += difference.x * difference.x + difference.y * difference.y + difference.z * difference.z;
        ++counted;
    }
    if (counted == 0) return notANumber;
    if (sum == 0) return std::numeric_limits<double>::infinity();
    return -10 * std::log10(sum / (3 * static_cast<double>(counted)));
}

double ssim(const ImageView& test, const ImageView& reference, PixelMask mask) {
    constexpr int radius = 5;  // 11 x 11 window
    constexpr double sigma = 1.5;
    // (K1 L)^2 and (K2 L)^2 with the authors' K1 = 0.01, K2 = 0.03 and peak L = 1.
    constexpr float c1 = 0.01f * 0.01f;
    constexpr float c2 = 0.03f * 0.03f;
    if (!comparable(test, reference, mask)) return notANumber;
    const int width = test.width;
    const int height = test.height;
    Channel x(width, height), y(width, height), xx(width, height), yy(width, height), xy(width, height);
    const glm::vec3 luma(0.299f, 0.587f, 0.114f);  // the authors' rgb2gray
    for (std::size_t i = 0; i < x.values.size(); ++i) {
        const glm::vec3& p = test.pixels[i];
        const glm::vec3& q = reference.pixels[i];
        const float a = luma.x * p.x + luma.y * p.y + luma.z * p.z;
        const float b = luma.x * q.x + luma.y * q.y + luma.z * q.z;
        x.values[i] = a;
        y.values[i] = b;
        xx.values[i] = a * a;
        yy.values[i] = b * b;
        xy.values[i] = a * b;
    }
    const Kernel window = gaussianKernel(sigma, radius);
    for (Channel* channel : {&x, &y, &xx, &yy, &xy})
        *channel = filterColumns(filterRows(*channel, window), window);

    double sum = 0;
    std::size_t counted = 0;
    for (int row = radius; row < height - radius; ++row)
        for (int column = radius; column < width - radius; ++column) {
            const std::size_t i = static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                                  static_cast<std::size_t>(column);
            if (!mask.empty() && mask[i] == 0) continue;
            const float mx = x.values[i];
            const float my = y.values[i];
            const float vx = xx.values[i] - mx * mx;
            const float vy = yy.values[i] - my * my;
            const float covariance = xy.values[i] - mx * my;
            sum += (2 * mx * my + c1) * (2 * covariance + c2) / ((mx * mx + my * my + c1) * (vx + vy + c2));
            ++counted;
        }
    return counted == 0 ? notANumber : sum / static_cast<double>(counted);
}

double flicker(const ImageView& now, const ImageView& before, const ImageView& truthNow,
               const ImageView& truthBefore, PixelMask mask) {
    if (!comparable(now, before, mask) || !comparable(now, truthNow, mask) ||
        !comparable(now, truthBefore, mask))
        return notANumber;
    const std::size_t count = static_cast<std::size_t>(now.width) * static_cast<std::size_t>(now.height);
    double sum = 0;
    std::size_t counted = 0;
    for (std::size_t i = 0; i < count; ++i) {
        if (!mask.empty() && mask[i] == 0) continue;
        const glm::dvec3 own = glm::dvec3(now.pixels[i]) - glm::dvec3(before.pixels[i]);
        const glm::dvec3 wanted = glm::dvec3(truthNow.pixels[i]) - glm::dvec3(truthBefore.pixels[i]);
        const glm::dvec3 off = glm::abs(own - wanted);
        sum += off.x + off.y + off.z;
        ++counted;
    }
    return counted == 0 ? notANumber : sum / (3 * static_cast<double>(counted));
}

double meanError(std::span<const float> error, PixelMask mask) {
    double sum = 0;
    std::size_t counted = 0;
    for (std::size_t i = 0; i < error.size(); ++i) {
        if (!mask.empty() && (i >= mask.size() || mask[i] == 0)) continue;
        sum += error[i];
        ++counted;
    }
    return counted == 0 ? notANumber : sum / static_cast<double>(counted);
}

}  // namespace reflection
