#include "app/compare/WindowRow.h"

#include <cmath>

#include "app/report/ResultFile.h"

namespace app {

nlohmann::ordered_json toJson(const WindowRow& row, const std::string& city) {
    const auto known = [](double value) {
        return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
    };
    return {{"compared", "windows"},
            {"method", row.name},
            {"city", city},
            {"cars", row.cars},
            {"depth", row.depth},
            {"most_maps", row.mostMaps},
            {"cut_off", row.cutOff},
            {"place", row.place},
            {"fronts_in_view", row.inView},
            {"fronts", row.fronts},
            {"windows", row.panes},
            {"passes", row.passes},
            {"levels", row.levels},
            {"texels", row.texels},
            {"mirror_triangles", row.triangles},
            {"mirror_texture_bytes", row.textureBytes},
            {"width", row.width},
            {"height", row.height},
            {"frame_ms", toJson(row.frame)},
            {"ratio_to_painted", known(row.ratioToPainted)},
            {"psnr_db", known(row.psnr)},
            {"mean_flip", known(row.flip)},
            {"wet", row.wet},
            {"water_psnr_db", known(row.waterPsnr)},
            {"water_mean_flip", known(row.waterFlip)}};
}

}  // namespace app
