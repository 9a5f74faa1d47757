// Chrome seen in the chrome of another vehicle: what it mirrors, drawn from where it is seen.
#include <epoxy/gl.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <utility>

#include "app/render/CityChromeImpl.h"
#include "app/render/NodeView.h"

namespace app {

namespace {

std::vector<glm::vec3> positionsOf(std::span<const city::Vertex> vertices) {
    std::vector<glm::vec3> positions;
    positions.reserve(vertices.size());
    for (const city::Vertex& v : vertices) positions.push_back(v.position);
    return positions;
}

reflection::VirtualMeshOptions meshOptions(double share) {
    reflection::VirtualMeshOptions options;
    options.vertices = reflection::withShare(options.vertices, share);
    options.vertices.search.thorough = false;
    return options;
}

/// By how much what chrome shows of other chrome may be coarser than what it shows of the rest: one eye for
/// all of it is off by up to four pixels as it is (ChromeTreeOptions::mostStray).
constexpr double coarser = 2;
/// Ratio of sizes within which a picture serves.
constexpr double otherSize = 1.25;
/// Frames for which a picture serves while nothing close to it moves: vehicles' local maps, which it may
/// show, go on meanwhile.
constexpr std::uint64_t framesLasting = 16;

/// Share of the distance to the other part.
constexpr double slackOfFacing = 0.1;

bool sameLook(const vehicles::VehiclePose& a, const vehicles::VehiclePose& b) {
    return a.id == b.id && a.model == b.model && a.position == b.position && a.heading == b.heading &&
           a.pitch == b.pitch && a.wheelAngle == b.wheelAngle && a.steering == b.steering &&
           a.paint == b.paint && a.braking == b.braking;
}

}  // namespace

void CityChrome::Impl::Body::face(const glm::dvec3& centre, double radius, double share) {
    if (mesh && glm::distance(centre, facedCentre) <= facedSlack) return;
    // So far may the other move before this is done again.
    facedSlack = slackOfFacing * glm::length(centre);
    facedCentre = centre;
    const std::span<const city::Vertex> all(piece.mesh.vertices);
    std::vector<bool> faces(all.size());
    for (std::size_t k = 0; k < all.size(); ++k) {
        const glm::dvec3 p(all[k].position), n = glm::normalize(glm::dvec3(all[k].normal));
        faces[k] = glm::dot(n, centre - p) > -radius - facedSlack;
    }
    constexpr std::uint32_t none = ~0u;
    std::vector<std::uint32_t> numbers(all.size(), none), indices;
    vertices.clear();
    for (std::size_t t = 0; t + 2 < piece.mesh.indices.size(); t += 3) {
        const std::uint32_t* corner = &piece.mesh.indices[t];
        if (!faces[corner[0]] && !faces[corner[1]] && !faces[corner[2]]) continue;
        for (int c = 0; c < 3; ++c) {
            std::uint32_t& number = numbers[corner[c]];
            if (number == none) {
                number = static_cast<std::uint32_t>(vertices.size());
                vertices.push_back(all[corner[c]]);
            }
            indices.push_back(number);
        }
    }
    mesh.emplace(positionsOf(vertices), std::move(indices), meshOptions(share));
    lastTolerance = -1;
}

void CityChrome::Impl::Body::find(const reflection::ReflectorMap& in, const glm::dvec3& eye,
                                  const glm::dmat4& inFromPart, const reflection::VirtualMeshOptions& options,
                                  bool keep) {
    searched = 0;
    moved = !keep || lastPlace != inFromPart || lastEye != eye || lastTolerance != options.tolerance;
    if (!moved) return;
    lastPlace = inFromPart;
    lastEye = eye;
    lastTolerance = options.tolerance;
    searched = mesh->update(in, eye, inFromPart, options).searched;
    const glm::dmat4 partFromIn = glm::inverse(inFromPart);
    from.resize(vertices.size());
    for (std::size_t k = 0; k < vertices.size(); ++k) {
        const glm::dvec3 at(inFromPart * glm::dvec4(glm::dvec3(vertices[k].position), 1));
        from[k] = glm::dvec3(partFromIn *
                             glm::dvec4(reflection::reflectionPointOf(mesh->vertices()[k], eye, at), 1));
    }
}

CityChrome::Impl::Picture::Picture(const CloseScene& scene, const std::shared_ptr<Programs>& shared)
    : chrome(new CityChrome(std::make_unique<Impl>(scene, shared))), drawn({3, 3, 3, 3}) {
    chrome->impl_->alone = false;
}

double CityChrome::Impl::Picture::offAs(const ChromeBounce& now, const Surroundings& around,
                                        const ChromeDrawing& how, std::uint64_t frame) const {
    constexpr double never = std::numeric_limits<double>::infinity();
    const auto near = [](double a, double b, double most) {
        return a == b || std::abs(a - b) <= most;  // ends may be endless
    };
    constexpr double sameSlice = 1e-6;
    if (drawnIn == 0 || frame >= drawnIn + framesLasting || !(lighting == around.lighting) ||
        !(options == how) || bounce.of.worldFromPart != now.of.worldFromPart ||
        bounce.of.close.size() != now.of.close.size() ||
        !(glm::distance(bounce.axis, now.axis) <= sameSlice) || !near(bounce.low, now.low, sameSlice) ||
        !near(bounce.high, now.high, sameSlice) || now.pixels > otherSize * bounce.pixels ||
        bounce.pixels > otherSize * now.pixels)
        return never;
    for (std::size_t k = 0; k < closeBy.size(); ++k)
        if (!sameLook(closeBy[k], around.poses[now.of.close[k]])) return never;
    return now.shift * glm::distance(now.view.eye, bounce.view.eye);
}

void CityChrome::Impl::Picture::look(const reflection::SearchOptions& search) {
    const std::span<const city::Vertex> vertices(body->vertices);
    values.clear();
    values.reserve(12 * vertices.size());
    std::vector<std::size_t> asked;
    std::vector<glm::dvec3> places;
    // Vertices outside the slice have triangles that reach into it.
    const double wide = bounce.high - bounce.low;
    for (std::size_t k = 0; k < vertices.size(); ++k) {
        const glm::dvec3 p(vertices[k].position),
            n = glm::normalize(glm::dvec3(vertices[k].normal)),
            d = (p - body->from[k]) / std::max(glm::distance(p, body->from[k]), 1e-12);
        const double along = glm::dot(bounce.axis, p);
        if (glm::dot(d, n) < 0 && along > bounce.low - wide && along < bounce.high + wide) {
            asked.push_back(k);
            places.push_back(p + bounce.middle * (d - 2.0 * glm::dot(d, n) * n));
        }
        const glm::vec3 position(p), normal(n), f(body->from[k]);
        for (const glm::vec3& v : {position, normal, f, position})
            values.insert(values.end(), {v.x, v.y, v.z});
    }
    std::vector<reflection::ReflectionPoint> answers(places.size());
    reflection::findReflectionPoints(body->piece.built.map, eye, places, answers, search);
    searched = places.size();
    for (std::size_t i = 0; i < asked.size(); ++i) {
        if (answers[i].status != reflection::ReflectionStatus::found &&
            answers[i].status != reflection::ReflectionStatus::unreflected)
            continue;
        const glm::vec3 at(answers[i].point);
        for (int c = 0; c < 3; ++c) values[12 * asked[i] + 9 + static_cast<std::size_t>(c)] = at[c];
    }
}

void CityChrome::Impl::drawPictures(const ChromePlan& plan, std::uint32_t view, const PassView& pass,
                                    std::span<const ChromeShown> shown, std::span<Layer> layers,
                                    const CityMaterials& materials, const Surroundings& around,
                                    const ChromeDrawing& options, ChromeCounts& counts) {
    const auto start = std::chrono::steady_clock::now();
    ++frame;
    const auto forget = [&] {
        const auto old = [&](const auto& p) { return frame > p.second->used + Picture::framesKept; };
        std::erase_if(pictures, old);
        std::erase_if(seenBodies, old);
        for (const auto& [name, picture] : pictures)
            if (picture->drawnIn != frame) picture->chrome->skip(around.renewed);
    };
    if (options.bounces <= 1 || !around.setFrame) return forget();
    if (!planner) planner = std::make_unique<ChromeBouncePlanner>(scene);
    reflection::EyeView eye;
    eye.eye = pass.eye;
    eye.clipFromView = glm::dmat4(pass.clipFromRelative);
    ChromeBounceOptions how;
    how.wait = options.wait;
    how.leastPixels = options.bouncePixels;
    ChromeBounces bounces = planner->plan(plan, view, eye, drawnSize, around.poses, how);
    fades.follow(bounces, plan, view, around.poses, scene);
    counts.bounces.parts += bounces.parts;
    counts.bounces.tooSmall += bounces.tooSmall;
    counts.bounces.unseen += bounces.unseen;
    counts.bounces.tooBent += bounces.tooBent;
    counts.bounces.tooNear += bounces.tooNear;
    counts.bounces.overCap += bounces.overCap;
    counts.bounces.making += bounces.making;
    if (bounces.pictures.empty()) return forget();
    ChromeDrawing next = options;
    --next.bounces;
    next.tolerance *= coarser;
    next.detail *= coarser;

    struct Work {
        Picture* picture = nullptr;
        Layer* in = nullptr;
        double off = 0;
        bool anew = false;
        std::optional<PassView> from;
        ChromeCounts counts;
    };
    struct Search {
        Body* body = nullptr;
        const reflection::ReflectorMap* in = nullptr;
        glm::dvec3 eye{0};
        glm::dmat4 inFromPart{1};
    };
    std::vector<Work> works;
    std::vector<Search> searches;
    for (const ChromeBounce& bounce : bounces.pictures) {
        const ChromeJob& in = plan.jobs[bounce.in];
        const ChromePart& part = scene.parts.of(around.poses[bounce.of.vehicle].model)[bounce.of.part];
        const reflection::ReflectorPiece& piece = scene.parts.reflectorOf(part).pieces[bounce.ofPiece];
        const reflection::ReflectorPiece& inPiece =
            scene.parts.reflectorOf(scene.parts.of(around.poses[in.vehicle].model)[in.part])
                .pieces[bounce.piece];
        const auto at = std::ranges::find_if(
            shown, [&](const ChromeShown& s) { return s.job == &in && s.piece == &inPiece; });
        if (at == shown.end()) continue;
        BounceName name = nameOf(plan, bounce);
        std::unique_ptr<Picture>& kept = pictures[name];
        if (!kept) kept = std::make_unique<Picture>(scene, programs);
        name.back() = 0;
        std::unique_ptr<Body>& body = seenBodies[name];
        if (!body) body = std::make_unique<Body>(piece);
        if (body->used != frame) {
            const glm::dmat4 inFromWorld = glm::inverse(in.worldFromPart);
            body->face(glm::dvec3(glm::inverse(bounce.of.worldFromPart) * in.worldFromPart[3]), in.radius,
                       options.share);
            searches.push_back({body.get(), &inPiece.built.map,
                                glm::dvec3(inFromWorld * glm::dvec4(pass.eye, 1)),
                                inFromWorld * bounce.of.worldFromPart});
        }
        Work& work = works.emplace_back();
        work.picture = kept.get();
        work.in = &layers[static_cast<std::size_t>(at - shown.begin())];
        Picture& picture = *kept;
        picture.changed = picture.used + 1 != frame || picture.share != bounce.of.share;
        picture.used = body->used = frame;
        picture.body = body.get();
        picture.share = bounce.of.share;
        work.off = options.keep ? picture.offAs(bounce, around, next, frame)
                                : std::numeric_limits<double>::infinity();
        work.anew = work.off > Picture::mostOff;
        work.in->pictures.push_back(&picture);
        for (Layer::Thing& thing : work.in->things)
            thing.bounced = thing.bounced || thing.object->vehicle == bounce.of.vehicle;
        ++counts.bounces.pictures;
        counts.bounces.fading += bounce.fading;
        picture.next = bounce;
    }
    // Those that hold are drawn in turn before they must be, so that they do not end together.
    if (std::ranges::none_of(works, &Work::anew)) {
        const auto first = std::ranges::max_element(works, {}, &Work::off);
        if (first != works.end() && first->off > 0.5 * Picture::mostOff) first->anew = true;
    }
    for (Work& work : works) {
        if (!work.anew) continue;
        Picture& picture = *work.picture;
        ChromeBounce& bounce = picture.bounce = picture.next;
        bounce.of.share = 1;  // it is given where the picture is looked up
        picture.plan.jobs = {bounce.of};
        picture.closeBy.clear();
        for (const std::uint32_t other : bounce.of.close) picture.closeBy.push_back(around.poses[other]);
        picture.lighting = around.lighting;
        picture.options = next;
        picture.drawnIn = frame;
        picture.eye = glm::dvec3(glm::inverse(bounce.of.worldFromPart) * glm::dvec4(bounce.view.eye, 1));
        work.from.emplace(bounce.view.eye,
                          clipFromRelative(bounce.view.clipFromView, bounce.view.viewFromWorld),
                          0.5f * static_cast<float>(bounce.size.y) *
                              std::abs(static_cast<float>(bounce.view.clipFromView[1][1])));
        picture.chrome->impl_->objects.gather(picture.plan, 0, *work.from, around.poses, next, work.counts);
    }
    reflection::VirtualMeshOptions mesh = meshOptions(options.share);
    mesh.tolerance = coarser * options.tolerance / static_cast<double>(pass.pixelsPerRadian);
    mesh.vertices.cellTolerance = 0.5 * mesh.tolerance;
    tbb::parallel_for(std::size_t{0}, works.size() + searches.size(), [&](std::size_t i) {
        if (i < searches.size()) {
            const Search& s = searches[i];
            s.body->find(*s.in, s.eye, s.inFromPart, mesh, options.keep);
        } else if (Work& work = works[i - searches.size()]; work.anew) {
            work.picture->chrome->impl_->objects.search(next, work.counts);
        }
    });
    tbb::parallel_for(std::size_t{0}, works.size(), [&](std::size_t i) {
        if (works[i].anew || works[i].picture->body->moved) works[i].picture->look(mesh.vertices.search);
    });
    for (const Search& s : searches) counts.searched += s.body->searched;
    for (Work& work : works) {
        Picture& picture = *work.picture;
        const glm::ivec2 texels = picture.bounce.size;
        counts.bounces.texels += static_cast<std::uint64_t>(texels.x) * static_cast<std::uint64_t>(texels.y);
        if (work.anew) {
            around.setFrame(*work.from);
            picture.chrome->impl_->searchedAhead = work.counts;
            const ChromeCounts own =
                picture.chrome->draw(picture.plan, 0, *work.from, texels, materials, around, next);
            counts.bounces.drawn += own.drawn > 0;
            counts.bounces.add(own.bounces);
            counts.vertices += own.vertices;
            counts.searched += own.searched;
            counts.triangles += own.triangles;
            picture.changed = picture.changed || own.drawn > 0;
        }
        if (work.anew || picture.body->moved) {
            counts.searched += picture.searched;
            picture.drawn.upload(*picture.body->mesh, picture.values);
            picture.changed = true;
        }
    }
    forget();
    around.setFrame(pass);
    counts.bounces.milliseconds +=
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

void CityChrome::Impl::drawBodies(const Layer& l, const glm::mat4& clipFromVirtual) {
    if (!bodies) bodies.emplace();
    if (!programs->body)
        programs->body = gl::Program::fromFiles({"chrome_body.vert", "chrome_body.frag"}, {"CLOSE"});
    bodies->begin(drawnSize, l.pixels);
    glDisable(GL_CULL_FACE);
    const gl::Program& program = programs->body;
    program.set("clipFromVirtual", clipFromVirtual);
    for (const Picture* picture : l.pictures) {
        const ChromeBounce& bounce = picture->bounce;
        const CityChrome::Impl& image = *picture->chrome->impl_;
        program.set("share", picture->share);
        program.set("pictureEye", glm::vec3(picture->eye));
        program.set("pictureFromRelative", glm::mat4(bounce.view.clipFromRelative() *
                                                     glm::dmat4(glm::dmat3(bounce.of.worldFromPart))));
        program.set("pictureShare", glm::vec2(bounce.size) / glm::vec2(image.size));
        program.set("slice", glm::vec3(bounce.axis));
        constexpr double endless = 1e30;
        program.set("sliceEnds", glm::vec2(std::max(bounce.low, -endless), std::min(bounce.high, endless)));
        program.use();
        glBindTextureUnit(12, image.light.name());
        picture->drawn.draw();
    }
}

}  // namespace app
