#include "app/commands/Benches.h"
#include "app/commands/LoadScene.h"
#include "app/commands/TracerBench.h"
#include "app/commands/Version.h"
#include "app/report/Progress.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"
#include "city/model/CityHeightfield.h"

namespace app {

int benchTracer(const Options& options) {
    const city::CityModel city = loadCityOf(options);
    std::vector<TracerBenchField> fields;
    fields.push_back(blockTown(options.seed));
    fields.push_back({options.city, city::cityHeightfield(city, static_cast<float>(options.cell))});

    Progress progress("bench tracer", 1000, options.quiet);
    std::uint64_t shown = 0;
    TracerBenchOptions settings;
    settings.seed = options.seed;
    settings.interrupted = interrupted;
    settings.progress = [&](double share) {
        const auto done = static_cast<std::uint64_t>(share * 1000);
        if (done > shown) progress.advance(done - shown);
        shown = std::max(shown, done);
    };
    const nlohmann::json rows = runTracerBench(fields, settings);

    ResultFile results("tracer", std::string(programVersion), "");
    std::vector<std::vector<std::string>> table{
        {"city, rays, method", "Mrays/s", "of dda", "checked", "wrong"}};
    for (const nlohmann::json& row : rows) {
        results.add(row);
        table.push_back({row["city"].get<std::string>() + ", " + row["rays"].get<std::string>() + ", " +
                             row["method"].get<std::string>(),
                         fixed(row["mrays_per_s"]["median"].get<double>(), 1),
                         fixed(row["ratio_to_dda"].get<double>(), 2),
                         row.contains("checked") ? row["checked"].dump() : "",
                         row.contains("disagreements") ? row["disagreements"].dump() : ""});
    }
    return reportBench(options, results, table);
}

}  // namespace app
