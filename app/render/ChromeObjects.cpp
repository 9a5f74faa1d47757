#include "app/render/ChromeObjects.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <utility>

#include "app/frame/StandingReflectors.h"
#include "app/frame/VehicleShading.h"

namespace app {

namespace {

/// Frames for which the meshes of a job are kept that is not there any more.
constexpr std::uint64_t framesKept = 30;
/// A patch of the city is gathered anew when its part has moved by this share of its reach, or when it is
/// seen from a distance that differs by this factor: its things' levels were chosen for another.
constexpr double patchLasts = 0.2, detailLasts = 1.5;
/// Each more doubles the searches, all of them at the outline, where images crowd.
constexpr int mostHalvings = 6;
/// Pixels across below which an image is left out.
constexpr double leastImage = 0.7;
/// Share over the local map's image below which errors may not grow any more: they are seen by it.
constexpr double faintest = 0.2;
/// A part shows its own body along its edges, at a glance, where images are crowded: its levels may be off by
/// so many times as much as others', and its edges by so many times.
constexpr double ownCoarse = 8, ownBent = 2;
/// Of a job's reach: things that begin beyond it are covered by the map to less than one part in fifty.
constexpr double reachShown = 0.93;

glm::dmat4 placedAt(const glm::dvec3& origin) {
    glm::dmat4 m(1);
    m[3] = glm::dvec4(origin, 1);
    return m;
}

/// Metres from a frame's origin to a box somewhere in it.
double awayFrom(const glm::dvec3& place, const city::Aabb& box) {
    return glm::length(
        glm::max(glm::max(glm::dvec3(box.min) - place, place - glm::dvec3(box.max)), glm::dvec3(0)));
}

}  // namespace

ChromeObject& ChromeObjects::object(Kept& job, std::size_t piece, std::uint64_t thing, std::uint32_t index,
                                    const CloseMesh& source, const reflection::VirtualMeshOptions& options) {
    ChromeObject& o = job.objects[{piece, thing, index}];
    o.used = frame_;
    const bool whole = options.vertices.share >= 1;
    if (o.source != &source || o.whole != whole) {
        o.source = &source;
        o.whole = whole;
        o.mesh = std::make_unique<reflection::VirtualMesh>(source.positions, source.indices, options);
        o.drawn.reset();
        o.lastTolerance = -1;
    }
    return o;
}

void ChromeObjects::gatherCity(const ChromeJob& job, const reflection::ReflectorMap& map,
                               const glm::dvec3& eye, double radiansOff, Kept& k) {
    const glm::dvec3 place(job.worldFromPart[3]);
    const double metresPerPixel = radiansOff * glm::length(eye);
    if (k.reach > 0 && job.reach <= k.reach * 1.001 &&
        glm::length(place - k.place) <= patchLasts * job.reach &&
        metresPerPixel < detailLasts * k.metresPerPixel && k.metresPerPixel < detailLasts * metresPerPixel)
        return;
    k.objects.clear();  // they point into what goes
    k.looks.clear();
    // What is gathered serves until the part has moved on.
    k.place = place;
    k.reach = job.reach;
    k.metresPerPixel = metresPerPixel;
    const glm::dmat4 partFromPatch = glm::inverse(job.worldFromPart) * placedAt(place);
    k.city = closeMeshes(
        scene_.standing.gather(place, (reachShown + patchLasts) * job.reach, [&](const city::Aabb& box) {
            const CloseBox asked{box, partFromPatch};
            return closeImages(map, job.radius, eye, {&asked, 1}).front().metresPerRadian * radiansOff;
        }));
}

std::span<const ChromeShown> ChromeObjects::update(const ChromePlan& plan, std::uint32_t view,
                                                   const PassView& pass,
                                                   std::span<const vehicles::VehiclePose> poses,
                                                   const ChromeDrawing& options, ChromeCounts& counts) {
    gather(plan, view, pass, poses, options, counts);
    return search(options, counts);
}

void ChromeObjects::gather(const ChromePlan& plan, std::uint32_t view, const PassView& pass,
                           std::span<const vehicles::VehiclePose> poses, const ChromeDrawing& options,
                           ChromeCounts& counts) {
    ++frame_;
    shown_.clear();
    tasks_.clear();
    const auto pixelsPerRadian = static_cast<double>(pass.pixelsPerRadian);
    std::vector<CloseBox> boxes;
    for (const ChromeJob& job : plan.jobs) {
        if (job.view != view) continue;
        ++counts.jobs;
        const vehicles::VehiclePose& own = poses[job.vehicle];
        Kept& kept = kept_[{view, own.id, job.part, job.wheel}];
        kept.used = frame_;
        const glm::dmat4 partFromWorld = glm::inverse(job.worldFromPart);
        const glm::dvec3 eye(partFromWorld * glm::dvec4(pass.eye, 1));
        // What is hardly seen may be off by more, so that jobs that begin or end cost little.
        const double coarse = 1 / std::max(static_cast<double>(job.share), faintest);
        const double radiansOff = coarse * options.detail / pixelsPerRadian;
        reflection::VirtualMeshOptions virtualOptions;
        virtualOptions.vertices = reflection::withShare({}, options.share);
        virtualOptions.vertices.threads = true;
        virtualOptions.vertices.search.thorough = false;
        // The ground is cut off at the patch alone: its edges are as long as the patch.
        virtualOptions.mostHalvings = mostHalvings;
        virtualOptions.tolerance = coarse * options.tolerance / pixelsPerRadian;
        virtualOptions.vertices.cellTolerance = 0.5 * virtualOptions.tolerance;
        const double distance = glm::length(eye);
        if (distance > 1.1 * job.radius) {
            const double sine = job.radius / distance;
            virtualOptions.towards = -eye / distance;
            virtualOptions.coneCosine = std::sqrt(1 - sine * sine);
        }
        const ChromePart& part = scene_.parts.of(own.model)[job.part];
        const reflection::Reflector& reflector = scene_.parts.reflectorOf(part);
        if (reflector.pieces.empty()) continue;
        gatherCity(job, reflector.pieces.front().built.map, eye, radiansOff, kept);
        kept.looks.resize(reflector.pieces.size());
        const glm::dmat4 worldFromPatch = placedAt(kept.place);
        const glm::dvec3 inPatch = glm::dvec3(job.worldFromPart[3]) - kept.place;
        for (std::size_t p = 0; p < reflector.pieces.size(); ++p) {
            const reflection::ReflectorPiece& piece = reflector.pieces[p];
            if (piece.built.map.empty()) continue;
            ChromeShown& shown = shown_.emplace_back();
            shown.job = &job;
            shown.piece = &piece;
            Task& task = tasks_.emplace_back();
            task.map = &piece.built.map;
            task.eye = eye;
            const auto add = [&](std::uint64_t thing, std::uint32_t index, const CloseMesh& source,
                                 const glm::dmat4& worldFromMesh, std::uint32_t vehicle) {
                reflection::VirtualMeshOptions how = virtualOptions;
                // Without a bound there is nothing to gain by cells between what stands far apart.
                if (source.exact && !how.vertices.bounded) how.vertices.share = 1;
                ChromeObject& o = object(kept, p, thing, index, source, how);
                o.worldFromMesh = worldFromMesh;
                o.vehicle = vehicle;
                shown.objects.push_back(&o);
                task.objects.push_back(&o);
                task.meshes.push_back({o.mesh.get(), partFromWorld * worldFromMesh, how, {}});
            };
            boxes.clear();
            for (const CloseMesh& mesh : kept.city)
                boxes.push_back({mesh.box, partFromWorld * worldFromPatch});
            for (const std::uint32_t index : job.close) {
                const vehicles::VehiclePose& pose = poses[index];
                const glm::dmat3 turn(worldFromVehicle(pose));
                boxes.push_back(
                    {vehicles_.boxOf(pose),
                     partFromWorld * glm::dmat4(glm::dvec4(turn[0], 0), glm::dvec4(turn[1], 0),
                                                glm::dvec4(turn[2], 0), glm::dvec4(pose.position, 1))});
            }
            Look& look = kept.looks[p];
            if (!options.keep || look.eye != eye || look.boxes != boxes) {
                look.images = closeImages(piece.built.map, job.radius, eye, boxes);
                look.eye = eye;
                look.boxes = boxes;
                counts.searched += searchesOfBox * boxes.size();
            }
            const std::vector<CloseImage>& images = look.images;
            const auto leftOut = [&](const CloseImage& image) {
                return image.hidden || image.angle * pixelsPerRadian < coarse * leastImage;
            };
            for (std::uint32_t i = 0; i < kept.city.size(); ++i) {
                if (leftOut(images[i]) || awayFrom(inPatch, kept.city[i].box) > reachShown * job.reach) {
                    ++counts.leftOut;
                    continue;
                }
                add(0, i, kept.city[i], worldFromPatch, ChromeObject::noVehicle);
            }
            for (std::size_t k = 0; k < job.close.size(); ++k) {
                const CloseImage& image = images[kept.city.size() + k];
                if (leftOut(image)) {
                    ++counts.leftOut;
                    continue;
                }
                const vehicles::VehiclePose& pose = poses[job.close[k]];
                std::uint32_t number = 0;
                for (const CloseVehicles::Placed& placed :
                     vehicles_.of(pose, static_cast<float>(image.metresPerRadian * radiansOff)))
                    add(1 + std::uint64_t{pose.id}, number++, *placed.mesh, placed.worldFromMesh,
                        job.close[k]);
            }
            // A wheel's parts look away from their vehicle.
            if (job.wheel != ChromeJob::noWheel || stands(own)) continue;
            const double perRadian = std::max(distance - job.radius, job.radius);
            if (const CloseMesh* body =
                    vehicles_.besides(own.model, part, job.part, reflector,
                                      static_cast<float>(ownCoarse * perRadian * radiansOff))) {
                const glm::dmat3 turn(worldFromVehicle(own));
                virtualOptions.tolerance *= ownBent;
                virtualOptions.vertices.cellTolerance *= ownBent;
                add(1 + std::uint64_t{own.id}, 0, *body,
                    glm::dmat4(glm::dvec4(turn[0], 0), glm::dvec4(turn[1], 0), glm::dvec4(turn[2], 0),
                               glm::dvec4(own.position, 1)),
                    job.vehicle);
                virtualOptions.tolerance /= ownBent;
                virtualOptions.vertices.cellTolerance /= ownBent;
            }
        }
    }
    for (auto& [key, kept] : kept_)
        std::erase_if(kept.objects, [&](const auto& o) { return frame_ > o.second.used + framesKept; });
    std::erase_if(kept_, [&](const auto& k) { return frame_ > k.second.used + framesKept; });
}

std::span<const ChromeShown> ChromeObjects::search(const ChromeDrawing& options, ChromeCounts& counts) {
    const auto searching = std::chrono::steady_clock::now();
    tbb::parallel_for(std::size_t{0}, tasks_.size(), [&](std::size_t i) {
        Task& task = tasks_[i];
        std::vector<reflection::VirtualMesh::Placed> moved;
        std::vector<ChromeObject*> of;
        for (std::size_t k = 0; k < task.objects.size(); ++k) {
            ChromeObject& o = *task.objects[k];
            const reflection::VirtualMesh::Placed& mesh = task.meshes[k];
            // Nothing moved: what was found last is there still.
            o.changed =
                !options.keep || !(o.lastEye == task.eye && o.lastMesh == mesh.reflectorFromMesh &&
                                   o.lastTolerance == mesh.options.tolerance && o.lastShare == options.share);
            if (!o.changed) continue;
            moved.push_back(mesh);
            of.push_back(&o);
            o.stale = true;
            o.lastEye = task.eye;
            o.lastMesh = mesh.reflectorFromMesh;
            o.lastTolerance = mesh.options.tolerance;
            o.lastShare = options.share;
        }
        reflection::VirtualMesh::update(*task.map, task.eye, moved);
        for (std::size_t k = 0; k < moved.size(); ++k) {
            of[k]->counts = moved[k].counts;
            of[k]->away = moved[k].mesh->away();
        }
    });
    counts.searchMilliseconds =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - searching).count();
    for (const Task& task : tasks_)
        for (const ChromeObject* o : task.objects) {
            ++counts.meshes;
            counts.vertices += o->mesh->vertices().size();
            counts.searched += o->changed ? o->counts.searched : 0;
            counts.triangles += o->mesh->indices().size() / 3;
        }
    return shown_;
}

}  // namespace app
