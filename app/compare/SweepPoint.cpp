#include "app/compare/SweepPoint.h"

#include <array>
#include <sstream>

namespace app {

namespace {

std::string thousands(double texels) {
    std::ostringstream text;
    text << texels / 1000 << "k texels";
    return text.str();
}

std::string detailText(double texelsPerPixel) {
    std::ostringstream text;
    text << texelsPerPixel << " texels/px";
    return text.str();
}

SweepPoint memPoint(Quality quality, double texelsPerPixel, double budget) {
    SweepPoint p;
    p.method = "mem";
    p.quality = quality;
    p.texelsPerPixel = texelsPerPixel;
    p.texelBudget = budget;
    // As the named qualities have them.
    p.errorThreshold = quality == Quality::low ? 1 : quality == Quality::medium ? 0.5 : 0.25;
    p.candidates = quality == Quality::low ? 2 : quality == Quality::medium ? 3 : 6;
    p.lookups = quality == Quality::high ? 6 : 4;
    p.setting = std::string(nameOf(quality)) + ", " + detailText(texelsPerPixel) + ", " + thousands(budget);
    return p;
}

SweepPoint everyFrame(SweepPoint p) {
    p.everyFrame = true;
    p.setting = std::string(nameOf(p.quality)) + ", " + detailText(p.texelsPerPixel) + ", every frame";
    return p;
}

}  // namespace

nlohmann::ordered_json settingsOf(const SweepPoint& p) {
    nlohmann::ordered_json set = nlohmann::ordered_json::object();
    if (p.method == "none" || p.method == "static") return set;
    if (p.method == "raytrace") return {{"samples", p.samples}};
    if (p.mapsInTurn > 0) set["maps_in_turn"] = p.mapsInTurn;
    if (p.everyFrame || (p.method == "rerender" && p.mapsInTurn == 0) || p.variant == "paper")
        set["every_frame"] = true;
    else if (p.mapsInTurn == 0) {
        set["texel_budget"] = p.texelBudget;
        set["error_threshold_px"] = p.errorThreshold;
    }
    if (p.faceSize > 0)
        set["face_size"] = p.faceSize;
    else
        set["texels_per_pixel"] = p.texelsPerPixel;
    if (p.method == "mem" && p.variant.empty()) {
        set["candidates"] = p.candidates;
        set["lookups"] = p.lookups;
        set["parallax"] = p.parallax;
    }
    return set;
}

std::vector<SweepPoint> comparedPoints(bool raytrace) {
    std::vector<SweepPoint> points;
    const auto add = [&](SweepPoint p, std::string method, std::string setting) -> SweepPoint& {
        p.method = std::move(method);
        p.setting = std::move(setting);
        points.push_back(std::move(p));
        return points.back();
    };
    SweepPoint& none = add({}, "none", "plain paint");
    none.isDefault = none.severalViews = true;
    add({}, "static", "one map for all").isDefault = true;
    for (const std::string method : {"blend", "box"}) {
        for (const Quality quality : {Quality::low, Quality::medium, Quality::high}) {
            SweepPoint p = memPoint(quality,
                                    quality == Quality::low      ? 0.25
                                    : quality == Quality::medium ? 0.5
                                                                 : 1,
                                    quality == Quality::low      ? 60'000
                                    : quality == Quality::medium ? 80'000
                                                                 : 500'000);
            p.isDefault = quality == Quality::medium;
            const std::string setting = p.setting;
            add(p, method, setting);
        }
    }
    for (const Quality quality : {Quality::low, Quality::medium, Quality::high}) {
        const double detail = quality == Quality::low ? 0.25 : quality == Quality::medium ? 0.5 : 1;
        SweepPoint& p =
            add(everyFrame(memPoint(quality, detail, 0)), "mem", detailText(detail) + ", every frame");
        p.variant = "paper";
        p.isDefault = quality == Quality::medium;
    }

    points.push_back(memPoint(Quality::low, 0.125, 5'000));
    points.push_back(memPoint(Quality::low, 0.25, 10'000));
    points.push_back(memPoint(Quality::low, 0.25, 60'000));
    points.push_back(memPoint(Quality::medium, 0.5, 20'000));
    points.push_back(memPoint(Quality::medium, 0.5, 40'000));
    points.push_back(memPoint(Quality::medium, 0.5, 80'000));
    points.back().isDefault = points.back().severalViews = true;
    points.push_back(memPoint(Quality::medium, 0.5, 80'000));
    points.back().parallax = false;
    points.back().setting += ", no parallax";
    points.push_back(memPoint(Quality::medium, 0.5, 160'000));
    points.push_back(everyFrame(memPoint(Quality::medium, 0.5, 0)));
    points.push_back(memPoint(Quality::high, 1, 200'000));
    points.push_back(memPoint(Quality::high, 1, 500'000));
    points.push_back(everyFrame(memPoint(Quality::high, 1, 0)));

    for (const std::uint32_t turn : {1u, 3u, 10u, 30u})
        for (const int size : {16, 64, 128}) {
            SweepPoint p;
            p.mapsInTurn = turn;
            p.faceSize = size;
            add(p, "rerender",
                std::to_string(turn) + (turn == 1 ? " car" : " cars") + " a frame, faces of " +
                    std::to_string(size));
        }
    for (const int size : {16, 64}) {
        SweepPoint p;
        p.faceSize = size;
        add(p, "rerender", "every car, faces of " + std::to_string(size));
    }
    SweepPoint& full = add({}, "rerender", "every car, every frame");
    full.isDefault = full.severalViews = true;
    if (raytrace) {
        SweepPoint& p = add({}, "raytrace", "a ray a pixel");
        p.isDefault = p.severalViews = true;
    }
    return points;
}

}  // namespace app
