#include <spdlog/spdlog.h>

#include <algorithm>

#include "app/commands/CloseViews.h"
#include "app/report/Table.h"

namespace app {

namespace {

std::string fileName(const CloseUp& what, const std::string& method) {
    std::string shot = what.name;
    std::erase(shot, ',');
    std::ranges::replace(shot, ' ', '_');
    return what.prefix + "_" + shot + "_" + method + ".png";
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
    const std::vector<unsigned char> mask = views.pixelsOf(what.frame, what.counts);
    const auto pixels = std::count(mask.begin(), mask.end(), 1);
    if (pixels == 0) {
        spdlog::warn("{}: nothing of it is seen", what.name);
        return;
    }
    std::vector<Picture> strip(3);
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
        const std::size_t place = drawn.method == "mem"      ? 0
                                  : drawn.method == "chrome" ? 1
                                  : drawn.method == "truth"  ? 2
                                                             : strip.size();
        if (place < strip.size()) strip[place] = std::move(drawn.picture);
    }
    if (std::ranges::none_of(strip, [](const Picture& p) { return p.rgba.empty(); }))
        writePng(beside(strip), options.out / fileName(what, "mem_chrome_truth"));
}

void measureMotion(const Options& options, CloseViews& views, const std::string& name,
                   const std::function<FrameScene(std::uint32_t)>& frameAt, std::uint32_t count,
                   const CloseViews::Counts& counts, ResultFile& results,
                   std::vector<std::vector<std::string>>& table) {
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
