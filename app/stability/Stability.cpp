#include "app/stability/Stability.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace app::stability {

bool Row::judged() const {
    return std::isfinite(bound);
}

bool Row::passed() const {
    if (!judged()) return true;
    return tried > 0 && failures == 0 && worst <= bound;  // false for a NaN
}

int Options::effort() const {
    return static_cast<int>(std::clamp<std::uint64_t>(rays / defaultRays, 1, 100));
}

std::vector<Campaign> allCampaigns() {
    return {{"tracer", tryTracer},      {"hanging", tryHanging},   {"embree", tryEmbree},
            {"maps", tryReferenceMaps}, {"mesh", tryMesh},         {"frames", tryFrames},
            {"traffic", tryTraffic},    {"settings", trySettings}, {"mirrors", tryMirrors},
            {"chrome", tryChrome}};
}

nlohmann::ordered_json toJson(const Row& row) {
    nlohmann::ordered_json json{{"group", row.group},     {"what", row.what},
                                {"tried", row.tried},     {"failures", row.failures},
                                {"worst", row.worst},     {"bound", row.bound},
                                {"unit", row.unit},       {"bound_from", row.boundFrom},
                                {"judged", row.judged()}, {"passed", row.passed()}};
    if (!row.example.empty()) json["example"] = row.example;
    return json;
}

std::string describe(const Row& row) {
    std::array<char, 160> numbers{};
    std::snprintf(numbers.data(), numbers.size(), ": tried %llu, failed %llu, worst %.6g, bound %.6g ",
                  static_cast<unsigned long long>(row.tried), static_cast<unsigned long long>(row.failures),
                  row.worst, row.bound);
    return row.group + ", " + row.what + numbers.data() + row.unit + " (" + row.boundFrom + ")" +
           (row.example.empty() ? "" : "; first failure: " + row.example);
}

}  // namespace app::stability
