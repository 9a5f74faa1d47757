// Chrome seen in the chrome of another vehicle: what it mirrors, drawn from where it is seen.
#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <utility>

#include "app/render/CityChromeImpl.h"
#include "app/render/NodeView.h"

namespace app {

namespace {

std::vector<glm::vec3> positionsOf(const city::Mesh& mesh) {
    std::vector<glm::vec3> positions;
    positions.reserve(mesh.vertices.size());
    for (const city::Vertex& v : mesh.vertices) positions.push_back(v.position);
    return positions;
}

reflection::VirtualMeshOptions meshOptions(double share) {
    reflection::VirtualMeshOptions options;
    options.vertices.share = share;
    options.vertices.search.thorough = false;
    return options;
}

}  // namespace

CityChrome::Impl::Picture::Picture(const CloseScene& scene, const std::shared_ptr<Programs>& shared,
                                   const reflection::ReflectorPiece& of, double share)
    : chrome(new CityChrome(std::make_unique<Impl>(scene, shared))),
      piece(&of),
      mesh(positionsOf(of.mesh), of.mesh.indices, meshOptions(share)),
      drawn({3, 3, 3, 3}) {
    chrome->impl_->alone = false;
}

void CityChrome::Impl::drawPictures(const ChromePlan& plan, std::uint32_t view, const PassView& pass,
                                    std::span<const ChromeShown> shown, std::span<Layer> layers,
                                    const CityMaterials& materials, const Surroundings& around,
                                    const ChromeDrawing& options, ChromeCounts& counts) {
    ++frame;
    const auto forget = [&] {
        std::erase_if(pictures, [&](const auto& p) { return frame > p.second->used + Picture::framesKept; });
        for (const auto& [name, picture] : pictures)
            if (picture->used != frame) picture->chrome->skip(around.renewed);
    };
    if (options.bounces <= 1 || !around.setFrame) return forget();
    if (!planner) planner = std::make_unique<ChromeBouncePlanner>(scene);
    reflection::EyeView eye;
    eye.eye = pass.eye;
    eye.clipFromView = glm::dmat4(pass.clipFromRelative);
    ChromeBounceOptions how;
    how.wait = options.wait;
    const ChromeBounces bounces = planner->plan(plan, view, eye, drawnSize, around.poses, how);
    ChromeDrawing next = options;
    --next.bounces;
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
        Layer& shownIn = layers[static_cast<std::size_t>(at - shown.begin())];
        const PictureName name{around.poses[in.vehicle].id,
                               in.part,
                               in.wheel,
                               bounce.piece,
                               bounce.of.name.vehicle,
                               bounce.of.part,
                               bounce.of.wheel,
                               bounce.ofPiece,
                               bounce.slice};
        std::unique_ptr<Picture>& kept = pictures[name];
        const bool isNew = !kept;
        if (isNew) kept = std::make_unique<Picture>(scene, programs, piece, options.share);
        Picture& picture = *kept;
        picture.changed = isNew || picture.used + 1 != frame;
        picture.used = frame;

        ChromePlan itsOwn;
        itsOwn.jobs.push_back(bounce.of);
        const PassView from(bounce.view.eye,
                            clipFromRelative(bounce.view.clipFromView, bounce.view.viewFromWorld),
                            0.5f * static_cast<float>(bounce.size.y) *
                                std::abs(static_cast<float>(bounce.view.clipFromView[1][1])));
        around.setFrame(from);
        const ChromeCounts own = picture.chrome->draw(itsOwn, 0, from, bounce.size, materials, around, next);
        ++counts.pictures;
        counts.picturesDrawn += own.drawn > 0;
        counts.pictureTexels +=
            static_cast<std::uint64_t>(bounce.size.x) * static_cast<std::uint64_t>(bounce.size.y);
        counts.pictures += own.pictures;
        counts.picturesDrawn += own.picturesDrawn;
        counts.pictureTexels += own.pictureTexels;
        counts.vertices += own.vertices;
        counts.searched += own.searched;
        counts.triangles += own.triangles;
        counts.searchMilliseconds += own.searchMilliseconds;

        // Where it is seen in the other part, and where from its picture's eye each of its points' light is.
        const glm::dmat4 inFromWorld = glm::inverse(in.worldFromPart);
        const glm::dmat4 inFromPart = inFromWorld * bounce.of.worldFromPart;
        const glm::dmat4 partFromIn = glm::inverse(inFromPart);
        const glm::dvec3 eyeInOther(inFromWorld * glm::dvec4(pass.eye, 1));
        const glm::dvec3 pictureEye(glm::inverse(bounce.of.worldFromPart) * glm::dvec4(bounce.view.eye, 1));
        reflection::VirtualMeshOptions mesh = meshOptions(options.share);
        mesh.tolerance = options.tolerance / static_cast<double>(pass.pixelsPerRadian);
        mesh.vertices.cellTolerance = 0.5 * mesh.tolerance;
        const bool moved = isNew || !options.keep || picture.lastPlace != inFromPart ||
                           picture.lastEye != eyeInOther || picture.lastPictureEye != pictureEye ||
                           picture.lastTolerance != mesh.tolerance;
        picture.changed = picture.changed || moved || own.drawn > 0 ||
                          picture.bounce.of.share != bounce.of.share || picture.bounce.size != bounce.size ||
                          picture.bounce.low != bounce.low || picture.bounce.high != bounce.high;
        picture.bounce = bounce;
        shownIn.pictures.push_back(&picture);
        for (Layer::Thing& thing : shownIn.things)
            thing.bounced = thing.bounced || thing.object->vehicle == bounce.of.vehicle;
        if (!moved) continue;
        picture.lastPlace = inFromPart;
        picture.lastEye = eyeInOther;
        picture.lastPictureEye = pictureEye;
        picture.lastTolerance = mesh.tolerance;
        const reflection::VirtualCounts found =
            picture.mesh.update(inPiece.built.map, eyeInOther, inFromPart, mesh);
        counts.searched += found.searched;
        const std::span<const city::Vertex> vertices(piece.mesh.vertices);
        std::vector<float> values;
        values.reserve(12 * vertices.size());
        std::vector<std::size_t> asked;
        std::vector<glm::dvec3> places;
        for (std::size_t k = 0; k < vertices.size(); ++k) {
            const glm::dvec3 p(vertices[k].position), n = glm::normalize(glm::dvec3(vertices[k].normal));
            const glm::dvec3 seenAt = reflection::reflectionPointOf(
                picture.mesh.vertices()[k], eyeInOther, glm::dvec3(inFromPart * glm::dvec4(p, 1)));
            const glm::dvec3 from2(partFromIn * glm::dvec4(seenAt, 1));
            const glm::dvec3 d = (p - from2) / std::max(glm::distance(p, from2), 1e-12);
            if (glm::dot(d, n) < 0) {
                asked.push_back(k);
                places.push_back(p + bounce.middle * (d - 2.0 * glm::dot(d, n) * n));
            }
            const glm::vec3 position(p), normal(n), f(from2);
            for (const glm::vec3& v : {position, normal, f, position})
                values.insert(values.end(), {v.x, v.y, v.z});
        }
        std::vector<reflection::ReflectionPoint> answers(places.size());
        reflection::findReflectionPoints(piece.built.map, pictureEye, places, answers, mesh.vertices.search);
        counts.searched += places.size();
        for (std::size_t i = 0; i < asked.size(); ++i) {
            if (answers[i].status != reflection::ReflectionStatus::found &&
                answers[i].status != reflection::ReflectionStatus::unreflected)
                continue;
            const glm::vec3 at3(answers[i].point);
            for (int c = 0; c < 3; ++c) values[12 * asked[i] + 9 + static_cast<std::size_t>(c)] = at3[c];
        }
        picture.drawn.upload(picture.mesh, values);
    }
    forget();
    if (!bounces.pictures.empty()) around.setFrame(pass);
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
        program.set("pictureEye", glm::vec3(picture->lastPictureEye));
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
