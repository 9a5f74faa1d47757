#include "app/frame/ChromeBounces.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

namespace app {

namespace {

/// Of a part, from which eyes and sizes are found.
constexpr std::size_t pointsOfPart = 48;
/// A part's share is whole where it covers so many times what it needs.
constexpr double full = 2;

float shareAt(double pixels, double least) {
    const double t = std::clamp((pixels / least - 1) / (full - 1), 0.0, 1.0);
    return static_cast<float>(t * t * (3 - 2 * t));
}

/// Pixels across that a part covers in a convex one at most: no larger than in a plane mirror at its nearest.
double mostPixels(const ChromeJob& in, const ChromeJob& of, double width, const glm::dvec3& eye,
                  double perRadian) {
    const glm::dvec3 a(in.worldFromPart[3]), b(of.worldFromPart[3]);
    const double way = std::max(glm::distance(eye, a) - in.radius, 0.0) +
                       std::max(glm::distance(a, b) - in.radius - of.radius, 0.0);
    return way > 0 ? width / way * perRadian : std::numeric_limits<double>::infinity();
}

}  // namespace

const ChromeBouncePlanner::Points& ChromeBouncePlanner::pointsOf(const ChromePart& part) {
    const auto [at, made] = points_.try_emplace(part.shape);
    if (!made) return at->second;
    // A companion goes on past the part: what is seen is the part.
    const reflection::Reflector& reflector = scene_.parts.reflectorOf(part);
    for (const reflection::ReflectorPiece& piece : reflector.pieces)
        at->second.push_back(reflection::spreadPoints(
            reflector.pieces.size() == 1 ? scene_.parts.meshOf(part) : piece.mesh, pointsOfPart));
    return at->second;
}

ChromeBounces ChromeBouncePlanner::plan(const ChromePlan& plan, std::uint32_t viewIndex,
                                        const reflection::EyeView& view, const glm::ivec2& size,
                                        std::span<const vehicles::VehiclePose> poses,
                                        const ChromeBounceOptions& options) {
    ChromeBounces result;
    const double perRadian =
        0.5 * size.y *
        glm::length(glm::dvec3(view.clipFromRelative()[0][1], view.clipFromRelative()[1][1],
                               view.clipFromRelative()[2][1]));
    struct Body {
        ChromeJob job;
        const ChromePart* part = nullptr;
        std::optional<std::uint32_t> shown;  ///< index of its own job
    };
    std::vector<Body> bodies;
    const auto find = [&](const ChromeJob& job) {
        return std::ranges::find_if(bodies, [&](const Body& b) {
            return std::tie(b.job.vehicle, b.job.part, b.job.wheel) ==
                   std::tie(job.vehicle, job.part, job.wheel);
        });
    };
    const auto partOf = [&](const ChromeJob& job) {
        return &scene_.parts.of(poses[job.vehicle].model)[job.part];
    };
    for (std::uint32_t j = 0; j < plan.jobs.size(); ++j)
        if (plan.jobs[j].view == viewIndex) bodies.push_back({plan.jobs[j], partOf(plan.jobs[j]), j});
    const std::size_t shown = bodies.size();
    std::size_t wanted = 0;
    for (std::size_t a = 0; a < shown; ++a) {
        const ChromeJob in = bodies[a].job;
        const auto meet = [&](std::uint32_t vehicle, std::uint32_t number, std::uint32_t wheel) {
            const ChromePart& part = scene_.parts.of(poses[vehicle].model)[number];
            if (!part.closed || !part.convex) return;
            ++result.parts;
            ChromeJob of = chromePartAt(poses, scene_.models, part, vehicle, number, wheel,
                                        ChromePlanOptions{}.closeRadii);
            if (!(mostPixels(in, of, static_cast<double>(part.width), view.eye, perRadian) >
                  options.leastPixels)) {
                ++result.tooSmall;
                return;
            }
            if (!options.wait && !scene_.parts.ready(part)) {
                ++result.making;
                return;
            }
            ++wanted;
            if (find(of) != bodies.end()) return;
            closeTo(of, poses, scene_.models);
            bodies.push_back({std::move(of), &part, std::nullopt});
        };
        for (const std::uint32_t vehicle : in.close) {
            const vehicles::VehiclePose& pose = poses[vehicle];
            if (pose.model >= scene_.models.size()) continue;
            const std::span<const ChromePart> own = scene_.parts.of(pose.model);
            const auto wheels = static_cast<std::uint32_t>(scene_.models[pose.model].wheels.size());
            for (std::uint32_t p = 0; p < own.size(); ++p) {
                if (!own[p].onWheel) meet(vehicle, p, ChromeJob::noWheel);
                for (std::uint32_t w = 0; own[p].onWheel && w < wheels; ++w) meet(vehicle, p, w);
            }
        }
    }
    if (wanted == 0) return result;

    std::vector<reflection::ChromeBody> parts;
    for (const Body& b : bodies) {
        reflection::ChromeBody& body = parts.emplace_back();
        body.reflector = &scene_.parts.reflectorOf(*b.part);
        body.points = pointsOf(*b.part);
        body.worldFromPart = b.job.worldFromPart;
        body.centre = glm::dvec3(b.job.worldFromPart[3]);
        body.radius = b.job.radius;
        body.reach = b.job.reach;
        body.inView = b.shown.has_value();
    }
    reflection::ChromeTreeOptions how;
    how.leastPixels = options.leastPixels;
    how.mostTexels = options.mostTexels;
    how.texelsPerPixel = options.texelsPerPixel;
    how.pastDepth = false;
    how.search.thorough = false;
    const reflection::ChromeTree tree = reflection::chromeTree(view, size, parts, how);
    result.unseen = tree.counters.unseen;
    for (const reflection::ChromeNode& node : tree.nodes) {
        const Body &in = bodies[node.in], &of = bodies[node.of];
        // What is met in pictures is met by those who draw them; a vehicle is not shown in its own chrome.
        if (node.parent != reflection::ChromeNode::none || !in.shown || in.job.vehicle == of.job.vehicle)
            continue;
        result.tooSmall += node.look == reflection::ChromeLook::tooSmall;
        result.tooBent += node.look == reflection::ChromeLook::tooBent;
        result.tooNear += node.look == reflection::ChromeLook::tooNear;
        const bool drawn = node.look == reflection::ChromeLook::picture;
        if ((drawn && result.pictures.size() >= options.mostPictures) ||
            node.look == reflection::ChromeLook::overCap)
            ++result.overCap;
        else if (drawn) {
            ChromeBounce bounce;
            bounce.in = *in.shown;
            bounce.piece = node.piece;
            bounce.of = of.job;
            bounce.of.view = 0;
            bounce.of.name.view = 0;
            bounce.of.pixels = node.pixels;
            bounce.ofPiece = node.ofPiece;
            bounce.view = node.view;
            bounce.size = node.size;
            bounce.pixels = node.pixels;
            bounce.middle = node.middle;
            bounce.shift = node.shift;
            const glm::dmat3 turn(of.job.worldFromPart);
            const double shift = glm::dot(node.axis, glm::dvec3(of.job.worldFromPart[3]));
            bounce.axis = node.axis * turn;
            bounce.low = node.low - shift;
            bounce.high = node.high - shift;
            for (const ChromeBounce& b : result.pictures)
                bounce.slice += b.in == bounce.in && b.piece == bounce.piece && b.ofPiece == bounce.ofPiece &&
                                b.of.name == bounce.of.name;
            result.pictures.push_back(std::move(bounce));
        }
    }
    const auto samePlace = [](const ChromeBounce& a, const ChromeBounce& b) {
        return a.in == b.in && a.piece == b.piece && a.ofPiece == b.ofPiece && a.of.name == b.of.name;
    };
    for (ChromeBounce& bounce : result.pictures) {
        double all = 0;  // slices are as visible as what they are cut from
        for (const ChromeBounce& b : result.pictures) all += samePlace(b, bounce) ? b.pixels : 0;
        bounce.of.share = shareAt(all, options.leastPixels);
    }
    std::erase_if(result.pictures, [](const ChromeBounce& b) { return !(b.of.share > 0); });
    return result;
}

BounceName nameOf(const ChromePlan& plan, const ChromeBounce& bounce) {
    const ChromeName &in = plan.jobs[bounce.in].name, &of = bounce.of.name;
    return {in.vehicle, in.part,  in.wheel,       bounce.piece, of.vehicle,
            of.part,    of.wheel, bounce.ofPiece, bounce.slice};
}

void ChromeBounceFades::follow(ChromeBounces& bounces, const ChromePlan& plan, std::uint32_t view,
                               std::span<const vehicles::VehiclePose> poses, const CloseScene& scene) {
    std::map<BounceName, ChromeBounce> now;
    for (ChromeBounce& bounce : bounces.pictures) {
        const BounceName name = nameOf(plan, bounce);
        const auto was = before_.find(name);
        const bool known = was != before_.end() || shown_.contains(plan.jobs[bounce.in].name);
        const float share = was != before_.end() ? was->second.of.share : 0, wanted = bounce.of.share;
        if (known) bounce.of.share = std::clamp(wanted, share - ChromeFades::step, share + ChromeFades::step);
        bounce.fading = bounce.of.share != wanted;
        now[name] = bounce;
    }
    for (auto& [name, left] : before_) {
        if (now.contains(name) || !(left.of.share > ChromeFades::step)) continue;
        const auto in = std::ranges::find_if(plan.jobs, [&, n = name](const ChromeJob& job) {
            return job.view == view && job.name.vehicle == n[0] && job.name.part == n[1] &&
                   job.name.wheel == n[2];
        });
        const auto of =
            std::ranges::find_if(poses, [n = name](const vehicles::VehiclePose& p) { return p.id == n[4]; });
        if (in == plan.jobs.end() || of == poses.end()) continue;
        // Its picture goes with the part.
        const auto number = static_cast<std::uint32_t>(of - poses.begin());
        const ChromePart& part = scene.parts.of(of->model)[left.of.part];
        ChromeJob job = chromePartAt(poses, scene.models, part, number, left.of.part, left.of.wheel,
                                     ChromePlanOptions{}.closeRadii);
        closeTo(job, poses, scene.models);
        job.pixels = left.of.pixels;
        job.share = left.of.share - ChromeFades::step;
        const glm::dmat4 moved = job.worldFromPart * glm::inverse(left.of.worldFromPart);
        left.view.eye = glm::dvec3(moved * glm::dvec4(left.view.eye, 1));
        left.view.viewFromWorld = left.view.viewFromWorld * glm::transpose(glm::dmat3(moved));
        left.of = std::move(job);
        left.fading = true;
        left.in = static_cast<std::uint32_t>(in - plan.jobs.begin());
        bounces.pictures.push_back(left);
        now[name] = left;
    }
    before_ = std::move(now);
    shown_.clear();
    for (const ChromeJob& job : plan.jobs)
        if (job.view == view) shown_.insert(job.name);
}

}  // namespace app
