#pragma once

#include <filesystem>
#include <functional>
#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/mirrors/MirrorWorld.h"
#include "app/render/MirrorStage.h"

namespace app {

/// A part of `bench mirrors`: a table, whose first row is the head, and rows for the result file.
struct MirrorRows {
    std::string title;
    std::vector<std::vector<std::string>> table;
    std::vector<nlohmann::ordered_json> rows;
};

struct MirrorBenchOptions {
    glm::ivec2 size{640, 480};
    std::optional<std::filesystem::path> save;  ///< pictures go here
    std::function<bool()> interrupted;
    std::function<void()> advance;  ///< told after each measurement
    bool stop() const { return interrupted && interrupted(); }
};

/// What Table 1 of Nielsen & Christensen 2002 says of a scene.
struct PaperRow {
    std::uint32_t viewDependent, dynamicPlanar, staticPlanar, curvedMaps;
    double usedDependent, traditionalDependent, usedIndependent, traditionalIndependent;  ///< 2^20 bytes
    double fpsDependent, fpsDynamic, fpsStatic;
};

/// Table 1 beside ours: what is generated, texture memory, time of a frame. `paper`: null for a scene that is
/// not the paper's. All mirrors that face the eye, no other culling: the paper's rule.
MirrorRows tableOne(const MirrorWorld& world, const PaperRow* paper, const MirrorBenchOptions& options);

/// Everything left out that can be, against everything drawn but the backs of mirrors (the paper's rule), at
/// depth 2: time and pixels. `eachEconomy`: and what each is worth.
MirrorRows culling(const MirrorWorld& world, const MirrorBenchOptions& options, bool eachEconomy);

/// Curved reflectors by every kind of map, against ray traced ones.
MirrorRows curvedError(const MirrorWorld& world, const MirrorBenchOptions& options);

/// Whether some flat mirror is rough, has waves or fades what it shows.
bool hasDisturbedMirrors(const MirrorWorld& world);

/// Such mirrors against the ray traced truth, and as if nothing disturbed them.
MirrorRows flatError(const MirrorWorld& world, const MirrorBenchOptions& options);

/// The scene with its curved reflectors made rough, by every kind of map, against the ray traced truth.
MirrorRows roughCurvedError(const MirrorWorld& world, const MirrorBenchOptions& options);

/// Two facing windows, depths 1 to 8: memory, time, and error against the ray traced truth of the same depth.
MirrorRows facingDepths(float roughness, const MirrorBenchOptions& options);

/// Maps against stencils, which draw flat mirrors right to the pixel: how far the maps are from that with the
/// picture's texels, with the paper's 256 x 256, and with bytes; and the times of both. Smooth flat mirrors
/// alone; curved ones are shown without a map.
MirrorRows againstStencil(const MirrorWorld& world, const MirrorBenchOptions& options);

/// Milliseconds from an idle context until a frame is finished.
double frameTime(MirrorStage& stage, const reflection::TreeSettings& settings);

/// A text as the name of a file: spaces as underscores, without marks.
std::string fileName(const std::string& text);

/// Linear radiance, row 0 at the top, as an sRGB picture DIR/name.png.
void saveRadiance(const std::vector<glm::vec3>& radiance, const glm::ivec2& size,
                  const std::filesystem::path& folder, const std::string& name);

}  // namespace app
