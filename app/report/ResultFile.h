#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "app/report/Timing.h"

namespace app {

/// {"min":, "median":, "max":, "n":}, milliseconds; null when nothing was measured.
nlohmann::ordered_json toJson(const Timing& timing);

/// Name of the processor as the system tells it, or "unknown".
std::string processorName();

/// The results of one measurement: {"bench", "version", "renderer", "cpu", "threads", "rows": [...]}. Numbers
/// that are not finite become null, which is what JSON has for them.
class ResultFile {
  public:
    /// `renderer`: GL_RENDERER, empty where no OpenGL was used.
    ResultFile(std::string bench, std::string version, std::string renderer);

    /// A row names what it measured; see design for the usual names.
    void add(nlohmann::ordered_json row);
    /// The document as it stands; `partial` marks it as cut short.
    nlohmann::ordered_json document(bool partial) const;
    /// Writes it aside, then renames. Throws std::runtime_error naming the file and the cause.
    void write(const std::filesystem::path& file, bool partial) const;

  private:
    nlohmann::ordered_json head_;
    nlohmann::ordered_json rows_ = nlohmann::ordered_json::array();
};

}  // namespace app
