#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "app/commands/Drive.h"
#include "app/commands/Options.h"

namespace app {

/// Gathers what the frames of a drive took, for the table at its end and for `--json`.
class TourReport {
  public:
    TourReport(const Options& options, std::string renderer);

    void add(const FrameStats& stats);
    std::size_t frames() const { return frameMs_.size(); }

    /// Prints the table and writes the JSON file if one was asked for.
    void finish(bool partial, std::ostream& out) const;

  private:
    Options options_;
    std::string renderer_;
    std::vector<double> frameMs_;
    std::vector<double> reflectionMs_;
    std::uint64_t mapsUpdated_ = 0;
    std::uint64_t localMapBytes_ = 0, referenceMapBytes_ = 0, referenceMapGpuBytes_ = 0;  ///< the most
    double bytesPerTexel_ = 0;
};

}  // namespace app
