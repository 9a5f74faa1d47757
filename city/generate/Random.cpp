#include "city/generate/Random.h"

namespace city {

namespace {

// Taylor series about 0; for |x| <= pi/4 the first omitted term is below 2e-9.
double sine(double x) {
    const double q = x * x;
    return x * (1 + q * (-1.0 / 6 + q * (1.0 / 120 + q * (-1.0 / 5040 + q * (1.0 / 362880)))));
}
double cosine(double x) {
    const double q = x * x;
    return 1 + q * (-0.5 + q * (1.0 / 24 + q * (-1.0 / 720 + q * (1.0 / 40320))));
}

}  // namespace

Turn::Turn(double turns) {
    const auto nearest = static_cast<long long>(turns * 4 + (turns < 0 ? -0.5 : 0.5));  // quarter turns
    const double x = (turns - static_cast<double>(nearest) * 0.25) * 6.283185307179586;
    const double s = sine(x), c = cosine(x);
    switch (((nearest % 4) + 4) % 4) {
        case 0:
            sin = static_cast<float>(s), cos = static_cast<float>(c);
            break;
        case 1:
            sin = static_cast<float>(c), cos = static_cast<float>(-s);
            break;
        case 2:
            sin = static_cast<float>(-s), cos = static_cast<float>(-c);
            break;
        default:
            sin = static_cast<float>(-c), cos = static_cast<float>(s);
            break;
    }
}

}  // namespace city
