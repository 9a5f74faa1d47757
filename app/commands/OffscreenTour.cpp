#include "app/commands/OffscreenTour.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <iostream>
#include <optional>

#include "app/commands/Drive.h"
#include "app/commands/TourReport.h"
#include "app/display/OffscreenContext.h"
#include "app/display/OffscreenTarget.h"
#include "app/frame/CameraRig.h"
#include "app/frame/ShotPlan.h"
#include "app/render/Readback.h"
#include "app/report/AsideFile.h"
#include "app/report/Picture.h"
#include "app/report/Progress.h"
#include "app/report/Timing.h"
#include "app/report/VideoWriter.h"

namespace app {

namespace {

// Without --seconds or --frames: ten seconds of driving if that is drawn within a minute, else as much as a
// minute allows, but never less than two seconds.
constexpr double defaultSeconds = 10;
constexpr double patienceMs = 60000;
constexpr double shortestSeconds = 2;
constexpr std::uint32_t framesBeforeChoice = 4;

std::uint32_t chooseLength(double msPerFrame, std::uint32_t fps) {
    const double wanted = defaultSeconds * fps;
    const double affordable = patienceMs / std::max(msPerFrame, 0.01);
    return static_cast<std::uint32_t>(
        std::clamp(affordable, std::min(shortestSeconds * fps, wanted), wanted));
}

/// Where a still is due: stills lie in the middles of equal parts of the drive.
bool stillDue(std::uint32_t frame, std::uint32_t frames, std::uint32_t stills) {
    if (stills == 0) return false;
    const auto at = [&](std::uint64_t k) {
        return static_cast<std::uint32_t>((2 * k + 1) * frames / (std::uint64_t{2} * stills));
    };
    const std::uint64_t near = static_cast<std::uint64_t>(frame) * stills / std::max(frames, 1u);
    return at(near) == frame || (near > 0 && at(near - 1) == frame) || at(near + 1) == frame;
}

std::string stillName(std::uint32_t number) {
    std::string digits = std::to_string(number);
    return "still_" + std::string(digits.size() < 2 ? 2 - digits.size() : 0, '0') + digits + ".png";
}

std::unique_ptr<VideoWriter> openVideo(const Options& options) {
    try {
        return std::make_unique<VideoWriter>(options.out / "tour.mp4", options.resolution.x,
                                             options.resolution.y, static_cast<int>(options.fps));
    } catch (const std::runtime_error& error) {
        spdlog::warn("no video, stills alone: {}", error.what());
        return nullptr;
    }
}

}  // namespace

int runOffscreenTour(const Options& asked) {
    Options options = asked;
    options.offscreen = true;
    requireWritable(options.out / "tour.mp4");
    const OffscreenContext context;
    spdlog::info("drawing without a window on {}", context.renderer());
    const Scene scene = loadScene(options);
    Drive drive(scene, options, context.renderer());
    TourReport report(options, context.renderer());
    if (!drive.startReflecting()) {
        spdlog::warn("interrupted before the first picture: the reference maps that are finished are kept");
        report.finish(true, std::cout);
        return exitFailed;
    }
    const OffscreenTarget target(options.resolution);
    CameraRig camera(scene.city.tour, scene.city.bounds);
    ShotPlan shots(options.camera, scene.kinds);
    std::unique_ptr<VideoWriter> video = openVideo(options);

    std::optional<std::uint32_t> frames = options.frameCount();
    std::optional<Progress> progress;
    const double frameTime = 1.0 / options.fps;
    std::uint32_t frame = 0;
    std::uint32_t stills = 0;
    Stopwatch total;
    for (; (!frames || frame < *frames) && !interrupted(); ++frame) {
        if (!frames && frame == framesBeforeChoice) {
            frames = chooseLength(total.elapsed() / frame, options.fps);
            spdlog::info(
                "{:.0f} ms a frame: drawing {:.1f} s of driving ({} frames); --seconds asks for another "
                "length",
                total.elapsed() / frame, *frames * frameTime, *frames);
        }
        if (frames && !progress) {
            progress.emplace("tour", *frames, options.quiet);
            progress->advance(frame);
        }
        drive.advance(frame == 0 ? 0 : frameTime);
        shots.direct(frame * frameTime, drive.traffic().poses(), camera);
        camera.update(frame == 0 ? 0 : frameTime, drive.traffic().poses(), {});
        const View view =
            lookAt(camera.pose().eye, camera.pose().target, glm::radians(60.0), options.resolution);
        report.add(drive.draw(view, target.framebuffer(), frame == 0 ? 0 : frameTime), drive.settings(),
                   options.resolution);

        Image8 image = readPixels(target.framebuffer(), options.resolution);
        const Picture picture{image.size.x, image.size.y, std::move(image.rgba)};
        if (frames && stillDue(frame, *frames, options.stills))
            writePng(picture, options.out / stillName(++stills));
        if (video) video->add(picture);
        if (progress) progress->advance();
    }
    progress.reset();
    if (video) {
        video->finish();
        if (video->frames() > 0)
            spdlog::info("video: {} ({} frames, {})", (options.out / "tour.mp4").string(), video->frames(),
                         video->encoder());
    }
    if (stills > 0)
        spdlog::info("stills: {} to {}", (options.out / stillName(1)).string(), stillName(stills));
    if (interrupted()) spdlog::warn("interrupted after {} frames: what was finished is kept", frame);
    report.finish(interrupted(), std::cout);
    return interrupted() ? exitFailed : exitOk;
}

}  // namespace app
