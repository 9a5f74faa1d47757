#include <spdlog/spdlog.h>

#include <array>
#include <cstdio>
#include <iostream>

#include "app/commands/Commands.h"
#include "app/commands/Version.h"
#include "app/report/Progress.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"
#include "app/stability/DrawingCampaign.h"
#include "app/stability/Stability.h"

namespace app {

namespace {

std::string shortNumber(double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.3g", value);
    return text.data();
}

int run(const Options& options) {
    stability::Options settings;
    settings.seed = options.seed;
    settings.rays = options.rays;
    settings.interrupted = interrupted;

    ResultFile results("stability", std::string(programVersion), "");
    std::vector<std::vector<std::string>> table{
        {"what was tried", "how often", "failed", "worst", "bound", "", ""}};
    std::size_t outside = 0;
    std::vector<stability::Campaign> campaigns = stability::allCampaigns();
    campaigns.push_back({"drawing", stability::tryDrawing});
    for (const stability::Campaign& campaign : campaigns) {
        if (interrupted()) break;
        Progress progress("stability: " + campaign.name, 1000, options.quiet);
        std::uint64_t shown = 0;
        settings.progress = [&](double share) {
            const auto done = static_cast<std::uint64_t>(share * 1000);
            if (done > shown) progress.advance(done - shown);
            shown = std::max(shown, done);
        };
        for (const stability::Row& row : campaign.run(settings)) {
            if (row.tried == 0 && interrupted()) continue;
            results.add(stability::toJson(row));
            table.push_back({row.group + ": " + row.what, std::to_string(row.tried),
                             row.judged() ? std::to_string(row.failures) : "-", shortNumber(row.worst),
                             row.judged() ? shortNumber(row.bound) : "-", row.unit,
                             row.passed() ? (row.judged() ? "ok" : "") : "FAILED"});
            if (row.passed()) continue;
            ++outside;
            spdlog::error("{}", stability::describe(row));
        }
    }
    std::cout << formatTable(table);
    if (options.json) results.write(*options.json, interrupted());
    if (outside > 0) spdlog::error("{} rows are outside their bounds", outside);
    if (interrupted()) spdlog::warn("interrupted: what was tried until then is kept");
    return outside > 0 || interrupted() ? exitFailed : exitOk;
}

}  // namespace

Command stabilityCommand() {
    return {.name = "stability",
            .summary = "tries everything at the edges of its range against exact references",
            .groups = stabilityOptions | jsonOptions,
            .benches = {},
            .run = run};
}

}  // namespace app
