#include <OpenImageIO/imageio.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/trigonometric.hpp>
#include <optional>
#include <stdexcept>

#include "app/commands/Benches.h"
#include "app/commands/Commands.h"
#include "app/commands/LoadScene.h"
#include "app/commands/MirrorMask.h"
#include "app/commands/Version.h"
#include "app/display/OffscreenContext.h"
#include "app/frame/AssembleFrame.h"
#include "app/frame/MirrorPlan.h"
#include "app/frame/ShotPlan.h"
#include "app/frame/WetRoad.h"
#include "app/raytrace/Edges.h"
#include "app/raytrace/PartedPicture.h"
#include "app/raytrace/RayTracer.h"
#include "app/render/SceneRenderer.h"
#include "app/report/AsideFile.h"
#include "app/report/Picture.h"
#include "app/report/Progress.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"
#include "app/report/Timing.h"
#include "reflection/gl/ScreenLight.h"
#include "reflection/gl/SoftwareRenderer.h"
#include "reflection/truth/ImageError.h"

namespace app {

namespace {

Picture pictureOf(const std::vector<glm::vec3>& pixels, glm::ivec2 size) {
    Picture picture{size.x, size.y, {}};
    for (const glm::vec3& p : pixels) {
        for (int c = 0; c < 3; ++c)
            picture.rgba.push_back(
                static_cast<std::uint8_t>(std::lround(255 * std::clamp(p[c], 0.0f, 1.0f))));
        picture.rgba.push_back(255);
    }
    return picture;
}

/// Half floats, linear. Throws std::runtime_error naming the file and the cause.
void writeRadiance(const std::vector<glm::vec3>& pixels, glm::ivec2 size, const std::filesystem::path& file) {
    AsideFile aside(file);
    const auto output = OIIO::ImageOutput::create(aside.aside().string());
    const OIIO::ImageSpec spec(size.x, size.y, 3, OIIO::TypeDesc::HALF);
    if (!output || !output->open(aside.aside().string(), spec) ||
        !output->write_image(OIIO::TypeDesc::FLOAT, pixels.data()) || !output->close())
        throw std::runtime_error(file.string() +
                                 " cannot be written: " + (output ? output->geterror() : OIIO::geterror()) +
                                 "; make room or choose another --out.");
    aside.commit();
}

/// Grey where two pictures are equal, ten times their difference elsewhere; edges dark.
std::vector<glm::vec3> difference(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b,
                                  const std::vector<unsigned char>& edges) {
    std::vector<glm::vec3> result(a.size());
    for (std::size_t i = 0; i < a.size(); ++i)
        result[i] = edges[i] != 0 ? glm::vec3(0.1f) : 0.5f + 10.0f * (a[i] - b[i]);
    return result;
}

/// The pixels that are not marked, of those that show a kind of thing, or of all.
std::vector<unsigned char> apartFrom(const std::vector<unsigned char>& edges, const TracedPicture& picture,
                                     std::optional<SeenKind> kind = std::nullopt) {
    std::vector<unsigned char> mask(edges.size());
    for (std::size_t i = 0; i < mask.size(); ++i)
        mask[i] = edges[i] == 0 && (!kind || picture.kind[i] == *kind) ? 1 : 0;
    return mask;
}

/// Traffic and camera as the tour has them without a window.
class Shots {
  public:
    Shots(const Scene& scene, const Options& options)
        : options_(&options),
          traffic_(startTraffic(scene, options.seed, options.cars.front())),
          camera_(scene.city.tour, scene.city.bounds),
          shots_(options.camera, scene.kinds) {}

    void advance() {
        const double step = 1.0 / options_->fps;
        if (frame_ > 0) {
            lead_ += step;
            for (double before = traffic_.time(); lead_ > 0; before = traffic_.time()) {
                traffic_.step();
                lead_ -= traffic_.time() - before;
            }
        }
        shots_.direct(frame_ * step, traffic_.poses(), camera_);
        camera_.update(frame_ == 0 ? 0 : step, traffic_.poses(), {});
        ++frame_;
    }
    const vehicles::Traffic& traffic() const { return traffic_; }
    View view() const {
        return lookAt(camera_.pose().eye, camera_.pose().target, glm::radians(60.0), options_->resolution);
    }

  private:
    const Options* options_;
    vehicles::Traffic traffic_;
    CameraRig camera_;
    ShotPlan shots_;
    std::uint32_t frame_ = 0;
    double lead_ = 0;
};

/// Draws and traces one frame in every way, writes the pictures, tells how far they agree.
class TruthStill {
  public:
    TruthStill(const Scene& scene, const Options& options, SceneRenderer& renderer, RayTracer& tracer)
        : scene_(scene),
          options_(options),
          renderer_(renderer),
          tracer_(tracer),
          planner_(scene.glass.fronts),
          target_(options.resolution) {
        if (windows() > 0) renderer_.setGlass(scene.glass.fronts);
    }

    /// False: interrupted; finished rows are kept for the next time.
    bool take(const FrameScene& frame, const std::string& number, ResultFile& results,
              std::vector<std::vector<std::string>>& table) {
        const View& view = frame.views.front();
        renderer_.prepare(frame);
        const std::vector<glm::vec3> drawn = draw(view, {}, {nullptr, 0, wet()});
        tracer_.prepare(frame);
        tracer_.useSunMap(renderer_.sunMap());
        TraceOptions plain;
        plain.plain = true;
        plain.wet = wet();
        const TracedPicture none = tracer_.render(view, plain);
        const std::vector<unsigned char> edges = edgesOf(none, view);
        const std::vector<glm::vec3> traced = none.display(scene_.lighting.exposure);

        TraceOptions full{static_cast<int>(options_.samples), static_cast<int>(options_.bounces), false,
                          options_.seed};
        full.windows = windows();
        full.wet = wet();
        full.mirrorFade = static_cast<float>(options_.mirrorFade);
        full.film = static_cast<int>(options_.samples);
        const std::filesystem::path parts = options_.out / ("truth_" + number + ".parts");
        const Stopwatch watch;
        std::optional<TracedPicture> truth;
        {
            std::optional<Progress> progress;
            int shown = 0;
            truth = renderInParts(tracer_, view, full, parts, pictureKey(scene_.city, frame, view, full),
                                  [&](int done, int total) {
                                      if (!progress)
                                          progress.emplace("truth " + number,
                                                           static_cast<std::uint64_t>(total), options_.quiet);
                                      progress->advance(static_cast<std::uint64_t>(done - shown));
                                      shown = done;
                                      return !interrupted();
                                  });
        }
        if (!truth) return false;
        const double seconds = watch.elapsed() / 1000;
        const std::vector<glm::vec3> shown = truth->display(scene_.lighting.exposure);
        const MirroredLight light = truth->mirroredLight();
        screen_.upload(light.radiance, light.size, light.low, light.high);
        VehicleReflections reflections;
        reflections.mirrored = screen_.name();
        const MirrorPlan plan = planOf(frame);
        const std::vector<glm::vec3> composed =
            draw(view, reflections, {windows() > 0 ? &plan : nullptr, 0, wet()});

        write(shown, "truth_" + number + ".png");
        write(composed, "composed_" + number + ".png");
        write(drawn, "none_drawn_" + number + ".png");
        write(traced, "none_traced_" + number + ".png");
        write(difference(traced, drawn, edges), "none_difference_" + number + ".png");
        writeRadiance(truth->radiance, truth->size, options_.out / ("truth_" + number + ".exr"));
        std::error_code ignored;
        std::filesystem::remove_all(parts, ignored);

        const auto agree = [&](const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b,
                               const std::vector<unsigned char>& mask) {
            const int w = options_.resolution.x, h = options_.resolution.y;
            return reflection::psnr({w, h, a}, {w, h, b}, mask);
        };
        const std::vector<unsigned char> apart = apartFrom(edges, none);
        const std::vector<unsigned char> cars = apartFrom(edges, none, SeenKind::vehicle);
        const double all = agree(traced, drawn, {}), outside = agree(traced, drawn, apart),
                     plainCars = agree(traced, drawn, cars), mirrors = agree(shown, composed, cars);
        const std::vector<glm::vec3> painted = windows() > 0 ? drawn : std::vector<glm::vec3>();
        nlohmann::ordered_json flat;
        std::vector<std::string> flatCells;
        // What mirrors flatly, with its reflections and without.
        for (const auto& [name, kind] : {std::pair("glass", SeenKind::glass), {"water", SeenKind::water}}) {
            const std::vector<unsigned char> mask = apartFrom(edgesOf(*truth, view), *truth, kind);
            const auto pixels = std::count(mask.begin(), mask.end(), 1);
            if (pixels == 0 || painted.empty()) {
                flatCells.emplace_back("-");
                continue;
            }
            const double db = agree(shown, composed, mask);
            const reflection::ImageView reference{options_.resolution.x, options_.resolution.y, shown};
            const double flip = reflection::meanError(
                reflection::flip({options_.resolution.x, options_.resolution.y, composed}, reference), mask);
            flat[name] = {{"pixels", pixels},
                          {"psnr_db", db},
                          {"mean_flip", flip},
                          {"without_reflections_psnr_db", agree(shown, painted, mask)}};
            flatCells.push_back(fixed(db, 1));
        }
        const double share = static_cast<double>(std::count(edges.begin(), edges.end(), 1)) /
                             static_cast<double>(edges.size());
        table.push_back({"truth_" + number + ".png", fixed(all, 1), fixed(outside, 1), fixed(plainCars, 1),
                         fixed(100 * share, 1), fixed(mirrors, 1), flatCells[0], flatCells[1],
                         fixed(seconds, 2)});
        results.add({{"method", "raytrace"},
                     {"city", options_.city},
                     {"picture", "truth_" + number + ".png"},
                     {"width", options_.resolution.x},
                     {"height", options_.resolution.y},
                     {"samples", options_.samples},
                     {"bounces", options_.bounces},
                     {"none_psnr_db", all},
                     {"none_psnr_outside_edges_db", outside},
                     {"none_psnr_vehicles_outside_edges_db", plainCars},
                     {"edge_share", share},
                     {"composed_psnr_vehicles_outside_edges_db", mirrors},
                     {"mirroring_pixels", light.pixels},
                     {"weather", weatherNames[static_cast<std::size_t>(options_.weather)]},
                     {"mirror_depth", windows()},
                     {"composed_outside_edges", flat},
                     {"seconds", seconds}});
        return true;
    }

  private:
    bool wet() const { return options_.weather == Weather::wet; }
    /// Flat mirrors in a row.
    int windows() const { return options_.mirrors ? options_.mirrorDepth : 0; }
    MirrorPlan planOf(const FrameScene& frame) const {
        if (windows() == 0) return {};
        MirrorSettings settings;
        settings.depth = windows();
        settings.maps = options_.mirrorMaps;
        settings.fade = options_.mirrorFade;
        if (wet()) settings.wetRoad = roadSeenBy(scene_.city.roads, frame.views.front());
        return planner_.plan(frame.views, settings,
                             [&](const auto& from, const auto* glass, const auto& box) {
                                 return renderer_.hides(from, glass, box);
                             });
    }
    std::vector<glm::vec3> draw(const View& view, const VehicleReflections& reflections,
                                const PlanarReflections& planar) {
        renderer_.drawView(view, reflections, target_.framebuffer(), planar);
        return toFloat(readPixels(target_.framebuffer(), target_.size()));
    }
    void write(const std::vector<glm::vec3>& pixels, const std::string& name) const {
        writePng(pictureOf(pixels, options_.resolution), options_.out / name);
    }

    const Scene& scene_;
    const Options& options_;
    SceneRenderer& renderer_;
    RayTracer& tracer_;
    MirrorPlanner planner_;
    OffscreenTarget target_;
    reflection::ScreenLight screen_;
};

int run(const Options& options) {
    requireWritable(options.out / "truth_01.png");
    const OffscreenContext context;
    const Scene scene = loadScene(options);
    RenderOptions rendering;
    rendering.antialiasing = Antialiasing::none;
    SceneRenderer renderer(scene.city, scene.models, rendering);
    RayTracer tracer(scene.city, scene.models);
    if (reflection::softwareRenderer()) tracer.useTextureFilter(TextureFilter::llvmpipe);
    TruthStill still(scene, options, renderer, tracer);
    Shots shots(scene, options);

    ResultFile results("truth", std::string(programVersion), context.renderer());
    std::vector<std::vector<std::string>> table{{"picture", "none dB", "outside edges", "its cars", "edges %",
                                                 "composed: cars", "its glass", "its water", "traced in s"}};
    // As the tour: ten seconds where nothing else is asked for, stills in the middles of equal parts.
    const std::uint32_t frames = options.frameCount().value_or(10 * options.fps);
    const std::uint32_t stills = std::clamp(options.stills, 1u, frames);
    std::uint32_t taken = 0;
    for (std::uint32_t frame = 0; frame < frames && taken < stills && !interrupted(); ++frame) {
        shots.advance();
        if (frame != (2 * std::uint64_t{taken} + 1) * frames / (2 * std::uint64_t{stills})) continue;
        ++taken;
        const std::string number = (taken < 10 ? "0" : "") + std::to_string(taken);
        if (!still.take(
                assembleFrame(scene.city, shots.traffic(), scene.lighting, {shots.view()}, scene.staged),
                number, results, table)) {
            spdlog::warn("interrupted: the rows that are finished are kept; ask for the same again to go on");
            break;
        }
    }
    return reportBench(options, results, table);
}

}  // namespace

Command truthCommand() {
    return {
        .name = "truth",
        .summary =
            "ray traced pictures of a drive, and how far ray tracer and rasteriser agree; goes on where it "
            "was interrupted",
        .groups = cityOptions | trafficOptions | pictureOptions | outOptions | jsonOptions | durationOptions |
                  shotOptions | rayOptions | mirrorOptions,
        .benches = {},
        .run = run};
}

}  // namespace app
