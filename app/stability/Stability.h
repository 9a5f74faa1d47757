#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace app::stability {

/// One line of the table: what was tried at the edge of the range, how often, how wrong it got, and how wrong
/// it may get.
struct Row {
    std::string group;  ///< "tracer", "maps", ...
    std::string what;   ///< what was tried
    std::uint64_t tried = 0;
    std::uint64_t failures = 0;  ///< of those: wrong, missed, not a number, ...
    double worst = 0;            ///< greatest error, in `unit`
    double bound = 0;            ///< what it may be; +infinity: counted for comparison, not judged
    std::string unit;
    std::string boundFrom;  ///< where the bound comes from
    std::string example;    ///< the first failure, so that it can be repeated; empty without one

    bool judged() const;
    /// Something was tried, nothing failed, and the worst error is a number within its bound.
    bool passed() const;
};

struct Options {
    std::uint64_t seed = 1;
    /// Rays of the tracer's campaign. The other campaigns' sizes follow it: they try `effort()` times as much
    /// as in the tests.
    std::uint64_t rays = defaultRays;
    std::function<void(double)> progress;  ///< told the finished share of a campaign; may be empty
    std::function<bool()> interrupted;     ///< true: stop and return what is finished; may be empty

    static constexpr std::uint64_t defaultRays = 4'000'000;
    int effort() const;  ///< 1 .. 100
    bool stop() const { return interrupted && interrupted(); }
    void tell(double share) const {
        if (progress) progress(share);
    }
};

/// A part of the suite: pure (no graphics), deterministic for its options on every machine.
struct Campaign {
    std::string name;
    std::function<std::vector<Row>(const Options&)> run;
};

std::vector<Row> tryTracer(const Options& options);
std::vector<Row> tryHanging(const Options& options);
std::vector<Row> tryEmbree(const Options& options);
std::vector<Row> tryReferenceMaps(const Options& options);
std::vector<Row> tryMesh(const Options& options);
std::vector<Row> tryFrames(const Options& options);
std::vector<Row> tryTraffic(const Options& options);
std::vector<Row> trySettings(const Options& options);
std::vector<Row> tryMirrors(const Options& options);
std::vector<Row> tryChrome(const Options& options);

/// All of them, in the order in which they are told.
std::vector<Campaign> allCampaigns();

/// {"group","what","tried","failures","worst","bound","unit","bound_from","judged","passed","example"}.
nlohmann::ordered_json toJson(const Row& row);
/// One line for people; used as a test's message.
std::string describe(const Row& row);

}  // namespace app::stability
