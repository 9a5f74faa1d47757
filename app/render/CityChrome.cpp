#include "app/render/CityChrome.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <utility>
#include <vector>

#include "app/render/CityChromeImpl.h"
#include "app/render/NodeView.h"

namespace app {

namespace {

double milliseconds(std::chrono::steady_clock::time_point since) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - since).count();
}

bool contains(const std::vector<reflection::LocalMapSlot>& slots, const reflection::LocalMapSlot& slot) {
    return std::ranges::any_of(slots, [&](const reflection::LocalMapSlot& s) {
        return s.sizeClass == slot.sizeClass && s.layer == slot.layer;
    });
}

/// A box wider or higher than one part in so many of the picture is looked at triangle by triangle.
constexpr int wideBox = 4;

/// Pixels that a mesh covers at most.
reflection::PixelRect pixelsOfMesh(const glm::mat4& clipFromMesh, const glm::ivec2& size,
                                   const city::Mesh& mesh) {
    // Well before the nearest plane of any projection here: what crosses it is taken from there on.
    constexpr float nearest = 1e-3f;
    std::vector<glm::vec4> clip;
    clip.reserve(mesh.vertices.size());
    for (const city::Vertex& v : mesh.vertices) clip.push_back(clipFromMesh * glm::vec4(v.position, 1));
    glm::vec2 low(1e9f), high(-1e9f);
    const auto take = [&](const glm::vec4& p) {
        const glm::vec2 at = (glm::vec2(p) / p.w * 0.5f + 0.5f) * glm::vec2(size);
        low = glm::min(low, at);
        high = glm::max(high, at);
    };
    for (std::size_t k = 0; k < mesh.indices.size(); ++k) {
        const glm::vec4 &a = clip[mesh.indices[k]], &b = clip[mesh.indices[k % 3 == 2 ? k - 2 : k + 1]];
        if (a.w >= nearest) take(a);
        if ((a.w >= nearest) != (b.w >= nearest)) {
            glm::vec4 cut = a + (nearest - a.w) / (b.w - a.w) * (b - a);
            cut.w = nearest;
            take(cut);
        }
    }
    if (!(low.x <= high.x)) return {};
    const auto inside = [&](const glm::vec2& p) {
        return glm::ivec2(glm::clamp(p, glm::vec2(0), glm::vec2(size)));
    };
    return {inside(glm::floor(low)), inside(glm::ceil(high))};
}

}  // namespace

CityChrome::Impl::Impl(const CloseScene& closeScene, std::shared_ptr<Programs> shared)
    : objects(closeScene), scene(closeScene), programs(std::move(shared)) {}
CityChrome::Impl::~Impl() = default;

CityChrome::CityChrome(const CloseScene& scene) : impl_(std::make_unique<Impl>(scene, nullptr)) {}
CityChrome::CityChrome(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
CityChrome::~CityChrome() = default;

std::uint32_t CityChrome::light() const {
    return impl_->light.name();
}
std::uint32_t CityChrome::depth() const {
    return impl_->depth.name();
}
std::size_t CityChrome::bytes() const {
    std::size_t bytes =
        (impl_->layer ? impl_->layer->bytes() : 0) + (impl_->bodies ? impl_->bodies->bytes() : 0) +
        static_cast<std::size_t>(impl_->size.x) * static_cast<std::size_t>(impl_->size.y) * 12;
    for (const auto& [name, picture] : impl_->pictures) bytes += picture->chrome->bytes();
    return bytes;
}

void CityChrome::Impl::makeGlObjects() {
    if (layer) return;
    layer.emplace();
    mapSampler = gl::Sampler::create(GL_LINEAR_MIPMAP_NEAREST, GL_LINEAR, GL_CLAMP_TO_EDGE);
    if (programs) return;
    programs = std::make_shared<Programs>();
    programs->mask = gl::Program::fromFiles({"chrome_part.vert", "chrome_part.frag"}, {"MASK"});
    const auto makePart = [&](Drawing drawing, const std::vector<std::string>& defines) {
        programs->parts[static_cast<std::size_t>(drawing)] =
            gl::Program::fromFiles({"chrome_part.vert", "chrome_part.frag"}, defines);
    };
    makePart(Drawing::plain, {});
    makePart(Drawing::map, {"REFLECTIVE"});
    makePart(Drawing::parallax, {"REFLECTIVE", "PARALLAX"});
    const auto make = [&](Drawing drawing, std::vector<std::string> defines) {
        defines.emplace_back("VIRTUAL");
        const bool city = drawing == Drawing::solid || drawing == Drawing::cutout;
        programs->things[static_cast<std::size_t>(drawing)] =
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
    glDisable(GL_SCISSOR_TEST);
    glDepthMask(GL_TRUE);
    light = gl::Texture::image2D(GL_RGBA16F, size.x, size.y);
    light.filter(GL_NEAREST, GL_NEAREST).wrap(GL_CLAMP_TO_EDGE);
    depth = gl::Texture::image2D(GL_DEPTH_COMPONENT32F, size.x, size.y);
    depth.filter(GL_NEAREST, GL_NEAREST).wrap(GL_CLAMP_TO_EDGE);
    target = gl::Framebuffer::create();
    target.attach(GL_COLOR_ATTACHMENT0, light.name()).attach(GL_DEPTH_ATTACHMENT, depth.name());
    target.requireComplete("what chrome shows of close things");
    constexpr float far = 0;
    constexpr std::array<float, 4> nothing{};
    glClearNamedFramebufferfv(target.name(), GL_COLOR, 0, nothing.data());
    glClearNamedFramebufferfv(target.name(), GL_DEPTH, 0, &far);
    before.clear();
}

const CityChrome::Impl::PieceMesh& CityChrome::Impl::pieceMesh(const reflection::ReflectorPiece& piece) {
    PieceMesh& mesh = pieces[&piece];
    if (mesh.count > 0) return mesh;
    mesh.vertices = gl::Buffer::filled(std::span<const city::Vertex>(piece.mesh.vertices));
    mesh.indices = gl::Buffer::filled(std::span<const std::uint32_t>(piece.mesh.indices));
    mesh.array = gl::VertexArray::create();
    mesh.array.buffer(0, mesh.vertices.name(), sizeof(city::Vertex))
        .attribute(0, 0, 3, GL_FLOAT, false, offsetof(city::Vertex, position))
        .attribute(1, 0, 3, GL_FLOAT, false, offsetof(city::Vertex, normal))
        .indices(mesh.indices.name());
    mesh.count = static_cast<GLsizei>(piece.mesh.indices.size());
    mesh.box = piece.mesh.bounds();
    return mesh;
}

CityChrome::Impl::Layer CityChrome::Impl::layerOf(const ChromeShown& shown, std::uint32_t piece,
                                                  const PassView& pass, const Surroundings& around) {
    const auto drawingOf = [&](std::uint32_t vehicle) {
        if (around.textures == nullptr || vehicle >= around.slots.size() || !around.slots[vehicle].valid())
            return Drawing::plain;
        const auto sizeClass = static_cast<std::size_t>(around.slots[vehicle].sizeClass);
        return around.textures->nearnessArrays[sizeClass] != 0 ? Drawing::parallax
               : around.textures->cubeArrays[sizeClass] != 0   ? Drawing::map
                                                               : Drawing::plain;
    };
    Layer l;
    l.name = {around.poses[shown.job->vehicle].id, shown.job->part, shown.job->wheel, piece};
    l.worldFromPart = shown.job->worldFromPart;
    l.share = shown.job->share;
    // A picture is taken up by place: there only what is close has its place.
    l.far = alone ? drawingOf(shown.job->vehicle) : Drawing::plain;
    if (l.far != Drawing::plain) l.slot = around.slots[shown.job->vehicle];
    const glm::mat4 clip = clipFromPart(*shown.job, pass);
    l.pixels = pixelsOfBox(clip, drawnSize, pieceMesh(*shown.piece).box);
    // A box near the eye says little; all that is drawn is bounded by these pixels.
    if (l.pixels.size().x > drawnSize.x / wideBox || l.pixels.size().y > drawnSize.y / wideBox)
        l.pixels = pixelsOfMesh(clip, drawnSize, shown.piece->mesh);
    l.things.reserve(shown.objects.size());
    for (const ChromeObject* o : shown.objects) {
        Layer::Thing& thing = l.things.emplace_back();
        thing.object = o;
        thing.worldFromMesh = o->worldFromMesh;
        if (o->vehicle == ChromeObject::noVehicle) {
            thing.drawing = o->source->cutout ? Drawing::cutout : Drawing::solid;
            continue;
        }
        const vehicles::VehiclePose& pose = around.poses[o->vehicle];
        thing.drawing = drawingOf(o->vehicle);
        thing.paint = glm::vec4(pose.paint, pose.braking ? 1.f : 0.f);
        if (thing.drawing != Drawing::plain) thing.slot = around.slots[o->vehicle];
    }
    return l;
}

std::vector<bool> CityChrome::Impl::outdated(std::span<const ChromeShown> shown,
                                             std::span<const Layer> layers, const Seen& seenAs,
                                             const Surroundings& around) {
    std::vector<bool> anew(layers.size(), !(seenAs == seenBefore));
    std::vector<reflection::PixelRect> cleared;
    const auto renewed = [&](const reflection::LocalMapSlot& slot) {
        return slot.valid() && (around.renewed == nullptr || !skipped || contains(*around.renewed, slot) ||
                                contains(*skipped, slot));
    };
    for (std::size_t i = 0; i < layers.size(); ++i) {
        const Layer& l = layers[i];
        const auto was = std::ranges::find_if(before, [&](const Layer& b) { return b.name == l.name; });
        anew[i] = anew[i] || was == before.end() || !(*was == l) || renewed(l.slot) ||
                  std::ranges::any_of(shown[i].objects, [](const auto* o) { return o->changed; }) ||
                  std::ranges::any_of(l.things, [&](const auto& t) { return renewed(t.slot); }) ||
                  std::ranges::any_of(l.pictures, [](const auto* p) { return p->changed; });
        if (anew[i]) cleared.push_back(l.pixels);
    }
    for (const Layer& b : before) {
        const auto is = std::ranges::find_if(layers, [&](const Layer& l) { return b.name == l.name; });
        if (is == layers.end() || anew[static_cast<std::size_t>(is - layers.begin())])
            cleared.push_back(b.pixels);
    }
    // What is cleared with others is to be drawn anew, too.
    const auto meet = [](const reflection::PixelRect& a, const reflection::PixelRect& b) {
        return a.low.x < b.high.x && b.low.x < a.high.x && a.low.y < b.high.y && b.low.y < a.high.y;
    };
    for (std::size_t i = 0; i < layers.size();) {
        if (anew[i] ||
            !std::ranges::any_of(cleared, [&](const auto& c) { return meet(c, layers[i].pixels); })) {
            ++i;
            continue;
        }
        anew[i] = true;
        cleared.push_back(layers[i].pixels);
        i = 0;
    }
    constexpr float far = 0;
    constexpr std::array<float, 4> nothing{};
    glEnable(GL_SCISSOR_TEST);
    for (const reflection::PixelRect& c : cleared) {
        if (c.empty()) continue;
        glScissor(c.low.x, c.low.y, c.size().x, c.size().y);
        glClearNamedFramebufferfv(target.name(), GL_DEPTH, 0, &far);
        if (!alone) glClearNamedFramebufferfv(target.name(), GL_COLOR, 0, nothing.data());
    }
    return anew;
}

void CityChrome::skip(const std::vector<reflection::LocalMapSlot>* renewed) {
    Impl& my = *impl_;
    for (const auto& [name, picture] : my.pictures) picture->chrome->skip(renewed);
    if (renewed == nullptr || !my.skipped) {
        my.skipped.reset();
        return;
    }
    for (const reflection::LocalMapSlot& slot : *renewed)
        if (!contains(*my.skipped, slot)) my.skipped->push_back(slot);
}

ChromeCounts CityChrome::draw(const ChromePlan& plan, std::uint32_t view, const PassView& pass,
                              glm::ivec2 size, const CityMaterials& materials, const Surroundings& around,
                              const ChromeDrawing& options) {
    Impl& my = *impl_;
    const auto start = std::chrono::steady_clock::now();
    my.makeGlObjects();
    my.allocate(size);
    my.drawnSize = size;
    const bool ahead = my.searchedAhead.has_value();
    ChromeCounts counts = std::exchange(my.searchedAhead, {}).value_or(ChromeCounts{});
    const std::span<const ChromeShown> shown =
        ahead ? my.objects.shown() : my.objects.update(plan, view, pass, around.poses, options, counts);
    std::vector<Impl::Layer> layers;
    layers.reserve(shown.size());
    for (std::size_t i = 0; i < shown.size(); ++i) {
        const bool sameJob = i > 0 && shown[i].job == shown[i - 1].job;
        layers.push_back(my.layerOf(shown[i], sameJob ? layers.back().name[3] + 1 : 0, pass, around));
    }
    my.drawPictures(plan, view, pass, shown, layers, materials, around, options, counts);

    setDrawState();
    materials.bind();
    const Impl::Seen seenAs{pass.eye, pass.clipFromRelative, size, around.lighting};
    const std::vector<bool> anew = my.outdated(shown, layers, seenAs, around);
    // What is handed over is what shows in this view.
    if (!(seenAs == my.seenBefore))
        for (const ChromeShown& s : shown)
            for (ChromeObject* o : s.objects) o->stale = true;
    for (std::size_t i = 0; i < layers.size(); ++i) {
        const Impl::Layer& l = layers[i];
        // Of what is not seen now the image may have moved: it is handed over later.
        if (!anew[i] || l.pixels.empty()) continue;
        ++counts.drawn;
        const ChromeJob& job = *shown[i].job;
        const Impl::PieceMesh& mesh = my.pieceMesh(*shown[i].piece);
        const glm::dmat3 turn(job.worldFromPart);
        const glm::vec3 middle(glm::dvec3(job.worldFromPart[3]) - pass.eye);
        const glm::mat4 clipFromVirtual = pass.clipFromRelative * glm::mat4(glm::dmat4(turn));
        if (!l.pictures.empty()) my.drawBodies(l, clipFromVirtual);
        // Only the piece's own pixels are worth shading.
        my.layer->begin(size, l.pixels);
        my.layer->beginMask();
        glEnable(GL_CULL_FACE);
        my.programs->mask.set("clipFromPart", Impl::clipFromPart(job, pass));
        my.programs->mask.use();
        mesh.array.bind();
        glDrawElements(GL_TRIANGLES, mesh.count, GL_UNSIGNED_INT, nullptr);
        my.layer->endMask();
        glDisable(GL_CULL_FACE);
        // What hides others first: their pixels behind it are not shaded.
        std::vector<std::size_t> order(l.things.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::ranges::stable_sort(order, {}, [&](std::size_t k) { return shown[i].objects[k]->away; });
        for (const std::size_t k : order) {
            ChromeObject& o = *shown[i].objects[k];
            if (!o.drawn) o.drawn = std::make_unique<gl::ChromeMesh>(o.source->attributes);
            if (o.stale) o.drawn->upload(*o.mesh, o.source->values, {clipFromVirtual, size, l.pixels});
            o.stale = false;
            my.drawThing(l.things[k], clipFromVirtual, glm::mat3(turn),
                         glm::vec4(middle, static_cast<float>(job.reach)), pass.eye, around);
        }
        glBindFramebuffer(GL_FRAMEBUFFER, my.target.name());
        glEnable(GL_CULL_FACE);
        my.drawPiece(l, mesh, pass, around);
    }
    my.before = std::move(layers);
    my.seenBefore = seenAs;
    my.skipped.emplace();
    setDrawState();
    counts.milliseconds = milliseconds(start);
    return counts;
}

void CityChrome::Impl::bindMap(const gl::Program& program, Drawing drawing,
                               const reflection::LocalMapSlot& slot, const glm::dvec3& eye,
                               const Surroundings& around) {
    if (drawing != Drawing::map && drawing != Drawing::parallax) return;
    const auto sizeClass = static_cast<std::size_t>(slot.sizeClass);
    glm::vec4 map(0, 0, 0, slot.layer);
    if (drawing == Drawing::parallax) {
        const auto layerAt = static_cast<std::size_t>(slot.layer);
        map = glm::vec4(glm::vec3(around.textures->centres[sizeClass][layerAt] - eye), map.w);
        glBindTextureUnit(4, around.textures->nearnessArrays[sizeClass]);
    }
    program.set("map", map);
    mapSampler.bind(2);
    glBindTextureUnit(2, around.textures->cubeArrays[sizeClass]);
}

void CityChrome::Impl::drawPiece(const Layer& l, const PieceMesh& mesh, const PassView& pass,
                                 const Surroundings& around) {
    const gl::Program& program = programs->parts[static_cast<std::size_t>(l.far)];
    glm::dmat4 relativeFromPart = l.worldFromPart;
    relativeFromPart[3] -= glm::dvec4(pass.eye, 0);
    program.set("clipFromPart", pass.clipFromRelative * glm::mat4(relativeFromPart));
    program.set("relativeFromPart", glm::mat4(relativeFromPart));
    program.set("share", l.share);
    program.use();
    bindMap(program, l.far, l.slot, pass.eye, around);
    glBindTextureUnit(5, layer->colour());
    mesh.array.bind();
    glDrawElements(GL_TRIANGLES, mesh.count, GL_UNSIGNED_INT, nullptr);
    glBindSampler(2, 0);
}

void CityChrome::Impl::drawThing(const Layer::Thing& thing, const glm::mat4& clipFromVirtual,
                                 const glm::mat3& worldFromPart, const glm::vec4& closeAround,
                                 const glm::dvec3& eye, const Surroundings& around) {
    const gl::Program& program = programs->things[static_cast<std::size_t>(thing.drawing)];
    glm::dmat4 relativeFromMesh = thing.worldFromMesh;
    relativeFromMesh[3] -= glm::dvec4(eye, 0);
    program.set("clipFromVirtual", clipFromVirtual);
    program.set("relativeFromMesh", glm::mat4(relativeFromMesh));
    program.set("closeAround", closeAround);
    program.use();
    if (thing.drawing != Drawing::solid && thing.drawing != Drawing::cutout) {
        program.set("worldFromReflector", worldFromPart);
        program.set("paint", thing.paint);
        program.set("bounced", thing.bounced ? 1 : 0);
        if (thing.bounced) {
            glBindTextureUnit(5, bodies->colour());
            glBindTextureUnit(6, bodies->depth());
        }
        bindMap(program, thing.drawing, thing.slot, eye, around);
    }
    thing.object->drawn->draw();
    glBindSampler(2, 0);
}

}  // namespace app
