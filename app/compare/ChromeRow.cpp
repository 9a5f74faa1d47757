#include "app/compare/ChromeRow.h"

#include <cmath>

#include "app/report/ResultFile.h"

namespace app {

nlohmann::ordered_json toJson(const ChromeRow& row, const std::string& city) {
    const auto known = [](double value) {
        return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
    };
    return {{"compared", "chrome"},
            {"view", row.view},
            {"method", row.method},
            {"city", city},
            {"chrome_jobs", row.jobs},
            {"pixels", row.pixels},
            {"width", row.width},
            {"height", row.height},
            {"frame_ms", toJson(row.frame)},
            {"ratio_to_none", known(row.ratioToNone)},
            {"psnr_db", known(row.psnr)},
            {"mean_flip", known(row.flip)}};
}

}  // namespace app
