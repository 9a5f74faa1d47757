#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/compare/CompareRow.h"
#include "app/compare/PictureStrip.h"
#include "app/report/Timing.h"

namespace app {

/// One way of drawing a city's windows: what it costs and how wrong it is.
struct WindowRow {
    std::string name;              ///< "painted windows", "depth 2, 4 maps at most"
    int depth = 0;                 ///< mirrors in a row; 0: none
    std::uint32_t mostMaps = 0;    ///< reflections a frame at most
    bool cutOff = true;            ///< reflections that hardly show are left out
    std::uint32_t cars = 0;        ///< on screen
    std::string place = "street";  ///< "street": of many cars; "fronts": where most fronts are in view
    std::uint32_t inView = 0;      ///< fronts before which nothing stands but what occlusion finds
    std::uint32_t fronts = 0, panes = 0, passes = 0, levels = 0;
    std::uint64_t texels = 0, triangles = 0, textureBytes = 0;
    int width = 0, height = 0;
    Timing frame;
    double ratioToPainted = PictureErrors::unknown;
    double psnr = PictureErrors::unknown, flip = PictureErrors::unknown;  ///< on glass, against the truth
    bool wet = false;                                                     ///< the streets, in the truth too
    double waterPsnr = PictureErrors::unknown, waterFlip = PictureErrors::unknown;  ///< on wet ground
};

/// The windows of a comparison; no rows where the city has none.
struct WindowComparison {
    std::vector<WindowRow> rows;
    std::vector<PictureStrip> strips;
};

/// In the words of result files; of all that is measured of windows, by whatever command.
nlohmann::ordered_json toJson(const WindowRow& row, const std::string& city);

}  // namespace app
