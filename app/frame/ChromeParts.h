#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "reflection/chrome/ReflectorPieces.h"
#include "vehicles/models/VehicleModel.h"

namespace app {

/// A connected piece of chrome of a vehicle, or of what stands in the city.
struct ChromePart {
    std::uint32_t shape = 0;  ///< of ChromeParts: those that are the same but for their place share one
    glm::vec3 centre{0};      ///< of its bounding box: in the vehicle's frame, or the wheel's
    glm::vec3 half{0};        ///< half the sides of that box
    float radius = 0;         ///< of the ball around `centre` that holds it
    /// Of a sphere of as much surface per radius: strips are narrow, however long, metres.
    float width = 0;
    bool closed = false;   ///< a whole body: every edge has two triangles
    bool convex = false;   ///< and it bulges everywhere: each thing shows in it once
    bool onWheel = false;  ///< it is there on every wheel, and turns with it
};

/// The chrome of vehicle models: what of them may show close things by searched reflection points. Made once,
/// of the finest levels, whatever is drawn. Parts that are the same but for their place (handles, the lips of
/// wheels' covers) share one reflector.
class ChromeParts {
  public:
    ChromeParts();
    /// Keeps nothing of the models. Parts of no size, or with corners that are not finite, are left out.
    /// Cost: some milliseconds a model.
    explicit ChromeParts(std::span<const vehicles::VehicleModel> models);
    ~ChromeParts();
    ChromeParts(ChromeParts&&) noexcept;
    ChromeParts& operator=(ChromeParts&&) noexcept;

    /// Gives a model's widest part a closed body of which it is a piece, smooth past the part's rim, in the
    /// model's frame: searches walk on that, and the part's own pixels show what they find (Estalella et al.
    /// 2005, section 6.2). Before reflectorOf is asked for the part.
    void giveCompanion(std::size_t model, city::Mesh companion);

    /// Of a model, the widest first; nothing for one that is not known.
    std::span<const ChromePart> of(std::size_t model) const {
        return model < models_.size() ? std::span<const ChromePart>(models_[model])
                                      : std::span<const ChromePart>();
    }
    bool empty() const { return shapes_.empty(); }
    std::size_t shapes() const { return shapes_.size(); }

    /// From now on reflectors are kept in this folder on disk, by content. `tell` hears, from any thread, of
    /// files that are of no use and of folders that cannot be written. Before the first reflector is made.
    void keepIn(const std::filesystem::path& folder, std::function<void(const std::string&)> tell);

    /// Ready for searches, in a frame with the axes of body or wheel and its origin in the part's `centre`.
    /// Made when it is first asked for (0.1 to 0.35 s; a scene without chrome near the viewer makes none), by
    /// any thread, and kept. Waits for it.
    const reflection::Reflector& reflectorOf(const ChromePart& part) const;
    /// Whether it is there. If not, it is being made in the background from now on. From one thread at a
    /// time.
    bool ready(const ChromePart& part) const;
    /// A part's own triangles, in the same frame.
    const city::Mesh& meshOf(const ChromePart& part) const;
    std::size_t reflectorsMade() const;
    std::size_t bytes() const;  ///< of the maps made

  private:
    struct Shape;
    struct Keeper;
    class Maker;
    std::vector<std::vector<ChromePart>> models_;
    std::vector<std::unique_ptr<Shape>> shapes_;
    std::unique_ptr<Keeper> keeper_;
    mutable std::unique_ptr<Maker> maker_;  ///< ends before what it works on
};

/// The connected components of a mesh's chrome, corners joined by position but across creases: what
/// ChromeParts makes reflectors of.
std::vector<city::Mesh> chromeComponents(const city::Mesh& mesh);

}  // namespace app
