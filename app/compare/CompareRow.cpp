#include "app/compare/CompareRow.h"

#include <algorithm>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <map>
#include <utility>

#include "app/compare/ParetoFront.h"
#include "app/report/ResultFile.h"

namespace app {

namespace {

CostAndError placeOf(const CompareRow& row) {
    // A reflection cannot cost less than nothing: that is the clock's noise.
    return {std::max(row.reflection.median, 0.0), row.againstTruth.flip};
}

nlohmann::ordered_json errorsOf(const PictureErrors& e) {
    return {{"psnr_db", e.psnr},    {"ssim", e.ssim},
            {"mean_flip", e.flip},  {"mean_hdr_flip", e.hdrFlip},
            {"flicker", e.flicker}, {"feature_angle_deg", glm::degrees(e.angle)}};
}

}  // namespace

void markFronts(std::vector<CompareRow>& rows) {
    std::map<std::pair<std::uint32_t, std::string>, std::vector<std::size_t>> groups;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        rows[i].onFront = false;
        groups[{rows[i].cars, rows[i].views}].push_back(i);
    }
    for (const auto& [key, members] : groups) {
        std::vector<CostAndError> places;
        for (const std::size_t i : members) places.push_back(placeOf(rows[i]));
        for (const std::size_t i : paretoFront(places)) rows[members[i]].onFront = true;
    }
}

std::vector<FrontVerdict> frontVerdicts(const std::vector<CompareRow>& rows) {
    std::vector<std::uint32_t> cars;
    for (const CompareRow& row : rows)
        if (std::find(cars.begin(), cars.end(), row.cars) == cars.end()) cars.push_back(row.cars);
    std::vector<FrontVerdict> verdicts;
    for (const std::uint32_t count : cars) {
        std::vector<CostAndError> mem;
        double dearest = 0;
        std::vector<FrontVerdict> here;
        for (const CompareRow& row : rows) {
            if (row.cars != count || row.views != "one") continue;
            if (row.point.method == "mem" && row.point.variant.empty()) mem.push_back(placeOf(row));
            if (row.point.method == "rerender" && row.point.isDefault) dearest = placeOf(row).cost;
        }
        if (mem.empty()) continue;
        const double cheapest = std::min_element(mem.begin(), mem.end(), [](const auto& a, const auto& b) {
                                    return a.cost < b.cost;
                                })->cost;
        for (const CompareRow& row : rows) {
            const std::string title = row.point.title();
            if (row.cars != count || row.views != "one" || title == "mem" || title == "none" ||
                (row.point.method == "rerender" && row.point.isDefault))
                continue;
            const CostAndError place = placeOf(row);
            if (!std::isfinite(place.error)) continue;
            auto verdict =
                std::find_if(here.begin(), here.end(), [&](const auto& v) { return v.other == title; });
            if (verdict == here.end()) verdict = here.insert(here.end(), FrontVerdict{count, title, 0, 0});
            // What is cheaper than mem's cheapest is beaten only where mem is there already.
            if (place.cost < cheapest || (dearest > 0 && place.cost > dearest)) continue;
            ++verdict->points;
            if (leastErrorFor(mem, place.cost) <= place.error) ++verdict->below;
        }
        verdicts.insert(verdicts.end(), here.begin(), here.end());
    }
    return verdicts;
}

nlohmann::ordered_json toJson(const CompareRow& row, const std::string& city) {
    nlohmann::ordered_json json{{"method", row.point.method},
                                {"variant", row.point.variant},
                                {"setting", row.point.setting},
                                {"set", settingsOf(row.point)},
                                {"default", row.point.isDefault},
                                {"city", city},
                                {"cars", row.cars},
                                {"visible", row.visible},
                                {"views", row.views},
                                {"view_count", row.viewCount},
                                {"width", row.width},
                                {"height", row.height},
                                {"frame_ms", toJson(row.frame)},
                                {"reflection_ms", toJson(row.reflection)},
                                {"ratio_to_none", row.ratioToNone},
                                {"ratio_to_rerender", row.ratioToRerender},
                                {"maps_updated_per_frame", row.mapsPerFrame},
                                {"texture_bytes", row.textureBytes},
                                {"on_front", row.onFront}};
    // The headline's names are those of every result file: against the truth.
    json.update(errorsOf(row.againstTruth));
    json["against_rerender"] = errorsOf(row.againstRerender);
    return json;
}

}  // namespace app
