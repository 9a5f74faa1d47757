#include "app/commands/TracerBench.h"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <vector>

#include "app/commands/EmbreeColumns.h"
#include "app/commands/IntegerReference.h"
#include "app/commands/TextbookDda.h"
#include "reflection/tracing/GridTracer.h"

namespace app {

namespace {

/// splitmix64 (Steele, Lea, Flood 2014): the same numbers on every machine.
class Random {
  public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    std::uint64_t next() {
        std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
        return z ^ (z >> 31);
    }
    int below(int n) { return static_cast<int>(next() % static_cast<std::uint64_t>(n)); }
    double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }

  private:
    std::uint64_t state_;
};

/// Rays of one origin after the other, so that fans and single rays are the same rays.
struct Fans {
    std::size_t fanSize = 0;
    std::vector<city::Ray> rays;
    std::vector<float> dx, dy, dz;  ///< the same directions as columns

    void add(const glm::vec3& origin, const glm::vec3& direction) {
        rays.push_back({origin, direction});
        dx.push_back(direction.x);
        dy.push_back(direction.y);
        dz.push_back(direction.z);
    }
};

/// Seconds of processor time of this thread: what other programs take from the core does not count.
double threadSeconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

constexpr int faceSize = 32;

/// On multiples of 2^-24, |component| <= 1: what the integer reference holds.
glm::vec3 onLattice(const glm::dvec3& d) {
    const auto snap = [](double v) {
        return static_cast<float>(std::ldexp(std::round(std::ldexp(v, 24)), -24));
    };
    return {snap(d.x), snap(d.y), snap(d.z)};
}

glm::vec3 randomDirection(Random& random) {
    const double z = 2 * random.unit() - 1;
    const double angle = 2 * std::numbers::pi * random.unit();
    const double r = std::sqrt(1 - z * z);
    return onLattice({r * std::cos(angle), r * std::sin(angle), z});
}

glm::vec3 cubeDirection(int face, int row, int column) {
    const double u = 2 * (column + 0.5) / faceSize - 1;
    const double v = 2 * (row + 0.5) / faceSize - 1;
    switch (face) {
        case 0:
            return onLattice(glm::normalize(glm::dvec3(1, v, u)));
        case 1:
            return onLattice(glm::normalize(glm::dvec3(-1, v, u)));
        case 2:
            return onLattice(glm::normalize(glm::dvec3(u, 1, v)));
        case 3:
            return onLattice(glm::normalize(glm::dvec3(u, -1, v)));
        case 4:
            return onLattice(glm::normalize(glm::dvec3(u, v, 1)));
        default:
            return onLattice(glm::normalize(glm::dvec3(u, v, -1)));
    }
}

/// A point 1.5 m above a cell at street level: one from which the nearest 5 m are no higher than half a metre
/// above it.
std::optional<glm::vec3> streetPoint(const city::Heightfield& field, Random& random) {
    for (int attempt = 0; attempt < 20000; ++attempt) {
        const int i = random.below(field.width());
        const int j = random.below(field.height());
        const float h = field.at(i, j);
        if (!std::isfinite(h)) continue;
        const int reach = std::max(1, static_cast<int>(5 / field.cellSize()));
        bool open = true;
        float around = -std::numeric_limits<float>::infinity();
        for (int v = std::max(0, j - 8 * reach); v <= std::min(field.height() - 1, j + 8 * reach); ++v)
            for (int u = std::max(0, i - 8 * reach); u <= std::min(field.width() - 1, i + 8 * reach); ++u) {
                const bool near = std::abs(u - i) <= reach && std::abs(v - j) <= reach;
                if (near && !(field.at(u, v) <= h + 0.5f)) open = false;
                around = std::max(around, field.at(u, v));
            }
        if (!open || around < h + 4) continue;  // on a roof, or far out of town
        const double cell = static_cast<double>(field.cellSize());
        const auto snap = [](double v) {
            return static_cast<float>(std::ldexp(std::floor(std::ldexp(v, 8)), -8));
        };
        return glm::vec3(snap(field.origin().x + (i + random.unit()) * cell),
                         snap(field.origin().y + (j + random.unit()) * cell),
                         snap(static_cast<double>(h) + 1.5));
    }
    return std::nullopt;
}

Fans streetFans(const city::Heightfield& field, int origins, bool cube, Random& random) {
    Fans fans;
    fans.fanSize = std::size_t{6} * faceSize * faceSize;
    for (int k = 0; k < origins; ++k) {
        const auto origin = streetPoint(field, random);
        if (!origin)
            throw std::runtime_error(
                "bench tracer: the heightfield has no streets to stand in; choose a city");
        for (int face = 0; face < 6; ++face)
            for (int row = 0; row < faceSize; ++row)
                for (int column = 0; column < faceSize; ++column)
                    fans.add(*origin, cube ? cubeDirection(face, row, column) : randomDirection(random));
    }
    return fans;
}

/// Rays for the comparison with the reference: mostly like the timed ones, partly on borders and through
/// corners.
Fans checkedFans(const city::Heightfield& field, std::size_t count, Random& random) {
    Fans fans;
    fans.fanSize = count;
    auto origin = streetPoint(field, random);
    if (!origin) return fans;
    const int kind = random.below(8);
    if (kind == 0) origin->x = std::floor(origin->x);
    if (kind <= 1) origin->y = std::floor(origin->y);
    for (std::size_t k = 0; k < count; ++k) {
        glm::vec3 d = randomDirection(random);
        switch (random.below(16)) {
            case 0:
                d = glm::vec3(random.below(9) - 4, random.below(9) - 4, random.below(9) - 4) * 0.125f;
                break;
            case 1:
                d[random.below(3)] = 0;
                break;
            case 2:
                d.z = static_cast<float>(random.below(5) - 2) * 0x1p-24f;
                break;
            default:
                break;
        }
        if (d == glm::vec3(0)) d.z = 1;
        fans.add(*origin, d);
    }
    return fans;
}

struct Method {
    std::string name;
    std::function<void(const Fans&, std::vector<float>&)> run;
    std::vector<double> rates{};  ///< million rays a second, one for each round
};

nlohmann::json summary(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return {{"min", values.front()},
            {"median", values[values.size() / 2]},
            {"max", values.back()},
            {"n", values.size()}};
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

struct Check {
    std::int64_t checked = 0;
    std::int64_t traceWrong = 0;
    std::int64_t fanWrong = 0;
};

Check compareWithReference(const city::Heightfield& field, const reflection::GridTracer& tracer,
                           std::int64_t rays, Random& random, const std::function<bool()>& stop) {
    Check check;
    const auto reference = IntegerReference::of(field);
    if (!reference) return check;
    constexpr std::size_t batch = 4096;
    std::vector<float> t(batch);
    while (check.checked < rays && !(stop && stop())) {
        const Fans fan = checkedFans(
            field, std::min<std::size_t>(batch, static_cast<std::size_t>(rays - check.checked)), random);
        if (fan.rays.empty()) break;
        tracer.traceFan(fan.rays[0].origin, fan.dx, fan.dy, fan.dz, t);
        for (std::size_t k = 0; k < fan.rays.size(); ++k) {
            reflection::TraceResult result = tracer.trace(fan.rays[k]);
            if (!reference->confirms(fan.rays[k], result)) ++check.traceWrong;
            if (!(t[k] == result.t)) ++check.fanWrong;
        }
        check.checked += static_cast<std::int64_t>(fan.rays.size());
    }
    return check;
}

}  // namespace

nlohmann::json runTracerBench(std::span<const TracerBenchField> fields, const TracerBenchOptions& options) {
    nlohmann::json rows = nlohmann::json::array();
    double done = 0;
    const double steps = static_cast<double>(fields.size()) * (2.0 * options.repeats + 4);
    const auto advance = [&](double by) {
        done += by;
        if (options.progress) options.progress(std::min(1.0, done / steps));
    };
    const auto stopped = [&] { return options.interrupted && options.interrupted(); };
    for (const TracerBenchField& subject : fields) {
        Random random(options.seed);
        const reflection::GridTracer tracer(subject.field);
        const float highest = subject.field.highest();
        std::vector<Method> methods;
        methods.push_back({"dda", [&](const Fans& fans, std::vector<float>& t) {
                               for (std::size_t k = 0; k < fans.rays.size(); ++k)
                                   t[k] = textbookDda(subject.field, highest, fans.rays[k]);
                           }});
        methods.push_back({"trace", [&](const Fans& fans, std::vector<float>& t) {
                               for (std::size_t k = 0; k < fans.rays.size(); ++k)
                                   t[k] = tracer.trace(fans.rays[k]).t;
                           }});
        methods.push_back({"fan", [&](const Fans& fans, std::vector<float>& t) {
                               const std::span dx(fans.dx), dy(fans.dy), dz(fans.dz);
                               const std::span out(t);
                               for (std::size_t k = 0; k < fans.rays.size(); k += fans.fanSize)
                                   tracer.traceFan(fans.rays[k].origin, dx.subspan(k, fans.fanSize),
                                                   dy.subspan(k, fans.fanSize), dz.subspan(k, fans.fanSize),
                                                   out.subspan(k, fans.fanSize));
                           }});
        std::optional<EmbreeColumns> quick, robust;
        if (options.embree) {
            quick.emplace(subject.field, false);
            robust.emplace(subject.field, true);
            methods.push_back(
                {"embree", [&](const Fans& f, std::vector<float>& t) { quick->single(f.rays, t); }});
            methods.push_back(
                {"embree_robust", [&](const Fans& f, std::vector<float>& t) { robust->single(f.rays, t); }});
            methods.push_back({"embree_packet16",
                               [&](const Fans& f, std::vector<float>& t) { quick->packets(f.rays, t); }});
            methods.push_back({"embree_packet16_robust",
                               [&](const Fans& f, std::vector<float>& t) { robust->packets(f.rays, t); }});
        }
        const Check check =
            compareWithReference(subject.field, tracer, options.checkedRays, random, options.interrupted);
        advance(4);
        for (const bool cube : {true, false}) {
            const Fans fans = streetFans(subject.field, options.origins, cube, random);
            std::vector<float> t(fans.rays.size());
            for (Method& method : methods) method.rates.clear();
            for (int round = 0; round < options.repeats && !stopped(); ++round) {
                for (Method& method : methods) {
                    const double start = threadSeconds();
                    method.run(fans, t);
                    const double time = threadSeconds() - start;
                    method.rates.push_back(static_cast<double>(fans.rays.size()) / time * 1e-6);
                }
                advance(1);
            }
            if (methods[0].rates.empty()) return rows;
            for (const Method& method : methods) {
                nlohmann::json row{{"bench", "tracer"},
                                   {"method", method.name},
                                   {"city", subject.city},
                                   {"rays", cube ? "cube" : "random"},
                                   {"mrays_per_s", summary(method.rates)},
                                   {"ratio_to_dda", median(method.rates) / median(methods[0].rates)}};
                if (method.name == "trace" || method.name == "fan") {
                    row["checked"] = check.checked;
                    row["disagreements"] = method.name == "trace" ? check.traceWrong : check.fanWrong;
                    row["t_bound_ulp"] = 0.5000001;
                }
                rows.push_back(std::move(row));
            }
        }
    }
    return rows;
}

TracerBenchField blockTown(std::uint64_t seed, int size) {
    Random random(seed);
    TracerBenchField town{"block_town", city::Heightfield(size, size, 1, {-size / 2.0, -size / 2.0})};
    // Streets of 12 to 26 m between blocks of 40 to 90 m; kerbs, courtyards, trees, and lower sheds in some
    // courts.
    const auto cuts = [&] {
        std::vector<std::pair<int, int>> blocks;
        for (int at = 8; at < size - 30;) {
            const int length = 40 + random.below(51);
            blocks.emplace_back(at, std::min(at + length, size - 8));
            at += length + 12 + random.below(15);
        }
        return blocks;
    };
    for (float& h : town.field.cells()) h = 0;
    const auto fill = [&](int x0, int y0, int x1, int y1, float h) {
        for (int j = std::max(0, y0); j < std::min(size, y1); ++j)
            for (int i = std::max(0, x0); i < std::min(size, x1); ++i) town.field.set(i, j, h);
    };
    const auto columns = cuts();
    const auto bands = cuts();
    for (const auto& [x0, x1] : columns)
        for (const auto& [y0, y1] : bands) {
            fill(x0 - 3, y0 - 3, x1 + 3, y1 + 3, 0.125f);
            if (random.below(12) == 0) {  // a square with trees
                for (int k = 0; k < 12; ++k) {
                    const int x = x0 + random.below(x1 - x0), y = y0 + random.below(y1 - y0);
                    fill(x - 2, y - 2, x + 3, y + 3, 6.0f + static_cast<float>(random.below(16)) * 0.25f);
                }
                continue;
            }
            for (int x = x0; x < x1;) {  // houses side by side, each with its own height
                const int next = std::min(x1, x + 12 + random.below(14));
                fill(x, y0, next, y1, 13 + 3.25f * static_cast<float>(random.below(5)));
                x = next;
            }
            fill(x0 + 13, y0 + 13, x1 - 13, y1 - 13, 0.0625f);
            for (int x = x0; x < x1; x += 9 + random.below(3))
                for (const int y : {y0 - 2, y1 + 1})
                    if (random.below(3) != 0) fill(x - 1, y - 1, x + 1, y + 2, 7);
        }
    return town;
}

}  // namespace app
