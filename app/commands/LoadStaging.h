#pragma once

#include <filesystem>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "app/commands/LoadScene.h"

namespace app {

/// Puts the vehicles of a staging file (data/staged/README.md) into the scene: models that the traffic does
/// not have are added to its kinds without a share, so that nobody else drives them; heights are those of the
/// nearest lane. Where the file has views, they take the place of the city's tour. Call before standing
/// reflectors get their models. Throws std::runtime_error, one sentence: file, place, cause, remedy.
void loadStaging(const std::filesystem::path& file, Scene& scene);

/// The same from its text; `name` is told in errors.
void readStaging(const std::string& text, const std::string& name, Scene& scene);

}  // namespace app
