#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "app/frame/ChromeBounces.h"
#include "app/render/ChromeObjects.h"
#include "app/render/CityChrome.h"
#include "reflection/gl/ChromeLayer.h"
#include "reflection/gl/Program.h"
#include "reflection/gl/Texture.h"

namespace app {

namespace gl = reflection::gl;

enum class Drawing : std::uint8_t { solid, cutout, plain, map, parallax, count };

/// For CityChrome.cpp (parts and what is close to them) and CityChromeBounces.cpp (parts seen in parts).
struct CityChrome::Impl {
    struct Programs;
    struct Picture;
    struct Body;
    /// From where, and in which light.
    struct Seen {
        glm::dvec3 eye{0};
        glm::mat4 clip{0};
        glm::ivec2 size{0};
        Lighting lighting = {};
        bool operator==(const Seen&) const = default;
    };
    /// What is drawn of a piece, and how: where none of it differs from the frame before, its pixels stay.
    struct Layer {
        std::array<std::uint32_t, 4> name{};  ///< vehicle, part, wheel, piece
        glm::dmat4 worldFromPart{1};
        float share = 0;
        Drawing far = Drawing::plain;   ///< how the part's own map is taken up
        reflection::LocalMapSlot slot;  ///< that map
        reflection::PixelRect pixels;
        struct Thing {
            const ChromeObject* object = nullptr;
            glm::dmat4 worldFromMesh{1};
            Drawing drawing = Drawing::solid;
            glm::vec4 paint{0};
            reflection::LocalMapSlot slot;
            bool bounced = false;  ///< some of its chrome has a picture of its own
            bool operator==(const Thing& b) const {
                return object == b.object && worldFromMesh == b.worldFromMesh && drawing == b.drawing &&
                       paint == b.paint && slot.sizeClass == b.slot.sizeClass && slot.layer == b.slot.layer &&
                       bounced == b.bounced;
            }
        };
        std::vector<Thing> things;
        std::vector<const Picture*> pictures;  ///< of chrome seen in it
        bool operator==(const Layer& b) const {
            return name == b.name && worldFromPart == b.worldFromPart && share == b.share && far == b.far &&
                   slot.sizeClass == b.slot.sizeClass && slot.layer == b.slot.layer && pixels == b.pixels &&
                   things == b.things && pictures == b.pictures;
        }
    };
    struct PieceMesh {
        gl::Buffer vertices, indices;
        gl::VertexArray array;
        GLsizei count = 0;
        city::Aabb box;
    };

    Impl(const CloseScene& closeScene, std::shared_ptr<Programs> shared);
    ~Impl();

    static glm::mat4 clipFromPart(const ChromeJob& job, const PassView& pass) {
        glm::dmat4 relativeFromPart = job.worldFromPart;
        relativeFromPart[3] -= glm::dvec4(pass.eye, 0);
        return pass.clipFromRelative * glm::mat4(relativeFromPart);
    }
    void makeGlObjects();
    void allocate(glm::ivec2 size);
    const PieceMesh& pieceMesh(const reflection::ReflectorPiece& piece);
    Layer layerOf(const ChromeShown& shown, std::uint32_t piece, const PassView& pass,
                  const Surroundings& around);
    /// Which of these must be drawn anew. Clears their pixels, and those of what is there no more.
    std::vector<bool> outdated(std::span<const ChromeShown> shown, std::span<const Layer> layers,
                               const Seen& seenAs, const Surroundings& around);
    /// What the chrome seen in these parts mirrors, each from its own eye (CityChromeBounces.cpp); leaves
    /// pointers to it in the layers.
    void drawPictures(const ChromePlan& plan, std::uint32_t view, const PassView& pass,
                      std::span<const ChromeShown> shown, std::span<Layer> layers,
                      const CityMaterials& materials, const Surroundings& around,
                      const ChromeDrawing& options, ChromeCounts& counts);
    /// Where that chrome is seen in a part, with the pictures' light: into `bodies`.
    void drawBodies(const Layer& l, const glm::mat4& clipFromVirtual);
    /// The piece's own pixels: what the layer holds, and what is far away.
    void drawPiece(const Layer& l, const PieceMesh& mesh, const PassView& pass, const Surroundings& around);
    /// Binds a vehicle's map for shaders that look it up.
    void bindMap(const gl::Program& program, Drawing drawing, const reflection::LocalMapSlot& slot,
                 const glm::dvec3& eye, const Surroundings& around);
    void drawThing(const Layer::Thing& thing, const glm::mat4& clipFromVirtual,
                   const glm::mat3& worldFromPart, const glm::vec4& closeAround, const glm::dvec3& eye,
                   const Surroundings& around);

    ChromeObjects objects;
    /// Set: what the coming draw shows is in `objects` already, searched for with others.
    std::optional<ChromeCounts> searchedAhead;
    std::vector<Layer> before;
    Seen seenBefore;
    std::optional<std::vector<reflection::LocalMapSlot>> skipped;  ///< maps that changed meanwhile
    std::map<const reflection::ReflectorPiece*, PieceMesh> pieces;

    const CloseScene& scene;
    std::shared_ptr<Programs> programs;
    std::unique_ptr<ChromeBouncePlanner> planner;  ///< while there is more than one bounce
    ChromeBounceFades fades;
    std::map<BounceName, std::unique_ptr<Picture>> pictures;
    std::map<BounceName, std::unique_ptr<Body>> seenBodies;  ///< of all slices: named as the first
    std::uint64_t frame = 0;
    std::optional<gl::ChromeLayer> bodies;
    bool alone = true;  ///< its image is taken up by place, not looked up: what is outside may be anything
    std::optional<gl::ChromeLayer> layer;
    gl::Sampler mapSampler;
    gl::Texture light, depth;
    gl::Framebuffer target;
    glm::ivec2 size{0}, drawnSize{0};
};

/// Shared by all pictures of a view.
struct CityChrome::Impl::Programs {
    std::array<gl::Program, static_cast<std::size_t>(Drawing::count)> things;
    gl::Program mask;                                                         ///< a piece opens its layer
    std::array<gl::Program, static_cast<std::size_t>(Drawing::count)> parts;  ///< and takes it up: plain on
    gl::Program body;                                                         ///< made with the first picture
};

/// Where a piece of chrome is seen in another: one for all its slices.
struct CityChrome::Impl::Body {
    explicit Body(const reflection::ReflectorPiece& of) : piece(of) {}

    /// Takes what of it may be seen in a ball around `centre`, in its own frame. Nothing while that is what
    /// it has.
    void face(const glm::dvec3& centre, double radius, double share);
    /// Finds it where anything moved since; otherwise all stays.
    void find(const reflection::ReflectorMap& in, const glm::dvec3& eye, const glm::dmat4& inFromPart,
              const reflection::VirtualMeshOptions& options, bool keep);

    const reflection::ReflectorPiece& piece;
    std::vector<city::Vertex> vertices;  ///< its own, those that face the other
    std::optional<reflection::VirtualMesh> mesh;
    std::vector<glm::dvec3> from;  ///< where each vertex is seen in the other, in its own part's frame
    std::size_t searched = 0;
    std::uint64_t used = 0;
    bool moved = true;  ///< since the call before

    glm::dvec3 facedCentre{0};
    double facedSlack = -1;
    glm::dmat4 lastPlace{0};
    glm::dvec3 lastEye{0};
    double lastTolerance = -1;
};

/// What a piece of chrome seen in another mirrors.
struct CityChrome::Impl::Picture {
    static constexpr std::uint64_t framesKept = 30;
    /// Pixels by which a picture may be off because its eye has moved on.
    static constexpr double mostOff = 1;

    Picture(const CloseScene& scene, const std::shared_ptr<Programs>& shared);

    /// Pixels by which it would be off as this bounce's; infinite where it cannot serve.
    double offAs(const ChromeBounce& now, const Surroundings& around, const ChromeDrawing& options,
                 std::uint64_t frame) const;
    /// Where each vertex of its body finds its light in the picture.
    void look(const reflection::SearchOptions& search);

    std::unique_ptr<CityChrome> chrome;
    Body* body = nullptr;
    gl::ChromeMesh drawn;
    ChromeBounce bounce;  ///< as it was drawn for
    ChromeBounce next;    ///< as it is wanted
    float share = 0;
    ChromePlan plan;                             ///< the bounce's job alone
    std::vector<vehicles::VehiclePose> closeBy;  ///< when it was drawn
    Lighting lighting;
    ChromeDrawing options;  ///< with which it was drawn
    std::uint64_t used = 0, drawnIn = 0;
    bool changed = true;  ///< since the frame before

    glm::dvec3 eye{0};          ///< in the part's frame
    std::vector<float> values;  ///< of the body's vertices
    std::size_t searched = 0;
};

}  // namespace app
