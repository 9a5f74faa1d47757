#include "app/frame/Detail.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace app {

namespace {

double byRatio(double a, double b, double t) {
    return a > 0 && b > 0 ? a * std::pow(b / a, t) : a + (b - a) * t;
}

double evenly(double a, double b, double t) {
    return a + (b - a) * t;
}

std::string number(double x, const char* format) {
    char text[32];
    std::snprintf(text, sizeof text, format, x);
    return text;
}

}  // namespace

ReflectionDetail detailOf(Quality quality) {
    // Candidates, measured over ten places: a third map adds 0.2 dB (paper) to 0.7 dB (boulevard) to two, six
    // add 0.4 dB to three for a fifth more time.
    switch (quality) {
        case Quality::low:
            return {60'000, 0.25, 1, 2, 4};
        case Quality::high:
            return {500'000, 1, 0.25, 6, 6};
        case Quality::medium:
            break;
    }
    return {};
}

Detail blend(const Detail& a, const Detail& b, double t) {
    if (!(t > 0)) return a;
    if (!(t < 1)) return b;
    Detail detail;
    const ReflectionDetail &x = a.reflection, &y = b.reflection;
    detail.reflection = {byRatio(x.texelBudget, y.texelBudget, t),
                         byRatio(x.texelsPerPixel, y.texelsPerPixel, t),
                         byRatio(x.errorThreshold, y.errorThreshold, t),
                         evenly(x.candidates, y.candidates, t), evenly(x.lookups, y.lookups, t)};
    detail.drawing = {evenly(a.drawing.scale, b.drawing.scale, t),
                      evenly(a.drawing.antialiasing, b.drawing.antialiasing, t),
                      byRatio(a.drawing.vehicleTolerance, b.drawing.vehicleTolerance, t)};
    detail.mirrors = {byRatio(a.mirrors.texels, b.mirrors.texels, t),
                      evenly(a.mirrors.maps, b.mirrors.maps, t), evenly(a.mirrors.depth, b.mirrors.depth, t)};
    detail.chrome = {byRatio(a.chrome.leastPixels, b.chrome.leastPixels, t),
                     byRatio(a.chrome.bouncePixels, b.chrome.bouncePixels, t)};
    return detail;
}

std::string givenUp(const Detail& full, const Detail& now) {
    std::string text;
    const auto add = [&](const std::string& what) { text += (text.empty() ? "" : ", ") + what; };
    const ReflectionDetail &was = full.reflection, &is = now.reflection;
    if (is.texelBudget < was.texelBudget)
        add("maps: " + number(is.texelBudget / 1000, "%.0f") + "k texels a frame, not " +
            number(was.texelBudget / 1000, "%.0f") + "k");
    if (is.texelsPerPixel < was.texelsPerPixel)
        add(number(is.texelsPerPixel, "%.2f") + " texels a pixel, not " + number(was.texelsPerPixel, "%.2f"));
    if (is.errorThreshold > was.errorThreshold)
        add(number(is.errorThreshold, "%.2f") + " pixels of shift let stand, not " +
            number(was.errorThreshold, "%.2f"));
    if (std::round(is.candidates) < std::round(was.candidates))
        add(number(std::round(is.candidates), "%.0f") + " reference maps asked, not " +
            number(std::round(was.candidates), "%.0f"));
    if (std::round(is.lookups) < std::round(was.lookups))
        add(number(std::round(is.lookups), "%.0f") + " lookups, not " +
            number(std::round(was.lookups), "%.0f"));
    if (now.drawing.scale < full.drawing.scale)
        add("drawn at " + number(100 * now.drawing.scale, "%.0f") + "% of the size");
    if (now.drawing.antialiasing < full.drawing.antialiasing)
        add(now.drawing.antialiasing <= 0
                ? "no antialiasing"
                : "antialiasing in " + number(100 * now.drawing.antialiasing, "%.0f") + "% of the picture");
    if (now.drawing.vehicleTolerance > full.drawing.vehicleTolerance)
        add("vehicles off by " + number(now.drawing.vehicleTolerance, "%.1f") + " pixels, not " +
            number(full.drawing.vehicleTolerance, "%.1f"));
    const MirrorDetail &fullMirrors = full.mirrors, &nowMirrors = now.mirrors;
    if (nowMirrors.texels < fullMirrors.texels)
        add("windows at " + number(100 * nowMirrors.texels, "%.0f") + "% of the size");
    const auto count = [&](const char* of, double before, double after) {
        if (std::round(after) < std::round(before))
            add(of + number(std::round(after), "%.0f") + ", not " + number(std::round(before), "%.0f"));
    };
    count("reflections in windows: ", fullMirrors.maps, nowMirrors.maps);
    count("windows in a row: ", fullMirrors.depth, nowMirrors.depth);
    const auto chrome = [&](const char* what, double before, double after) {
        if (!(after > before)) return;
        const std::string things = std::string("close things in ") + what;
        add(after >= ChromeDetail::none
                ? "no " + things
                : things + " from " + number(after, "%.0f") + " pixels on, not " + number(before, "%.0f"));
    };
    chrome("chrome", full.chrome.leastPixels, now.chrome.leastPixels);
    chrome("chrome seen in chrome", full.chrome.bouncePixels, now.chrome.bouncePixels);
    return text;
}

}  // namespace app
