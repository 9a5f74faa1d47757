#include "app/commands/WindowTour.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <glm/trigonometric.hpp>
#include <iostream>
#include <thread>
#include <vector>

#include "app/commands/Drive.h"
#include "app/commands/TourReport.h"
#include "app/display/OffscreenTarget.h"
#include "app/display/Window.h"
#include "app/frame/CameraRig.h"
#include "app/frame/ShotPlan.h"
#include "app/panel/Controls.h"
#include "app/panel/MapView.h"
#include "app/panel/Panel.h"
#include "app/panel/WindowProgress.h"
#include "app/render/Readback.h"
#include "app/report/Picture.h"
#include "app/report/Progress.h"
#include "app/report/Timing.h"

namespace app {

namespace {

using namespace std::chrono_literals;

constexpr std::size_t graphLength = 180;  // frames
constexpr double longestStep = 0.1;       // seconds; a slow machine drives slowly rather than in jumps

CameraChoice choiceOf(const std::optional<CameraMode>& mode) {
    if (!mode) return CameraChoice::shots;
    return *mode == CameraMode::tour     ? CameraChoice::tour
           : *mode == CameraMode::follow ? CameraChoice::follow
                                         : CameraChoice::fly;
}

/// The first name of the form screenshot_NN.png that is free in the folder.
std::filesystem::path freeName(const std::filesystem::path& folder) {
    for (int n = 1;; ++n) {
        const std::string digits = std::to_string(n);
        std::filesystem::path file =
            folder / ("screenshot_" + std::string(digits.size() < 2 ? 1 : 0, '0') + digits + ".png");
        if (!std::filesystem::exists(file)) return file;
    }
}

/// Everything between the window's events and its next picture.
class WindowTour {
  public:
    WindowTour(const Options& options, Window& window, Panel& panel, WindowProgress& progress,
               const Scene& scene)
        : options_(options),
          window_(window),
          panel_(panel),
          progress_(progress),
          scene_(scene),
          drive_(scene, options, window.renderer()),
          camera_(scene.city.tour, scene.city.bounds),
          shots_(std::nullopt, scene.kinds),
          report_(options, window.renderer()) {
        choices_.settings = drive_.settings();
        choices_.camera = choiceOf(options.camera);
        if (options.camera) camera_.setMode(*options.camera, drive_.traffic().poses());
    }

    /// Makes the reference maps; false: the user did not want to wait for them.
    bool start();
    void frame();
    const TourReport& report() const { return report_; }

  private:
    void obey(const ControlResult& controls);
    void moveCamera(double seconds, const CameraInput& input);
    PanelNews news();
    void takeScreenshot();
    View view(glm::ivec2 size) const {
        return lookAt(camera_.pose().eye, camera_.pose().target, glm::radians(60.0), size);
    }
    /// Shows how far the reference maps are, over the street as it would look without them.
    CarryOn showWaiting(const std::string& remark);
    CarryOn showCalibrating();
    void endWaiting();

    Options options_;
    Window& window_;
    Panel& panel_;
    WindowProgress& progress_;
    const Scene& scene_;
    Drive drive_;
    CameraRig camera_;
    ShotPlan shots_;
    MapView mapView_;
    Controls controls_;
    PanelChoices choices_;
    CameraChoice cameraNow_ = CameraChoice::shots;
    TourReport report_;
    FrameStats stats_;
    std::vector<float> frameMs_;
    std::vector<MapLine> mesh_;
    std::vector<WindowEvent> waited_;  ///< keys that came up while maps were drawn
    bool looking_ = false;
    double time_ = 0;
    Stopwatch watch_;
};

CarryOn WindowTour::showWaiting(const std::string& remark) {
    const glm::ivec2 size = window_.framebufferSize();
    const bool longWork = choices_.settings.hour != drive_.settings().hour || drive_.engine() == nullptr;
    if (longWork && size.x > 0 && size.y > 0) {
        auto backdrop = std::make_unique<OffscreenTarget>(size);
        drive_.draw(view(size), backdrop->framebuffer(), 0);
        progress_.setBackdrop(std::move(backdrop));
    }
    return [this, remark](std::size_t done, std::size_t total) {
        return progress_.show({total == 0 ? "Choosing where reference maps stand ..."
                                          : "Drawing the street into reference maps, once: they are kept.",
                               done, total, remark});
    };
}

CarryOn WindowTour::showCalibrating() {
    return [this](std::size_t done, std::size_t total) {
        return progress_.show({"Measuring what details cost on this machine, once: it is kept.", done, total,
                               "Esc: without a budget."});
    };
}

void WindowTour::endWaiting() {
    waited_ = progress_.finish();
    watch_.lap();
}

bool WindowTour::start() {
    moveCamera(0, {});
    const bool ready =
        drive_.startReflecting(showWaiting("Esc quits; what is finished is kept."), showCalibrating());
    choices_.settings = drive_.settings();
    endWaiting();
    return ready;
}

void WindowTour::obey(const ControlResult& controls) {
    const ControlActions& actions = controls.actions;
    if (actions.quit) window_.requestClose();
    if (actions.pause) choices_.paused = !choices_.paused;
    if (actions.help) choices_.showHelp = !choices_.showHelp;
    if (actions.panel) choices_.showPanel = !choices_.showPanel;
    if (actions.nextCamera)
        choices_.camera = static_cast<CameraChoice>((static_cast<int>(choices_.camera) + 1) % 4);
    if (actions.nextMethod) {
        const auto count = static_cast<int>(reflectionMethodNames.size());
        choices_.settings.method =
            static_cast<ReflectionMethod>((static_cast<int>(choices_.settings.method) + 1) % count);
    }
    if (controls.looking != looking_) {
        looking_ = controls.looking;
        window_.captureCursor(looking_);
    }
    if (choices_.settings != drive_.settings()) {
        drive_.change(choices_.settings, showWaiting("Esc: stay with what was there before."),
                      showCalibrating());
        choices_.settings = drive_.settings();
        endWaiting();
    }
}

void WindowTour::moveCamera(double seconds, const CameraInput& input) {
    const auto vehicles = drive_.traffic().poses();
    // Flying or turning by hand ends the shots where they are.
    if (choices_.camera == CameraChoice::shots && input.look != glm::dvec2(0)) {
        choices_.camera = camera_.mode() == CameraMode::follow ? CameraChoice::follow : CameraChoice::fly;
        cameraNow_ = camera_.mode() == CameraMode::follow ? CameraChoice::follow : cameraNow_;
    }
    if (choices_.camera != cameraNow_) {
        cameraNow_ = choices_.camera;
        if (cameraNow_ == CameraChoice::tour) camera_.setMode(CameraMode::tour, vehicles);
        if (cameraNow_ == CameraChoice::follow) camera_.setMode(CameraMode::follow, vehicles);
        if (cameraNow_ == CameraChoice::fly) camera_.setMode(CameraMode::fly, vehicles);
    }
    if (choices_.nextVehicle != 0) {
        if (camera_.mode() != CameraMode::follow) camera_.setMode(CameraMode::follow, vehicles);
        camera_.followNext(vehicles, choices_.nextVehicle);
        choices_.camera = cameraNow_ = CameraChoice::follow;
    }
    if (cameraNow_ == CameraChoice::shots) shots_.direct(time_, vehicles, camera_);
    camera_.update(seconds, vehicles, input);
}

PanelNews WindowTour::news() {
    PanelNews news;
    news.renderer = window_.renderer();
    news.frameMs = frameMs_;
    news.reflections = stats_.reflections;
    news.drawn = stats_.drawn;
    news.mirrors = stats_.mirrors;
    news.chromeParts = stats_.chromeParts;
    news.chromeLeftOut = stats_.chromeLeftOut;
    news.chromeMaking = stats_.chromeMaking;
    news.chromeBytes = stats_.chromeBytes;
    news.vehicles = drive_.traffic().size();
    if (const Governor* governor = drive_.governor()) {
        news.ladder = governor->ladder().rungs();
        news.position = stats_.governed.position;
        news.predictedMs = stats_.governed.predictedMs;
        news.actualMs = governor->actualMs();
        news.predictedError = stats_.governed.error;
        news.givenUp = stats_.governed.givenUp;
    }
    if (camera_.mode() != CameraMode::follow) return news;
    const std::vector<vehicles::VehiclePose>& vehicles = drive_.frame().vehicles;
    const auto found = std::find_if(vehicles.begin(), vehicles.end(),
                                    [&](const auto& v) { return v.id == camera_.followed(); });
    if (found == vehicles.end()) return news;
    const vehicles::VehicleModel& model = scene_.models[found->model];
    news.followed = model.name;
    const auto index = static_cast<std::size_t>(found - vehicles.begin());
    const auto& slots = drive_.reflections().slots;
    if (!choices_.showMap || index >= slots.size() || !slots[index].valid()) return news;
    news.mapTexture =
        mapView_.draw(drive_.reflections().textures, slots[index],
                      drive_.frame().lighting.exposure * static_cast<float>(drive_.frame().adaptation));
    news.mapFaceSize = reflection::localMapFaceSizes[static_cast<std::size_t>(slots[index].sizeClass)];
    mesh_.clear();
    if (choices_.showMesh && drive_.settings().method == ReflectionMethod::mem && drive_.engine() != nullptr)
        for (int face = 0; face < 6; ++face) {
            int lattice = 0;
            const auto quads = drive_.engine()->meshOf(
                found->position + glm::dvec3(0, 0, 0.55 * model.height), face, news.mapFaceSize, lattice);
            const auto lines = unfoldedMesh(face, quads, lattice);
            mesh_.insert(mesh_.end(), lines.begin(), lines.end());
        }
    news.mesh = mesh_;
    return news;
}

void WindowTour::takeScreenshot() {
    const std::filesystem::path file = freeName(options_.out);
    try {
        Image8 image = readPixels(0, window_.framebufferSize());
        writePng({image.size.x, image.size.y, std::move(image.rgba)}, file);
        spdlog::info("screenshot: {}", file.string());
    } catch (const std::runtime_error& error) {
        spdlog::warn("no screenshot: {}", error.what());
    }
}

void WindowTour::frame() {
    std::vector<WindowEvent> events = window_.pollEvents();
    events.insert(events.begin(), waited_.begin(), waited_.end());
    waited_.clear();
    const ControlResult controls =
        controls_.update(events, panel_.takesMouse() && !looking_, panel_.takesKeys());
    obey(controls);
    const double seconds = std::min(watch_.lap() / 1000, longestStep);
    const glm::ivec2 size = window_.framebufferSize();
    // A minimised window keeps its size on some systems and has none on others.
    if (size.x < 1 || size.y < 1 || window_.minimised()) {
        std::this_thread::sleep_for(50ms);
        return;
    }
    if (!choices_.paused) {
        time_ += seconds;
        drive_.advance(seconds);
    }
    if (controls.actions.nextVehicle != 0) choices_.nextVehicle = controls.actions.nextVehicle;
    // Paused, the traffic stands; a free or circling camera may still move.
    const bool moving = !choices_.paused || camera_.mode() != CameraMode::tour;
    moveCamera(moving ? seconds : 0, controls.camera);
    const bool screenshot = controls.actions.screenshot || choices_.screenshot;

    stats_ = drive_.draw(view(size), 0, seconds);
    report_.add(stats_, drive_.settings(), size);
    if (frameMs_.size() == graphLength) frameMs_.erase(frameMs_.begin());
    frameMs_.push_back(static_cast<float>(stats_.frameMs));
    if (screenshot) takeScreenshot();
    panel_.draw(news(), choices_);
    window_.present();
}

}  // namespace

int runWindowTour(const Options& options) {
    Window window({.title = "mirrorstreet", .size = options.resolution});
    spdlog::info("drawing in a window on {}; F1 lists the keys", window.renderer());
    Panel panel(window);
    WindowProgress progress(window, panel);
    progress.show({.what = "Building the city ...", .remark = {}});
    const Scene scene = loadScene(options);
    progress.finish();
    WindowTour tour(options, window, panel, progress, scene);
    const bool ready = tour.start();
    const std::optional<std::uint32_t> frames = options.frameCount();
    while (ready && !window.closeRequested() && !interrupted() &&
           (!frames || tour.report().frames() < *frames))
        tour.frame();
    if (!ready)
        spdlog::warn("ended before the first picture: the reference maps that are finished are kept");
    else if (interrupted())
        spdlog::warn("interrupted after {} frames", tour.report().frames());
    tour.report().finish(!ready || interrupted(), std::cout);
    return interrupted() ? exitFailed : exitOk;
}

}  // namespace app
