#include <spdlog/spdlog.h>

#include <algorithm>

#include "app/commands/CloseViews.h"
#include "app/compare/PictureErrorsOf.h"
#include "app/report/Table.h"

namespace app {

namespace {

std::string fileName(const CloseUp& what, const std::string& method) {
    std::string shot = what.name;
    std::erase(shot, ',');
    std::ranges::replace(shot, ' ', '_');
    return what.prefix + "_" + shot + "_" + method + ".png";
}

/// The rectangle of the pixels that count, and a few around.
std::pair<glm::ivec2, glm::ivec2> boundsOf(std::span<const unsigned char> mask, glm::ivec2 size) {
    constexpr int margin = 6;
    glm::ivec2 low = size, high(0);
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x)
            if (mask[static_cast<std::size_t>(y) * static_cast<std::size_t>(size.x) +
                     static_cast<std::size_t>(x)] != 0) {
                low = glm::min(low, glm::ivec2(x, y));
                high = glm::max(high, glm::ivec2(x + 1, y + 1));
            }
    low = glm::max(low - margin, glm::ivec2(0));
    return {low, glm::min(high + margin, size) - low};
}

/// One above the other.
Picture above(const Picture& upper, const Picture& lower) {
    Picture both = upper;
    both.height += lower.height;
    both.rgba.insert(both.rgba.end(), lower.rgba.begin(), lower.rgba.end());
    return both;
}

/// What counts alone, by several methods side by side, and below each its error against the truth.
Picture errorSheet(std::span<const Picture> pictures, const Picture& truth,
                   std::span<const unsigned char> mask) {
    const auto [corner, piece] = boundsOf(mask, {truth.width, truth.height});
    std::vector<Picture> tiles;
    for (const Picture& picture : pictures) {
        Picture difference = differencePicture(picture, truth);
        for (std::size_t i = 0; i < mask.size(); ++i)
            if (mask[i] == 0)
                std::fill_n(difference.rgba.begin() + static_cast<std::ptrdiff_t>(4 * i), 3, std::uint8_t{0});
        tiles.push_back(above(cutOut(picture, corner, piece), cutOut(difference, corner, piece)));
    }
    return beside(tiles);
}

}  // namespace

Picture beside(std::span<const Picture> pictures) {
    constexpr int gap = 4;
    const int w = pictures.front().width, h = pictures.front().height;
    const int n = static_cast<int>(pictures.size());
    Picture all{n * w + (n - 1) * gap, h, {}};
    all.rgba.assign(static_cast<std::size_t>(all.width) * static_cast<std::size_t>(all.height) * 4, 128);
    for (int i = 0; i < n; ++i)
        for (int y = 0; y < h; ++y)
            std::copy_n(pictures[static_cast<std::size_t>(i)].rgba.begin() + std::ptrdiff_t{4} * y * w, 4 * w,
                        all.rgba.begin() + std::ptrdiff_t{4} * (y * all.width + i * (w + gap)));
    return all;
}

void measureCloseUp(const Options& options, CloseViews& views, const CloseUp& what, ResultFile& results,
                    std::vector<std::vector<std::string>>& table) {
    if (!options.part.empty() && options.part != "picture") return;
    const std::vector<unsigned char> mask = views.pixelsOf(what.frame, what.counts);
    const auto pixels = std::count(mask.begin(), mask.end(), 1);
    if (pixels == 0) {
        spdlog::warn("{}: nothing of it is seen", what.name);
        return;
    }
    std::vector<Picture> strip(3), sheet;
    std::vector<CloseViews::Drawn> all = views.draw(what.frame, what.methods, mask);
    for (CloseViews::Drawn& drawn : all) {
        if (drawn.method == "chrome") {
            const ChromeCounts& c = drawn.counts;
            const ChromePlan& plan = drawn.plan;
            spdlog::info(
                "{}: {} jobs ({} open, {} too small, {} left out), {} pictures of {} texels in them, {} "
                "meshes, {} vertices, {} searched, {} "
                "triangles, {:.1f} ms ({:.1f} searching)",
                what.name, c.jobs, plan.open, plan.tooSmall, plan.leftOut, c.bounces.pictures, c.bounces.texels,
                c.meshes, c.vertices, c.searched, c.triangles, c.milliseconds, c.searchMilliseconds);
        }
        const std::string file = fileName(what, drawn.method);
        writePng(drawn.picture, options.out / file);
        nlohmann::ordered_json row{{"what", what.name},      {"method", drawn.method},
                                   {"city", options.city},   {"chrome_jobs", drawn.plan.jobs.size()},
                                   {"pixels", pixels},       {"psnr_db", drawn.psnr},
                                   {"mean_flip", drawn.flip}};
        row.update(what.more);
        results.add(std::move(row));
        table.push_back(
            {file, std::to_string(pixels), fixed(drawn.psnr, 1), fixed(drawn.flip, 4), "", "", "", ""});
        if (drawn.method == "mem" || drawn.method == "chrome" || drawn.method == "rerender" ||
            drawn.method == "raytrace" || drawn.method == "truth")
            sheet.push_back(drawn.picture);
        const std::size_t place = drawn.method == "mem"      ? 0
                                  : drawn.method == "chrome" ? 1
                                  : drawn.method == "truth"  ? 2
                                                             : strip.size();
        if (place < strip.size()) strip[place] = std::move(drawn.picture);
    }
    if (std::ranges::none_of(strip, [](const Picture& p) { return p.rgba.empty(); }))
        writePng(beside(strip), options.out / fileName(what, "mem_chrome_truth"));
    if (all.size() == what.methods.size())
        writePng(errorSheet(sheet, sheet.front(), mask), options.out / fileName(what, "errors"));
}

void measureMotion(const Options& options, CloseViews& views, const std::string& name,
                   const std::function<FrameScene(std::uint32_t)>& frameAt, std::uint32_t count,
                   const CloseViews::Counts& counts, ResultFile& results,
                   std::vector<std::vector<std::string>>& table) {
    if (!options.part.empty() && options.part != "motion") return;
    constexpr std::array<std::string_view, 4> methods{"truth", "mem", "chrome", "rerender"};
    for (const CloseViews::Motion& m : views.move(frameAt, count, methods, counts)) {
        if (m.frames == 0) continue;
        nlohmann::ordered_json row{{"what", name},
                                   {"method", m.method},
                                   {"city", options.city},
                                   {"pairs_of_frames", m.frames},
                                   {"frame_to_frame_flip", m.change},
                                   {"mean_flip", m.flip},
                                   {"flicker", m.flicker},
                                   {"worst_flicker", m.worst}};
        std::string jobs;
        if (m.method == "chrome") {
            row["least_chrome_jobs"] = m.leastJobs;
            row["most_chrome_jobs"] = m.mostJobs;
            jobs = ", " + std::to_string(m.leastJobs) + "-" + std::to_string(m.mostJobs) + " jobs";
        }
        results.add(std::move(row));
        table.push_back({name + ", " + m.method + jobs + ": frame to frame " + fixed(m.change, 4) +
                             ", flicker " + fixed(m.flicker, 5) + ", worst " + fixed(m.worst, 5),
                         "", "", fixed(m.flip, 4), "", "", "", ""});
    }
}

}  // namespace app
