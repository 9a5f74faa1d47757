#include "app/render/CityChrome.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "app/frame/StandingReflectors.h"
#include "app/frame/VehicleShading.h"
#include "app/render/CloseMeshes.h"
#include "app/render/NodeView.h"
#include "reflection/gl/ChromeLayer.h"
#include "reflection/gl/Program.h"
#include "reflection/gl/Texture.h"

namespace app {

namespace gl = reflection::gl;

namespace {

double milliseconds(std::chrono::steady_clock::time_point since) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - since).count();
}

/// Frames for which the meshes of a job are kept that is not there any more.
constexpr std::uint64_t framesKept = 30;
/// A patch of the city is gathered anew when its part has moved by this share of its reach.
constexpr double patchLasts = 0.2;
/// Placed things may be off by this share of their distance from the part.
constexpr double placedDetail = 0.01;

/// Each more doubles the searches, all of them at the outline, where images crowd.
constexpr int mostHalvings = 6;

enum class Drawing : std::uint8_t { solid, cutout, plain, map, parallax, count };

}  // namespace

struct CityChrome::Impl {
    /// A thing near a part, as one piece of the part shows it.
    struct Object {
        const CloseMesh* source = nullptr;
        std::unique_ptr<reflection::VirtualMesh> mesh;
        std::unique_ptr<gl::ChromeMesh> drawn;
        glm::dmat4 worldFromMesh{1};
        Drawing drawing = Drawing::solid;
        std::uint32_t vehicle = 0;
        std::uint64_t used = 0;
        glm::dmat4 lastMesh{0};
        glm::dvec3 lastEye{0};
        double lastTolerance = -1;
        bool changed = true;
        reflection::VirtualCounts counts;
    };
    /// What is kept of a job from frame to frame.
    struct Kept {
        std::uint64_t used = 0;
        std::vector<CloseMesh> city;  ///< around `place`
        glm::dvec3 place{0};
        double reach = 0;
        std::map<std::tuple<std::size_t, std::uint64_t, std::uint32_t>, Object>
            objects;  ///< piece, thing, mesh
    };
    struct Task {
        Object* object;
        const reflection::ReflectorMap* map;
        glm::dvec3 eye;
        glm::dmat4 partFromMesh;
        reflection::VirtualMeshOptions options;
    };
    struct PieceMesh {
        gl::Buffer vertices, indices;
        gl::VertexArray array;
        GLsizei count = 0;
    };

    explicit Impl(const CloseScene& closeScene) : scene(closeScene), vehicles(closeScene.models) {}

    void makeGlObjects();
    void allocate(glm::ivec2 size);
    const PieceMesh& pieceMesh(const reflection::ReflectorPiece& piece);
    Object& object(Kept& kept, std::size_t piece, std::uint64_t thing, std::uint32_t index,
                   const CloseMesh& source, double share);
    void gatherCity(const ChromeJob& job, Kept& kept);
    void drawObject(Object& object, const glm::mat4& clipFromVirtual, const glm::mat3& worldFromPart,
                    const glm::vec4& closeAround, const glm::dvec3& eye, const Surroundings& around);

    const CloseScene& scene;
    CloseVehicles vehicles;
    std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t>, Kept> kept;
    std::map<const reflection::ReflectorPiece*, PieceMesh> pieces;
    std::uint64_t frame = 0;

    std::array<gl::Program, static_cast<std::size_t>(Drawing::count)> programs;
    gl::Program part;
    std::optional<gl::ChromeLayer> layer;
    gl::Sampler mapSampler;
    gl::Texture light, depth;
    gl::Framebuffer target;
    glm::ivec2 size{0};
};

CityChrome::CityChrome(const CloseScene& scene) : impl_(std::make_unique<Impl>(scene)) {}
CityChrome::~CityChrome() = default;

std::uint32_t CityChrome::light() const {
    return impl_->light.name();
}
std::uint32_t CityChrome::depth() const {
    return impl_->depth.name();
}
std::size_t CityChrome::bytes() const {
    return (impl_->layer ? impl_->layer->bytes() : 0) +
           static_cast<std::size_t>(impl_->size.x) * static_cast<std::size_t>(impl_->size.y) * 12;
}

void CityChrome::Impl::makeGlObjects() {
    if (layer) return;
    layer.emplace();
    mapSampler = gl::Sampler::create(GL_LINEAR_MIPMAP_NEAREST, GL_LINEAR, GL_CLAMP_TO_EDGE);
    part = gl::Program::fromFiles({"chrome_part.vert", "chrome_part.frag"});
    const auto make = [&](Drawing drawing, std::vector<std::string> defines) {
        defines.emplace_back("VIRTUAL");
        const bool city = drawing == Drawing::solid || drawing == Drawing::cutout;
        programs[static_cast<std::size_t>(drawing)] =
            city ? gl::Program::fromFiles({"city.vert", "city.frag"}, defines)
                 : gl::Program::fromFiles({"vehicle.vert", "vehicle.frag"}, defines);
    };
    make(Drawing::solid, {});
    make(Drawing::cutout, {"CUTOUT"});
    make(Drawing::plain, {});
    make(Drawing::map, {"REFLECTIVE"});
    make(Drawing::parallax, {"REFLECTIVE", "PARALLAX"});
}

void CityChrome::Impl::allocate(glm::ivec2 wanted) {
    if (size.x >= wanted.x && size.y >= wanted.y) return;
    size = glm::max(size, wanted);
    light = gl::Texture::image2D(GL_RGBA16F, size.x, size.y);
    light.filter(GL_NEAREST, GL_NEAREST).wrap(GL_CLAMP_TO_EDGE);
    depth = gl::Texture::image2D(GL_DEPTH_COMPONENT32F, size.x, size.y);
    depth.filter(GL_NEAREST, GL_NEAREST).wrap(GL_CLAMP_TO_EDGE);
    target = gl::Framebuffer::create();
    target.attach(GL_COLOR_ATTACHMENT0, light.name()).attach(GL_DEPTH_ATTACHMENT, depth.name());
    target.requireComplete("what chrome shows of close things");
}

const CityChrome::Impl::PieceMesh& CityChrome::Impl::pieceMesh(const reflection::ReflectorPiece& piece) {
    PieceMesh& mesh = pieces[&piece];
    if (mesh.count > 0) return mesh;
    mesh.vertices = gl::Buffer::filled(std::span<const city::Vertex>(piece.mesh.vertices));
    mesh.indices = gl::Buffer::filled(std::span<const std::uint32_t>(piece.mesh.indices));
    mesh.array = gl::VertexArray::create();
    mesh.array.buffer(0, mesh.vertices.name(), sizeof(city::Vertex))
        .attribute(0, 0, 3, GL_FLOAT, false, offsetof(city::Vertex, position))
        .indices(mesh.indices.name());
    mesh.count = static_cast<GLsizei>(piece.mesh.indices.size());
    return mesh;
}

CityChrome::Impl::Object& CityChrome::Impl::object(Kept& job, std::size_t piece, std::uint64_t thing,
                                                   std::uint32_t index, const CloseMesh& source,
                                                   double share) {
    Object& o = job.objects[{piece, thing, index}];
    o.used = frame;
    if (o.source != &source) {
        o.source = &source;
        reflection::VirtualMeshOptions virtualOptions;
        virtualOptions.vertices.share = source.exact ? 1 : share;
        virtualOptions.vertices.search.thorough = false;
        o.mesh = std::make_unique<reflection::VirtualMesh>(source.positions, source.indices, virtualOptions);
        o.drawn = std::make_unique<gl::ChromeMesh>(source.attributes);
        o.lastTolerance = -1;
    }
    return o;
}

void CityChrome::Impl::gatherCity(const ChromeJob& job, Kept& k) {
    const glm::dvec3 place(job.worldFromPart[3]);
    if (k.reach > 0 && job.reach <= k.reach * 1.001 && glm::length(place - k.place) <= patchLasts * job.reach)
        return;
    k.objects.clear();  // they point into what goes
    // What is gathered serves until the part has moved on.
    k.place = place;
    k.reach = job.reach;
    k.city = closeMeshes(scene.standing.gather(place, (1 + patchLasts) * job.reach, placedDetail));
}

ChromeCounts CityChrome::draw(const ChromePlan& plan, std::uint32_t view, const PassView& pass,
                              glm::ivec2 size, const CityMaterials& materials, const Surroundings& around,
                              const ChromeDrawing& options) {
    Impl& my = *impl_;
    const auto start = std::chrono::steady_clock::now();
    my.makeGlObjects();
    my.allocate(size);
    ++my.frame;
    ChromeCounts counts;

    const auto drawingOf = [&](std::uint32_t vehicle) {
        if (around.textures == nullptr || vehicle >= around.slots.size() || !around.slots[vehicle].valid())
            return Drawing::plain;
        const auto sizeClass = static_cast<std::size_t>(around.slots[vehicle].sizeClass);
        return around.textures->nearnessArrays[sizeClass] != 0 ? Drawing::parallax
               : around.textures->cubeArrays[sizeClass] != 0   ? Drawing::map
                                                               : Drawing::plain;
    };
    struct Drawn {
        const ChromeJob* job;
        const reflection::ReflectorPiece* piece;
        std::size_t first, last;  ///< of the tasks
    };
    std::vector<Drawn> drawn;
    std::vector<Impl::Task> tasks;
    for (const ChromeJob& job : plan.jobs) {
        if (job.view != view) continue;
        ++counts.jobs;
        const vehicles::VehiclePose& own = around.poses[job.vehicle];
        Impl::Kept& kept = my.kept[{view, own.id, job.part, job.wheel}];
        kept.used = my.frame;
        my.gatherCity(job, kept);
        const glm::dmat4 partFromWorld = glm::inverse(job.worldFromPart);
        const glm::dvec3 eye(partFromWorld * glm::dvec4(pass.eye, 1));
        reflection::VirtualMeshOptions virtualOptions;
        // Flat parts with sharp edges move images faster than grids follow, and edges would be halved in vain
        // until they did.
        const double share = stands(own) ? options.share : 1;
        virtualOptions.vertices.share = share;
        virtualOptions.vertices.search.thorough = false;
        // The ground is cut off at the patch alone: its edges are as long as the patch.
        virtualOptions.mostHalvings = mostHalvings;
        virtualOptions.tolerance = options.tolerance / static_cast<double>(pass.pixelsPerRadian);
        virtualOptions.vertices.cellTolerance = virtualOptions.tolerance;
        const double distance = glm::length(eye);
        if (distance > 1.1 * job.radius) {
            const double sine = job.radius / distance;
            virtualOptions.towards = -eye / distance;
            virtualOptions.coneCosine = std::sqrt(1 - sine * sine);
        }
        const ChromePart& part = my.scene.parts.of(own.model)[job.part];
        const reflection::Reflector& reflector = my.scene.parts.reflectorOf(part);
        for (std::size_t p = 0; p < reflector.pieces.size(); ++p) {
            const reflection::ReflectorPiece& piece = reflector.pieces[p];
            if (piece.built.map.empty()) continue;
            const std::size_t first = tasks.size();
            const auto add = [&](Impl::Object& o, const glm::dmat4& worldFromMesh, Drawing drawing,
                                 std::uint32_t vehicle) {
                o.worldFromMesh = worldFromMesh;
                o.drawing = drawing;
                o.vehicle = vehicle;
                tasks.push_back({&o, &piece.built.map, eye, partFromWorld * worldFromMesh, virtualOptions});
            };
            glm::dmat4 worldFromPatch(1);
            worldFromPatch[3] = glm::dvec4(kept.place, 1);
            for (std::uint32_t i = 0; i < kept.city.size(); ++i)
                add(my.object(kept, p, 0, i, kept.city[i], 1), worldFromPatch,
                    kept.city[i].cutout ? Drawing::cutout : Drawing::solid, 0);
            for (const std::uint32_t index : job.close) {
                const vehicles::VehiclePose& pose = around.poses[index];
                // A thing at distance d is seen in a ball of radius r reduced as r / 2 to d; in parts of
                // vehicles, which are flat here and round there, as large as in a plane mirror.
                const double away = std::max(
                    glm::length(pose.position - glm::dvec3(job.worldFromPart[3])) - job.radius, job.radius);
                const double allowed = options.detail / static_cast<double>(pass.pixelsPerRadian) *
                                       (stands(own) ? distance * (1 + 2 * away / job.radius) : distance);
                std::uint32_t number = 0;
                for (const CloseVehicles::Placed& placed : my.vehicles.of(pose, static_cast<float>(allowed)))
                    add(my.object(kept, p, 1 + std::uint64_t{pose.id}, number++, *placed.mesh, share),
                        placed.worldFromMesh, drawingOf(index), index);
            }
            drawn.push_back({&job, &piece, first, tasks.size()});
        }
    }
    const auto searching = std::chrono::steady_clock::now();
    tbb::parallel_for(std::size_t{0}, tasks.size(), [&](std::size_t i) {
        Impl::Task& task = tasks[i];
        Impl::Object& o = *task.object;
        // Nothing moved: what was found last is there still.
        o.changed = !(o.lastEye == task.eye && o.lastMesh == task.partFromMesh &&
                      o.lastTolerance == task.options.tolerance);
        if (!o.changed) return;
        o.counts = o.mesh->update(*task.map, task.eye, task.partFromMesh, task.options);
        o.lastEye = task.eye;
        o.lastMesh = task.partFromMesh;
        o.lastTolerance = task.options.tolerance;
    });
    counts.searchMilliseconds = milliseconds(searching);

    setDrawState();
    materials.bind();
    glDisable(GL_CULL_FACE);
    // Where vehicles that have jobs will look.
    glBindFramebuffer(GL_FRAMEBUFFER, my.target.name());
    glEnable(GL_SCISSOR_TEST);
    constexpr std::array<float, 4> nothing{};
    constexpr float far = 0;
    for (const ChromeJob& job : plan.jobs) {
        if (job.view != view) continue;
        const vehicles::VehiclePose& pose = around.poses[job.vehicle];
        const city::Aabb box = my.vehicles.boundsOf(pose);
        const glm::vec3 centre(glm::dvec3(box.centre()) - pass.eye);
        const reflection::PixelRect pixels =
            pixelsOfBall(pass.clipFromRelative, size, centre, 0.5f * glm::length(box.size()));
        glScissor(pixels.low.x, pixels.low.y, pixels.size().x, pixels.size().y);
        glClearNamedFramebufferfv(my.target.name(), GL_COLOR, 0, nothing.data());
        glClearNamedFramebufferfv(my.target.name(), GL_DEPTH, 0, &far);
    }
    for (const Drawn& d : drawn) {
        const glm::dvec3 origin(d.job->worldFromPart[3]);
        const glm::vec3 middle(origin - pass.eye);
        const reflection::PixelRect pixels =
            pixelsOfBall(pass.clipFromRelative, size, middle, static_cast<float>(d.job->radius));
        if (pixels.empty()) continue;
        my.layer->begin(size, pixels);
        glDisable(GL_CULL_FACE);
        const glm::dmat3 turn(d.job->worldFromPart);
        const glm::mat4 clipFromVirtual = pass.clipFromRelative * glm::mat4(glm::dmat4(turn));
        for (std::size_t i = d.first; i < d.last; ++i) {
            my.drawObject(*tasks[i].object, clipFromVirtual, glm::mat3(turn),
                          glm::vec4(middle, static_cast<float>(d.job->reach)), pass.eye, around);
            ++counts.meshes;
            counts.vertices += tasks[i].object->mesh->vertices().size();
            counts.searched += tasks[i].object->changed ? tasks[i].object->counts.searched : 0;
            counts.triangles += tasks[i].object->mesh->indices().size() / 3;
        }
        glBindFramebuffer(GL_FRAMEBUFFER, my.target.name());
        glEnable(GL_CULL_FACE);
        glm::mat4 relativeFromPart{glm::dmat4(turn)};
        relativeFromPart[3] = glm::vec4(middle, 1);
        my.part.set("clipFromPart", pass.clipFromRelative * relativeFromPart);
        my.part.set("share", d.job->share);
        my.part.use();
        glBindTextureUnit(5, my.layer->colour());
        const Impl::PieceMesh& mesh = my.pieceMesh(*d.piece);
        mesh.array.bind();
        glDrawElements(GL_TRIANGLES, mesh.count, GL_UNSIGNED_INT, nullptr);
    }
    for (auto& [key, kept] : my.kept)
        std::erase_if(kept.objects, [&](const auto& o) { return my.frame > o.second.used + framesKept; });
    std::erase_if(my.kept, [&](const auto& k) { return my.frame > k.second.used + framesKept; });
    setDrawState();
    counts.milliseconds = milliseconds(start);
    return counts;
}

void CityChrome::Impl::drawObject(Object& o, const glm::mat4& clipFromVirtual, const glm::mat3& worldFromPart,
                                  const glm::vec4& closeAround, const glm::dvec3& eye,
                                  const Surroundings& around) {
    if (o.changed) o.drawn->upload(*o.mesh, o.source->values);
    const gl::Program& program = programs[static_cast<std::size_t>(o.drawing)];
    glm::dmat4 relativeFromMesh = o.worldFromMesh;
    relativeFromMesh[3] -= glm::dvec4(eye, 0);
    program.set("clipFromVirtual", clipFromVirtual);
    program.set("relativeFromMesh", glm::mat4(relativeFromMesh));
    program.set("closeAround", closeAround);
    program.use();
    if (o.drawing != Drawing::solid && o.drawing != Drawing::cutout) {
        const vehicles::VehiclePose& pose = around.poses[o.vehicle];
        program.set("worldFromReflector", worldFromPart);
        program.set("paint", glm::vec4(pose.paint, pose.braking ? 1.f : 0.f));
        if (o.drawing != Drawing::plain) {
            const reflection::LocalMapSlot slot = around.slots[o.vehicle];
            const auto sizeClass = static_cast<std::size_t>(slot.sizeClass);
            glm::vec4 map(0, 0, 0, slot.layer);
            if (o.drawing == Drawing::parallax) {
                map = glm::vec4(
                    glm::vec3(around.textures->centres[sizeClass][static_cast<std::size_t>(slot.layer)] -
                              eye),
                    map.w);
                glBindTextureUnit(4, around.textures->nearnessArrays[sizeClass]);
            }
            program.set("map", map);
            mapSampler.bind(2);
            glBindTextureUnit(2, around.textures->cubeArrays[sizeClass]);
        }
    }
    o.drawn->draw();
    glBindSampler(2, 0);
}

}  // namespace app
