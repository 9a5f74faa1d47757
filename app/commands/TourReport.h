#pragma once

#include <glm/vec2.hpp>
#include <iosfwd>
#include <string>
#include <vector>

#include "app/commands/Drive.h"
#include "app/commands/Options.h"

namespace app {

/// Gathers what the frames of a drive took, for the table at its end and for `--json`: a row for each way of
/// drawing that was used, as a window's user may change it in between.
class TourReport {
  public:
    TourReport(const Options& options, std::string renderer);

    /// A frame, drawn in this way and size (pixels).
    void add(const FrameStats& stats, const DriveSettings& settings, glm::ivec2 size);
    std::size_t frames() const { return frames_; }

    /// Prints the table and writes the JSON file if one was asked for.
    void finish(bool partial, std::ostream& out) const;

  private:
    /// Frames drawn in the same way, though others may have come between.
    struct Stretch {
        DriveSettings settings;
        glm::ivec2 size{0};
        std::vector<double> frameMs;
        std::vector<double> reflectionMs;
        std::uint64_t mapsUpdated = 0;
        std::uint64_t localMapBytes = 0, referenceMapBytes = 0, referenceMapGpuBytes = 0;  ///< the most
        double bytesPerTexel = 0;
        std::uint64_t chromeJobs = 0, chromeDrawn = 0, chromeMeshes = 0,
                      chromeSearched = 0, chromeTextureBytes = 0, chromeReflectorBytes = 0;
        ChromeBounceCounts bounces;  ///< of all frames
        std::vector<double> chromeMs, bounceMs;
        std::vector<double> positions, predictedMs, errors;  ///< of governed frames
        double last = 0;
        std::vector<std::string> givenUp;  ///< a frame each
    };

    Options options_;
    std::string renderer_;
    std::vector<Stretch> stretches_;  ///< in the order in which they began
    std::size_t frames_ = 0;
};

}  // namespace app
