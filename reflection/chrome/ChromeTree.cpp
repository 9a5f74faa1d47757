#include "reflection/chrome/ChromeTree.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <optional>
#include <queue>

namespace reflection {

namespace {

/// What a picture shows beside the points that were searched for, on each side, as a share of its width:
/// between 48 points of a ball's near half lies a tenth of it.
constexpr double margin = 0.1;
/// Half the widest picture, radians.
constexpr double widest = 1.2;
constexpr int fewestPoints = 3;

glm::dvec3 moved(const glm::dmat4& m, const glm::dvec3& p) {
    return glm::dvec3(m * glm::dvec4(p, 1));
}

/// An image in which parts are met.
struct Image {
    std::uint32_t node = ChromeNode::none;
    EyeView view;
    glm::ivec2 size{0};
    std::uint32_t level = 1;  ///< of what is met
};

/// A square view of a part's points from an eye.
struct Sight {
    EyeView view;
    double half = 0;      ///< radians
    double distance = 0;  ///< metres to the nearest point
};

std::optional<Sight> sightOf(const ChromeBody& body, std::uint32_t piece, const glm::dvec3& eye) {
    Sight s;
    s.distance = INFINITY;
    std::vector<glm::dvec3> directions;
    glm::dvec3 axis(0);
    for (const SurfacePoint& p : body.points[piece]) {
        const glm::dvec3 d = moved(body.worldFromPart, p.position) - eye;
        const double length = glm::length(d);
        if (!(length > 0)) return {};
        s.distance = std::min(s.distance, length);
        directions.push_back(d / length);
        axis += directions.back();
    }
    if (!(glm::length(axis) > 0)) return {};
    axis = glm::normalize(axis);
    for (const glm::dvec3& d : directions)
        s.half = std::max(s.half, std::acos(std::clamp(glm::dot(d, axis), -1.0, 1.0)));
    s.half *= 1 + margin;
    if (!(s.half < widest)) return {};
    s.half = std::max(s.half, 1e-4);
    s.view = perspectiveView(eye, eye + axis, 2 * s.half, 1, 0.25 * s.distance);
    return s;
}

/// Metres of a part's least bent stretch between neighbouring points: how it bends where it bends least.
double bendRadius(std::span<const SurfacePoint> points) {
    double radius = 0;
    for (const SurfacePoint& p : points) {
        const SurfacePoint* nearest = nullptr;
        double least = INFINITY;
        for (const SurfacePoint& q : points) {
            const double d = glm::distance(p.position, q.position);
            // What faces another way is the other side of an edge.
            if (&p == &q || !(d < least) || !(glm::dot(p.normal, q.normal) > 0.5)) continue;
            least = d;
            nearest = &q;
        }
        if (nearest == nullptr) continue;
        radius = std::max(radius, least / std::max(glm::distance(p.normal, nearest->normal), 1e-6));
    }
    return radius > 0 ? radius : INFINITY;
}

struct Waiting {
    ChromeNode node;
    std::uint64_t sequence = 0;
    bool operator<(const Waiting& b) const {
        return node.pixels != b.node.pixels ? node.pixels < b.node.pixels : sequence > b.sequence;
    }
};

/// Strays are bounded for points that are seen at this cosine or more: on a ball, within seven eighths of its
/// width. Beyond it, an image bends across the plane of incidence as little as in a plane.
constexpr double leastCosine = 0.5;

/// Metres by which what a part mirrors is off on its surface, for each radian and metre from the eye; see
/// ChromeNode::middle. What it mirrors is taken to be no nearer than the part's bend, or the eye.
double strayOf(double distance, double bend) {
    const double own = 1 / distance + 2 * leastCosine / bend, nearest = 1 / std::min(bend, distance),
                 middle = 0.5 * nearest;
    return std::max(1 / own - 1 / (own + middle), 1 / (own + middle) - 1 / (own + nearest)) / distance;
}

class Builder {
  public:
    Builder(std::span<const ChromeBody> bodies, const ChromeTreeOptions& options, ChromeTree& tree)
        : bodies_(bodies), options_(options), tree_(tree) {
        for (const ChromeBody& b : bodies) {
            std::vector<double>& bends = bends_.emplace_back();
            for (const std::vector<SurfacePoint>& points : b.points) bends.push_back(bendRadius(points));
        }
    }

    void meet(const Image& image, std::uint32_t in, std::uint32_t piece);
    void grow();

  private:
    void meetIn(const Image& image, std::uint32_t in, std::uint32_t piece, std::uint32_t of,
                std::uint32_t ofPiece);
    double across(const Image& image, const std::vector<glm::dvec3>& places) const;
    ChromeLook look(ChromeNode& node, const BounceEye& bounce, double pixels,
                    const std::vector<SurfacePoint>& points, double bend) const;
    void add(ChromeNode node);
    void put(ChromeNode node);
    bool slice(const Image& image, const ChromeNode& like, const ReflectorMap& map, const glm::dvec3& eye,
               const std::vector<SurfacePoint>& points, const glm::dmat4& worldFromIn, double bend);

    std::span<const ChromeBody> bodies_;
    const ChromeTreeOptions& options_;
    ChromeTree& tree_;
    std::vector<std::vector<double>> bends_;  ///< of each body's pieces
    std::priority_queue<Waiting> waiting_;
    std::uint64_t sequence_ = 0;
};

/// Pixels that places cover in an image, across; 0 where all lie outside on one side, or behind.
double Builder::across(const Image& image, const std::vector<glm::dvec3>& places) const {
    glm::dvec2 low(INFINITY), high(-INFINITY);
    for (const glm::dvec3& p : places) {
        const glm::dvec4 clip = image.view.clip(p);
        if (!(clip.w > 0)) continue;
        const glm::dvec2 at = glm::dvec2(clip) / clip.w;
        low = glm::min(low, at);
        high = glm::max(high, at);
    }
    if (!(low.x <= high.x)) return 0;
    const glm::dvec2 around = margin * (high - low);
    if (low.x - around.x > 1 || low.y - around.y > 1 || high.x + around.x < -1 || high.y + around.y < -1)
        return 0;
    const glm::dvec2 pixels = 0.5 * (high - low) * glm::dvec2(image.size);
    return std::max(pixels.x, pixels.y);
}

/// Eye, view and error of a node by what is seen of it.
ChromeLook Builder::look(ChromeNode& node, const BounceEye& bounce, double pixels,
                         const std::vector<SurfacePoint>& points, double bend) const {
    const ChromeBody& in = bodies_[node.in];
    node.eye = moved(in.worldFromPart, bounce.eye);
    node.pixels = pixels;
    if (bounce.stray > 1.5) return ChromeLook::tooBent;
    const std::optional<Sight> sight = sightOf(bodies_[node.of], node.ofPiece, node.eye);
    if (!sight) return ChromeLook::tooNear;
    node.view = sight->view;
    // What the seen points span from the eye covers `pixels`.
    double span = 0;
    const glm::dvec3 first = glm::normalize(points[bounce.seen.front()].position - bounce.eye);
    for (const std::size_t k : bounce.seen)
        span = std::max(span, glm::length(glm::normalize(points[k].position - bounce.eye) - first));
    const double perRadian = pixels / std::max(span, 1e-9);
    const double perRadianOff = perRadian * strayOf(sight->distance, bend);
    node.stray = bounce.stray * perRadianOff;
    node.shift = perRadianOff / sight->distance;
    const double texels = 2 * sight->half * perRadian * options_.texelsPerPixel;
    const int side = std::clamp(static_cast<int>(std::ceil(texels)), 8, options_.mostTexels);
    node.size = {side, side};
    node.middle = 2 * std::min(bend, sight->distance);
    return node.stray > options_.mostStray ? ChromeLook::tooBent : ChromeLook::picture;
}

void Builder::add(ChromeNode node) {
    if (node.look == ChromeLook::picture)
        waiting_.push({node, sequence_++});
    else
        put(std::move(node));
}

void Builder::put(ChromeNode node) {
    ChromeTreeCounters& c = tree_.counters;
    switch (node.look) {
        case ChromeLook::picture:
            ++c.pictures;
            c.texels += static_cast<std::uint64_t>(node.size.x) * static_cast<std::uint64_t>(node.size.y);
            c.deepest = std::max(c.deepest, node.level + 1);
            break;
        case ChromeLook::tooDeep:
            ++c.tooDeep;
            break;
        case ChromeLook::tooSmall:
            ++c.tooSmall;
            break;
        case ChromeLook::tooNear:
            ++c.tooNear;
            break;
        case ChromeLook::tooBent:
            ++c.tooBent;
            break;
        case ChromeLook::overCap:
            ++c.overCap;
            break;
        case ChromeLook::unmapped:
            ++c.unmapped;
            break;
    }
    if (node.look != ChromeLook::picture) node.size = {0, 0};
    tree_.nodes.push_back(std::move(node));
}

/// Takes the most visible first; what is met in a picture is no larger than on the caller's screen.
void Builder::grow() {
    while (!waiting_.empty()) {
        ChromeNode node = waiting_.top().node;
        waiting_.pop();
        if (tree_.counters.pictures >= options_.mostPictures) node.look = ChromeLook::overCap;
        const auto number = static_cast<std::uint32_t>(tree_.nodes.size());
        put(node);
        const bool last = static_cast<int>(node.level) + 1 >= options_.depth;
        if (node.look == ChromeLook::picture && (options_.pastDepth || !last))
            meet({number, node.view, node.size, node.level + 1}, node.of, node.ofPiece);
    }
}

/// Slices along the part's longest extent among the seen points; false where no number of them is enough.
bool Builder::slice(const Image& image, const ChromeNode& like, const ReflectorMap& map,
                    const glm::dvec3& eye, const std::vector<SurfacePoint>& points,
                    const glm::dmat4& worldFromIn, double bend) {
    // The farthest two points say which way it is long.
    glm::dvec3 axis(0);
    for (const SurfacePoint& a : points)
        for (const SurfacePoint& b : points)
            if (glm::distance(a.position, b.position) > glm::length(axis)) axis = b.position - a.position;
    if (!(glm::length(axis) > 0)) return false;
    axis = glm::normalize(axis);
    double low = INFINITY, high = -INFINITY;
    for (const SurfacePoint& p : points) {
        low = std::min(low, glm::dot(axis, p.position));
        high = std::max(high, glm::dot(axis, p.position));
    }
    for (int slices = 2; slices <= options_.mostSlices; slices *= 2) {
        std::vector<ChromeNode> made;
        bool good = true;
        for (int s = 0; s < slices && good; ++s) {
            const double from = low + (high - low) * s / slices, to = low + (high - low) * (s + 1) / slices;
            std::vector<SurfacePoint> inside;
            for (const SurfacePoint& p : points) {
                const double at = glm::dot(axis, p.position);
                if (at >= from - 1e-9 && at <= to + 1e-9) inside.push_back(p);
            }
            const BounceEye bounce = bounceEye(map, eye, inside, options_.search);
            tree_.counters.searched += static_cast<std::uint32_t>(inside.size());
            if (bounce.seen.empty()) continue;
            if (bounce.seen.size() < fewestPoints) return false;
            std::vector<glm::dvec3> places;
            for (const glm::dvec3& p : bounce.at) places.push_back(moved(worldFromIn, p));
            ChromeNode node = like;
            node.look = look(node, bounce, std::max(across(image, places), 1.0), inside, bend);
            good = node.look == ChromeLook::picture;
            node.axis = glm::dmat3(worldFromIn) * axis;
            const double shift = glm::dot(node.axis, glm::dvec3(worldFromIn[3]));
            node.low = s == 0 ? -1e300 : from + shift;
            node.high = s + 1 == slices ? 1e300 : to + shift;
            made.push_back(node);
        }
        if (!good || made.empty()) continue;
        for (ChromeNode& node : made) add(node);
        return true;
    }
    return false;
}

void Builder::meetIn(const Image& image, std::uint32_t in, std::uint32_t piece, std::uint32_t of,
                     std::uint32_t ofPiece) {
    const ChromeBody &a = bodies_[in], &b = bodies_[of];
    const ReflectorMap& map = a.reflector->pieces[piece].built.map;
    ++tree_.counters.pairs;
    const glm::dmat4 inFromWorld = glm::inverse(a.worldFromPart), inFromOf = inFromWorld * b.worldFromPart;
    std::vector<SurfacePoint> points;
    points.reserve(b.points[ofPiece].size());
    for (const SurfacePoint& p : b.points[ofPiece])
        points.push_back({moved(inFromOf, p.position), glm::dmat3(inFromOf) * p.normal});
    const glm::dvec3 eye = moved(inFromWorld, image.view.eye);
    const BounceEye bounce = bounceEye(map, eye, points, options_.search);
    tree_.counters.searched += static_cast<std::uint32_t>(points.size());
    std::vector<glm::dvec3> places;
    for (const glm::dvec3& p : bounce.at) places.push_back(moved(a.worldFromPart, p));
    const double pixels = across(image, places);
    if (!(pixels > 0)) {
        ++tree_.counters.unseen;
        return;
    }
    ChromeNode node;
    node.parent = image.node;
    node.level = image.level;
    node.in = in;
    node.piece = piece;
    node.of = of;
    node.ofPiece = ofPiece;
    const double bend = bends_[of][ofPiece];
    node.look = look(node, bounce, pixels, points, bend);
    const bool deep = static_cast<int>(image.level) >= options_.depth;
    if (b.reflector->pieces[ofPiece].built.map.empty()) {
        node.look = ChromeLook::unmapped;
    } else if (deep || pixels < options_.leastPixels) {
        node.look = deep ? ChromeLook::tooDeep : ChromeLook::tooSmall;
    } else if (node.look == ChromeLook::tooBent &&
               slice(image, node, map, eye, points, a.worldFromPart, bend)) {
        return;
    }
    add(node);
}

void Builder::meet(const Image& image, std::uint32_t in, std::uint32_t piece) {
    const ChromeBody& a = bodies_[in];
    if (a.reflector->pieces[piece].built.map.empty()) return;
    for (std::uint32_t of = 0; of < bodies_.size(); ++of) {
        const ChromeBody& b = bodies_[of];
        if (of == in || b.reflector == nullptr || !(glm::distance(a.centre, b.centre) - b.radius < a.reach))
            continue;
        for (std::uint32_t k = 0; k < b.points.size(); ++k)
            if (!b.points[k].empty()) meetIn(image, in, piece, of, k);
    }
}

}  // namespace

ChromeTree chromeTree(const EyeView& view, const glm::ivec2& size, std::span<const ChromeBody> bodies,
                      const ChromeTreeOptions& options) {
    ChromeTree tree;
    bool sound = options.depth >= 1 && options.depth <= 8 && options.mostSlices >= 1 &&
                 options.texelsPerPixel > 0 && options.texelsPerPixel <= 8 && options.mostTexels >= 8 &&
                 options.mostTexels <= 8192 && options.mostStray > 0 && size.x > 0 && size.y > 0;
    for (const ChromeBody& b : bodies)
        sound = sound && (b.reflector == nullptr || b.points.size() == b.reflector->pieces.size());
    if (!sound) {
        tree.status = ChromeTreeStatus::badSettings;
        return tree;
    }
    if (options.depth == 1) return tree;
    Builder builder(bodies, options, tree);
    for (std::uint32_t b = 0; b < bodies.size(); ++b) {
        if (!bodies[b].inView || bodies[b].reflector == nullptr) continue;
        for (std::uint32_t piece = 0; piece < bodies[b].points.size(); ++piece)
            builder.meet({ChromeNode::none, view, size, 1}, b, piece);
    }
    builder.grow();
    return tree;
}

}  // namespace reflection
