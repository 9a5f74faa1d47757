#include "reflection/planar/TreeBuilder.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "reflection/planar/Gloss.h"
#include "reflection/planar/MirrorView.h"

namespace reflection {

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr std::size_t mostNodes = std::size_t{1} << 20;
/// Side of a view-dependent map for a pixel of its reflector's diameter. In the middle of a ball a pixel
/// turns the reflection by 4 / diameter, which are 0.7 texels for each of these at 70 degrees to all sides:
/// three texels a pixel, so that what is looked up does not change with the map's size (measured: 2 leave 41
/// dB, 4 over 50).
constexpr double sphereTexels = 4;

float strongest(const glm::vec3& c) {
    return std::max({c.x, c.y, c.z});
}

double area(const glm::ivec2& size) {
    return static_cast<double>(size.x) * size.y;
}

/// Of a ball's image, in units of ndc, whole image 4: exact for a ball before the eye, though the image's
/// edges may cut it; the whole image for one that the eye's plane cuts. Its silhouette is an ellipse: see
/// Mara & McGuire, 2D polyhedral bounds of a clipped, perspective-projected 3D sphere (2013).
double projectedArea(const CurvedReflector& ball, const EyeView& view) {
    const glm::dvec3 centre = view.viewFromWorld * (ball.centre - view.eye);
    const double r2 = ball.radius * ball.radius, beyond = centre.z * centre.z - r2;
    if (!(centre.z < 0 && beyond > 0)) return 4;
    const double flat = pi * r2 * std::sqrt((glm::dot(centre, centre) - r2) / beyond) / beyond;
    return std::min(4.0, flat * view.clipFromView[0][0] * view.clipFromView[1][1]);
}

/// Whether one convex box hides all corners, and so all between them: no corner's line of sight, from the
/// glass on, misses it. `relative`: the polygon around the eye.
bool hides(const city::Aabb& box, const glm::dvec3& eye, const HalfSpace* glass,
           const std::vector<glm::dvec3>& relative) {
    const glm::dvec3 low = glm::dvec3(box.min) - eye, high = glm::dvec3(box.max) - eye;
    if (glass != nullptr) {
        // The whole box must lie in front of the glass: what is behind it is clipped.
        const glm::dvec3 n(*glass), middle = 0.5 * (low + high), half = 0.5 * (high - low);
        if (glm::dot(n, middle) + glass->w < glm::dot(glm::abs(n), half)) return false;
    }
    for (const glm::dvec3& p : relative) {
        // The box must be met strictly before the corner, by a ten thousandth of the way, lest a mirror on a
        // wall be hidden by the wall.
        double enter = 0, leave = 1 - 1e-4;
        for (int i = 0; i < 3; ++i) {
            if (p[i] == 0) {
                if (low[i] > 0 || high[i] < 0) return false;
                continue;
            }
            double a = low[i] / p[i], b = high[i] / p[i];
            if (a > b) std::swap(a, b);
            enter = std::max(enter, a);
            leave = std::min(leave, b);
        }
        if (!(enter < leave)) return false;
    }
    return !relative.empty();
}

}  // namespace

TreeBuilder::TreeBuilder(const ReflectionScene& scene, const TreeSettings& settings, ReflectionTree& tree)
    : scene_(scene), settings_(settings), tree_(tree) {}

glm::ivec2 TreeBuilder::gridOf(const ReflectionRoot& root) const {
    if (settings_.mapSize.x <= 0 || settings_.mapSize.y <= 0) return root.size;
    if (!settings_.economies.resolution) return settings_.mapSize;
    const glm::ivec2 most(glm::ceil(glm::dvec2(root.size) * settings_.texelsPerPixel));
    return glm::min(settings_.mapSize, most);
}

bool TreeBuilder::dark(const glm::vec3& throughput) const {
    return settings_.economies.cutOff && strongest(throughput) < settings_.cutOff;
}

bool TreeBuilder::shows(const CurvedReflector& c, const EyeView& view, const HalfSpaces& frustum) const {
    return !settings_.economies.offScreen || touches(frustum, c.centre - view.eye, c.radius);
}

void TreeBuilder::listObjects(const EyeView& view, const HalfSpaces& frustum, std::uint32_t& first,
                              std::uint32_t& count) {
    const auto total = static_cast<std::uint32_t>(scene_.objects.size());
    if (!settings_.economies.offScreen) {
        // Every image shows everything: one list serves all.
        if (!allObjectsListed_) {
            tree_.objects.resize(total);
            std::iota(tree_.objects.begin(), tree_.objects.end(), 0u);
            allObjectsListed_ = true;
        }
        first = 0;
        count = total;
    } else {
        first = static_cast<std::uint32_t>(tree_.objects.size());
        for (std::uint32_t i = 0; i < total; ++i) {
            const glm::dvec3 low(scene_.objects[i].min), high(scene_.objects[i].max);
            if (touches(frustum, 0.5 * (low + high) - view.eye, 0.5 * (high - low)))
                tree_.objects.push_back(i);
        }
        count = static_cast<std::uint32_t>(tree_.objects.size()) - first;
    }
    tree_.counters.objects += count;
    tree_.counters.objectsCulled += total - count;
}

void TreeBuilder::addView(const TreeView& given) {
    const auto index = static_cast<std::uint32_t>(tree_.roots.size());
    ReflectionRoot& root = tree_.roots.emplace_back();
    root.view = given.view;
    root.size = given.size;
    if (settings_.economies.offScreen) root.frustum = frustumOf(given.view);
    listObjects(root.view, root.frustum, root.firstObject, root.objectCount);
    Image image;
    image.root = index;
    image.view = &root.view;
    image.frustum = &root.frustum;
    image.pixels = area(given.size);
    image.pixelsPerNdc = image.pixels / 4;
    image.grid = gridOf(root);
    meet(image);
}

void TreeBuilder::addEnvironments() {
    const bool cube = settings_.curved == CurvedMaps::cube;
    if (settings_.depth == 0 || !settings_.refreshCurved ||
        (!cube && settings_.curved != CurvedMaps::dualParaboloid))
        return;
    const std::uint32_t faces = cube ? 6 : 2;
    std::vector<bool> made(scene_.curved.size(), false);
    // `meet` keeps pointers into the roots while it runs, not beyond; the vector may grow between calls.
    for (std::uint32_t c = 0; c < scene_.curved.size(); ++c) {
        const CurvedReflector& reflector = scene_.curved[c];
        bool needed = false;
        for (const ReflectionRoot& r : tree_.roots)
            needed = needed || (!r.isEnvironment() && shows(reflector, r.view, r.frustum));
        for (const ReflectionNode& n : tree_.nodes)
            needed = needed || (!tree_.roots[n.root].isEnvironment() && shows(reflector, n.view, n.frustum));
        if (!needed || dark(reflector.surface.reflectance)) {
            ++tree_.counters.environmentsUnseen;
            continue;
        }
        EnvironmentJob& job = tree_.environments.emplace_back();
        job.curved = c;
        job.firstRoot = static_cast<std::uint32_t>(tree_.roots.size());
        job.rootCount = faces;
        for (std::size_t o = 0; o < scene_.curved.size(); ++o)
            job.others.push_back(made[o]                   ? MapAge::thisFrame
                                 : scene_.curved[o].hasMap ? MapAge::lastFrame
                                                           : MapAge::none);
        made[c] = true;
        for (std::uint32_t f = 0; f < faces; ++f) {
            const auto index = static_cast<std::uint32_t>(tree_.roots.size());
            ReflectionRoot& root = tree_.roots.emplace_back();
            // Nothing of the scene lies inside the reflector; a fiftieth of it leaves room for what touches
            // it.
            const double near = 0.02 * reflector.radius;
            root.view = cube ? cubeFaceView(reflector.centre, static_cast<int>(f), near)
                             : paraboloidView(reflector.centre, static_cast<int>(f), near);
            root.size = glm::ivec2(settings_.faceSize);
            if (settings_.economies.offScreen) root.frustum = frustumOf(root.view);
            root.curved = c;
            root.face = f;
            listObjects(root.view, root.frustum, root.firstObject, root.objectCount);
            Image image;
            image.root = index;
            image.view = &root.view;
            image.frustum = &root.frustum;
            image.level = 1;
            image.throughput = reflector.surface.reflectance;
            image.pixels = area(root.size);
            image.pixelsPerNdc = image.pixels / 4;
            image.inCurved = true;
            image.grid = gridOf(root);
            image.coarser = settings_.economies.detail ? 1 : 0;
            meet(image);
            ++tree_.counters.faces;
        }
    }
}

void TreeBuilder::meet(const Image& image) {
    if (image.level >= static_cast<std::uint32_t>(settings_.depth)) return;
    meetMirrors(image);
    if (settings_.curved == CurvedMaps::viewDependent) meetCurved(image);
}

bool TreeBuilder::occluded(const Image& image, const Portal& portal, const Mirror& mirror) const {
    if (!settings_.economies.occlusion) return false;
    for (const city::Aabb& box : scene_.occluders)
        if (hides(box, image.view->eye, image.glass, portal.polygon)) return true;
    return scene_.hidden && scene_.hidden(*image.view, image.glass, mirror);
}

bool TreeBuilder::see(const Image& image, std::uint32_t index, Seen& seen) {
    const Mirror& mirror = scene_.mirrors[index];
    TreeCounters& counters = tree_.counters;
    const Economies& economies = settings_.economies;
    const MirrorView mirrored = mirrorView(*image.view, mirror.plane);
    if (mirrored.status == MirrorViewStatus::eyeInPlane || mirrored.status == MirrorViewStatus::notFinite ||
        (mirrored.status == MirrorViewStatus::eyeBehind && economies.backFacing)) {
        ++counters.backFacing;
        return false;
    }
    if (economies.offScreen) {
        seen.portal = portalThrough(*image.view, *image.frustum, mirror.plane);
    } else {
        // Nothing is left out, but a projection needs a polygon before the eye.
        HalfSpaces own = frustumOf(*image.view);
        if (image.glass != nullptr) own.push_back(*image.glass);
        seen.portal = portalThrough(*image.view, own, mirror.plane);
    }
    const bool visible = seen.portal.status == PortalStatus::ok &&
                         seen.portal.area * image.pixelsPerNdc >= settings_.leastPixels;
    if (!visible && economies.offScreen) {
        ++counters.offScreen;
        return false;
    }
    if (seen.portal.status != PortalStatus::ok) seen.portal.bounds = NdcRect{};
    if (occluded(image, seen.portal, mirror)) {
        ++counters.occluded;
        return false;
    }
    if (dark(image.throughput * mirror.plane.surface().reflectance)) {
        ++counters.belowCutOff;
        return false;
    }
    seen.mirrored = mirrored.view;
    seen.mirrors = {index};
    seen.group = economies.share ? mirror.group : Mirror::alone;
    return true;
}

void TreeBuilder::meetMirrors(const Image& image) {
    std::vector<Seen> all;
    for (std::uint32_t m = 0; m < scene_.mirrors.size(); ++m) {
        Seen seen;
        if (!see(image, m, seen)) continue;
        const auto companion = std::find_if(all.begin(), all.end(), [&](const Seen& s) {
            return seen.group != Mirror::alone && s.group == seen.group;
        });
        if (companion == all.end()) {
            all.push_back(std::move(seen));
            continue;
        }
        ++tree_.counters.shared;
        companion->mirrors.push_back(m);
        companion->portal.bounds.low = glm::min(companion->portal.bounds.low, seen.portal.bounds.low);
        companion->portal.bounds.high = glm::max(companion->portal.bounds.high, seen.portal.bounds.high);
        companion->portal.area += seen.portal.area;
    }
    for (Seen& seen : all) addMirror(image, seen);
}

void TreeBuilder::addMirror(const Image& image, Seen& seen) {
    const Economies& economies = settings_.economies;
    const bool perspective = image.view->projection == Projection::perspective;
    const MirrorPlane& plane = scene_.mirrors[seen.mirrors.front()].plane;
    Candidate candidate;
    ReflectionNode& node = candidate.node;
    node.root = image.root;
    node.parent = image.node;
    node.level = image.level;
    node.view = seen.mirrored;
    node.glass = HalfSpace(plane.normal(), plane.signedDistance(seen.mirrored.eye));
    node.pixels = std::min(seen.portal.area * image.pixelsPerNdc, image.pixels);
    node.coarser = economies.detail ? image.coarser + 1 : 0;
    glm::vec3 reflectance(0);
    double roughness = 0, stray = 0, own = 0;
    for (std::uint32_t m : seen.mirrors) {
        stray = std::max(stray, scene_.mirrors[m].reach);
        own = std::max(own, std::clamp(scene_.mirrors[m].texels, 1e-3, 1.0));
        reflectance = glm::max(reflectance, scene_.mirrors[m].plane.surface().reflectance);
        roughness = std::max(roughness, static_cast<double>(scene_.mirrors[m].plane.surface().roughness));
    }
    if (economies.resolution && image.inCurved && perspective && roughness > 0) {
        // Seen in a curved mirror, where nobody looks for what is sharp at its foot: texels as wide as its
        // spread.
        const double pixel = 2 / std::max(image.grid.x * node.view.clipFromView[0][0],
                                          image.grid.y * node.view.clipFromView[1][1]);
        own = std::min(own, pixel / glossAngle(roughness));
    }
    node.throughput = image.throughput * reflectance;
    node.roughness = static_cast<float>(roughness);
    node.bounds = seen.portal.bounds;
    // A rough mirror's filter reaches beyond its edge, by some three standard deviations; a map whose texels
    // are not the picture's pixels is interpolated, a texel beyond.
    NdcRect seenThrough = seen.portal.bounds;
    const bool texelsArePixels =
        image.grid == tree_.roots[image.root].size && settings_.levelScale >= 1 && own >= 1;
    const double scale = std::pow(settings_.levelScale, image.level) * own;
    const bool larger = perspective && (roughness > 0 || stray > 0 || !texelsArePixels);
    if (larger) {
        const double reach = 3 * glossAngle(roughness) + stray;
        const double texels = texelsArePixels ? 0 : 3 / scale;
        const glm::dvec2 margin =
            reach * glm::dvec2(node.view.clipFromView[0][0], node.view.clipFromView[1][1]) +
            texels / glm::dvec2(image.grid);
        seenThrough.low = glm::max(seenThrough.low - margin, glm::dvec2(-1));
        seenThrough.high = glm::min(seenThrough.high + margin, glm::dvec2(1));
    }
    const PixelRect whole{glm::ivec2(0), image.grid};
    const PixelRect rect = pixelsOf(seenThrough, image.grid);
    if (economies.narrow && perspective) {
        if (seen.mirrors.size() == 1 && !larger && seen.portal.status == PortalStatus::ok) {
            node.frustum = frustumThrough(seen.portal, node.view, plane);
        } else {
            node.frustum = frustumOf(node.view, seenThrough);
            node.frustum.back() = node.glass;
        }
    } else if (economies.offScreen && perspective) {
        node.frustum = frustumOf(node.view);
        node.frustum.back() = node.glass;
    } else if (economies.offScreen) {
        node.frustum = {node.glass};
    }
    if (economies.resolution && perspective) {
        node.crop = ndcOf(rect, image.grid);
        node.resolution = glm::max(glm::ivec2(glm::ceil(glm::dvec2(rect.size()) * scale)), glm::ivec2(1));
        node.scissor = {glm::ivec2(0), node.resolution};
    } else {
        node.resolution = image.grid;
        node.scissor = economies.scissor && perspective ? rect : whole;
    }
    node.clipFromView = perspective ? cropped(node.view.clipFromView, node.crop) : node.view.clipFromView;
    node.obliqueClipFromView = node.clipFromView;
    if (perspective) {
        EyeView drawn = node.view;
        drawn.clipFromView = node.clipFromView;
        node.obliqueClipFromView = obliqueNear(drawn, plane).clipFromView;
    }
    candidate.mirrors = std::move(seen.mirrors);
    candidate.inner = {image.grid, image.pixelsPerNdc, image.inCurved};
    push(std::move(candidate));
}

void TreeBuilder::meetCurved(const Image& image) {
    const bool given = settings_.mapSize.x > 0 && settings_.mapSize.y > 0;
    const glm::ivec2 whole = given ? settings_.mapSize : glm::ivec2(2 * settings_.faceSize);
    for (std::uint32_t c = 0; c < scene_.curved.size(); ++c) {
        if (c == image.hiddenCurved) continue;
        const CurvedReflector& reflector = scene_.curved[c];
        if (!shows(reflector, *image.view, *image.frustum)) {
            ++tree_.counters.offScreen;
            continue;
        }
        const glm::vec3 throughput = image.throughput * reflector.surface.reflectance;
        if (dark(throughput)) {
            ++tree_.counters.belowCutOff;
            continue;
        }
        Candidate candidate;
        ReflectionNode& node = candidate.node;
        node.root = image.root;
        node.parent = image.node;
        node.level = image.level;
        node.curved = node.hiddenCurved = c;
        node.throughput = throughput;
        node.roughness = reflector.surface.roughness;
        node.coarser = settings_.economies.detail ? image.coarser + 1 : 0;
        // Inside the ball the target is its centre: perspectiveView then looks along its default axis.
        node.view = perspectiveView(reflector.centre, image.view->eye, 2 * settings_.curvedHalfAngle, 1,
                                    0.02 * reflector.radius);
        if (settings_.economies.offScreen) node.frustum = frustumOf(node.view);
        const double ball = projectedArea(reflector, *image.view) * image.pixelsPerNdc;
        node.pixels = std::min(ball, image.pixels);
        node.resolution = whole;
        if (settings_.economies.resolution) {
            // Of the whole ball, though a mirror may show a part of it.
            const double diameter = std::sqrt(ball * 4 / pi) * std::pow(settings_.levelScale, image.level);
            const int side = std::max(8, static_cast<int>(std::ceil(sphereTexels * diameter)));
            node.resolution = glm::min(node.resolution, glm::ivec2(side));
        }
        node.scissor = {glm::ivec2(0), node.resolution};
        node.clipFromView = node.obliqueClipFromView = node.view.clipFromView;
        candidate.inner = {node.resolution, ball / 4, true};
        push(std::move(candidate));
    }
}

void TreeBuilder::push(Candidate&& candidate) {
    if (settings_.economies.cutOff &&
        candidate.node.pixels * strongest(candidate.node.throughput) < settings_.leastLight) {
        ++tree_.counters.belowCutOff;
        return;
    }
    candidate.sequence = sequence_++;
    // Without a cap the order of taking does not matter; first come first served keeps the queue short.
    candidate.priority =
        settings_.economies.cap ? candidate.node.pixels * strongest(candidate.node.throughput) : 0;
    waiting_.push(std::move(candidate));
}

void TreeBuilder::grow() {
    while (!waiting_.empty()) {
        if (settings_.economies.cap && tree_.nodes.size() >= settings_.mostMaps) {
            tree_.counters.overCap += static_cast<std::uint32_t>(waiting_.size());
            waiting_ = {};
            return;
        }
        if (tree_.nodes.size() >= mostNodes) {
            tree_.status = TreeStatus::tooMany;
            waiting_ = {};
            return;
        }
        Candidate candidate = waiting_.top();
        waiting_.pop();
        take(std::move(candidate));
    }
}

void TreeBuilder::take(Candidate&& candidate) {
    const auto index = static_cast<std::uint32_t>(tree_.nodes.size());
    ReflectionNode& node = tree_.nodes.emplace_back(std::move(candidate.node));
    node.firstMirror = static_cast<std::uint32_t>(tree_.mirrors.size());
    node.mirrorCount = static_cast<std::uint32_t>(candidate.mirrors.size());
    tree_.mirrors.insert(tree_.mirrors.end(), candidate.mirrors.begin(), candidate.mirrors.end());
    listObjects(node.view, node.frustum, node.firstObject, node.objectCount);

    Image image;
    image.root = node.root;
    image.node = index;
    image.view = &node.view;
    image.frustum = &node.frustum;
    image.level = node.level + 1;
    image.throughput = node.throughput;
    image.pixels = node.pixels;
    image.hiddenCurved = node.hiddenCurved;
    image.coarser = node.coarser;
    image.grid = candidate.inner.grid;
    image.pixelsPerNdc = candidate.inner.pixelsPerNdc;
    image.inCurved = candidate.inner.inCurved;
    if (node.planar()) image.glass = &node.glass;
    meet(image);
}

void TreeBuilder::finish() {
    std::vector<std::vector<std::uint32_t>> ofRoot(tree_.roots.size()), ofNode(tree_.nodes.size());
    for (std::uint32_t n = 0; n < tree_.nodes.size(); ++n) {
        const ReflectionNode& node = tree_.nodes[n];
        (node.parent == ReflectionNode::none ? ofRoot[node.root] : ofNode[node.parent]).push_back(n);
    }
    const auto before = [&](std::uint32_t a, std::uint32_t b) {
        const ReflectionNode &x = tree_.nodes[a], &y = tree_.nodes[b];
        if (x.planar() != y.planar()) return x.planar();
        return x.planar() ? tree_.mirrors[x.firstMirror] < tree_.mirrors[y.firstMirror] : x.curved < y.curved;
    };
    std::vector<std::uint32_t> order, stack, newIndex(tree_.nodes.size());
    for (auto& list : ofRoot) std::sort(list.begin(), list.end(), before);
    for (auto& list : ofNode) std::sort(list.begin(), list.end(), before);
    for (const auto& list : ofRoot) {
        stack.assign(list.rbegin(), list.rend());
        while (!stack.empty()) {
            const std::uint32_t n = stack.back();
            stack.pop_back();
            newIndex[n] = static_cast<std::uint32_t>(order.size());
            order.push_back(n);
            stack.insert(stack.end(), ofNode[n].rbegin(), ofNode[n].rend());
        }
    }
    std::vector<ReflectionNode> nodes;
    nodes.reserve(order.size());
    TreeCounters& counters = tree_.counters;
    for (std::uint32_t n : order) {
        ReflectionNode& node = nodes.emplace_back(std::move(tree_.nodes[n]));
        if (node.parent != ReflectionNode::none) node.parent = newIndex[node.parent];
        const bool environment = tree_.roots[node.root].isEnvironment();
        (node.planar() ? counters.planar : counters.viewDependent) += 1;
        if (node.planar() && environment) ++counters.planarInEnvironments;
        counters.texels += static_cast<std::uint64_t>(node.scissor.area());
        if (node.level >= tree_.levelSize.size()) tree_.levelSize.resize(node.level + 1, glm::ivec2(0));
        tree_.levelSize[node.level] = glm::max(tree_.levelSize[node.level], node.resolution);
    }
    tree_.nodes = std::move(nodes);
    for (const ReflectionRoot& r : tree_.roots)
        if (r.isEnvironment())
            counters.texels += static_cast<std::uint64_t>(r.size.x) * static_cast<std::uint64_t>(r.size.y);
    counters.deepest = static_cast<std::uint32_t>(tree_.levelSize.size());
}

}  // namespace reflection
