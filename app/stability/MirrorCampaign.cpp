// Flat mirrors: eyes in the glass, a micrometre before it and behind it, polygons of no area, mirrors that
// face each other exactly, magnitudes from a millimetre to a thousand kilometres.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "app/stability/SeededRandom.h"
#include "app/stability/Stability.h"
#include "reflection/planar/MirrorView.h"
#include "reflection/planar/Portal.h"
#include "reflection/planar/ReflectionTree.h"

namespace app::stability {

namespace {

using namespace reflection;

glm::dvec3 direction(SeededRandom& random) {
    const double z = random.between(-1, 1), a = random.between(0, 6.283185307179586),
                 r = std::sqrt(1 - z * z);
    return {r * std::cos(a), r * std::sin(a), z};
}

std::vector<glm::dvec3> polygon(SeededRandom& random, const glm::dvec3& centre, const glm::dvec3& n,
                                double radius) {
    const glm::dvec3 u =
        glm::normalize(glm::cross(n, std::abs(n.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0)));
    const glm::dvec3 v = glm::cross(n, u);
    const int count = 3 + random.below(6);
    const double turn = random.between(0, 6.28), squeeze = random.magnitude(0.01, 1);
    std::vector<glm::dvec3> corners;
    for (int i = 0; i < count; ++i) {
        const double a = 6.283185307179586 * i / count + turn;
        corners.push_back(centre + radius * (std::cos(a) * u + squeeze * std::sin(a) * v));
    }
    return corners;
}

void fail(Row& row, const std::string& what) {
    ++row.failures;
    if (row.example.empty()) row.example = what;
}

/// Eye, point and mirror of every size, everywhere.
Row lawOfReflection(const Options& options, SeededRandom& random) {
    Row row{"mirrors",
            "law of reflection, 1e-3 to 1e6 m",
            0,
            0,
            0,
            1e-6,
            "sine or cosine",
            "coordinates of 1e6 m are rounded to 1e-10 m, the smallest height is 1e-3 m",
            ""};
    for (int i = 0; i < 20000 * options.effort() && !options.stop(); ++i) {
        const glm::dvec3 place = random.magnitude(1e-3, 1e6) * direction(random);
        const MirrorResult made =
            MirrorPlane::make(polygon(random, place, direction(random), random.magnitude(1e-3, 1e6)));
        ++row.tried;
        if (made.status != MirrorStatus::ok) {
            fail(row, "a polygon was refused: " + std::string(remedyOf(made.status)));
            continue;
        }
        const MirrorPlane& m = made.mirror;
        const auto before = [&] {
            const glm::dvec3 along = glm::normalize(glm::cross(m.normal(), direction(random)));
            return m.point() + random.magnitude(1e-3, 1e6) * m.normal() + random.magnitude(1e-3, 1e6) * along;
        };
        const glm::dvec3 eye = before(), p = before(), image = m.mirrored(p);
        const double he = m.signedDistance(eye), hp = m.signedDistance(p);
        const glm::dvec3 x = eye + he / (he + hp) * (image - eye);
        const glm::dvec3 in = glm::normalize(eye - x), out = glm::normalize(p - x);
        const double angle = std::abs(glm::dot(in, m.normal()) - glm::dot(out, m.normal()));
        const double plane = glm::length(glm::cross(in + out, m.normal()));
        row.worst = std::max({row.worst, angle, plane});
        if (!(angle <= row.bound && plane <= row.bound)) fail(row, "mirror " + std::to_string(i));
    }
    return row;
}

bool finite(const EyeView& v) {
    double sum = v.eye.x + v.eye.y + v.eye.z;
    for (int i = 0; i < 3; ++i) sum += v.viewFromWorld[i].x + v.viewFromWorld[i].y + v.viewFromWorld[i].z;
    return std::isfinite(sum);
}

/// Eyes in the plane, a hair from it and behind: a status, and nothing that is not a number.
Row degenerateEyes(const Options& options, SeededRandom& random) {
    Row row{"mirrors",
            "eyes in, at 1e-6 m of and behind the glass",
            0,
            0,
            0,
            0,
            "wrong statuses",
            "the side of a point is known beyond the rounding of its distance",
            ""};
    for (int i = 0; i < 5000 * options.effort() && !options.stop(); ++i) {
        const double size = random.magnitude(1e-3, 1e3);
        const MirrorResult made = MirrorPlane::make(
            polygon(random, random.magnitude(1e-3, 1e3) * direction(random), direction(random), size));
        const MirrorPlane& m = made.mirror;
        for (const double height : {0.0, 1e-6, -1e-6, 1e-300, -1e-300, 1.0, -1.0, 1e6, -1e6}) {
            const glm::dvec3 along = glm::cross(m.normal(), direction(random));
            const glm::dvec3 eye = m.point() + size * along + height * m.normal();
            const EyeView view = perspectiveView(eye, eye + direction(random), 1.2, 1.5, 1e-7);
            const MirrorView seen = mirrorView(view, m);
            ++row.tried;
            const MirrorViewStatus expected = std::abs(height) < 1e-9 ? MirrorViewStatus::eyeInPlane
                                              : height > 0            ? MirrorViewStatus::ok
                                                                      : MirrorViewStatus::eyeBehind;
            const Portal portal = portalThrough(view, frustumOf(view), m);
            const ObliqueNear oblique = obliqueNear(seen.view, m);
            double depth = 0;
            for (int c = 0; c < 4; ++c) depth += oblique.clipFromView[c][2];
            // In the plane, the sum of several roundings may still be told from nothing.
            const bool status =
                seen.status == expected || (expected == MirrorViewStatus::eyeInPlane &&
                                            std::abs(seen.distance) < 1e-11 * (1 + size + glm::length(eye)));
            if (!status || !finite(seen.view) || !std::isfinite(depth) || !std::isfinite(portal.area)) {
                char text[80];
                std::snprintf(text, sizeof text, "mirror %d, height %g, status %d", i, height,
                              static_cast<int>(seen.status));
                fail(row, text);
            }
        }
    }
    row.worst = static_cast<double>(row.failures);
    return row;
}

/// Polygons that are none: refused, never NaN.
Row degeneratePolygons(const Options& options, SeededRandom& random) {
    Row row{"mirrors",  "polygons that are none",
            0,          0,
            0,          0,
            "accepted", "MirrorPlane::make refuses with a status",
            ""};
    const double nan = std::numeric_limits<double>::quiet_NaN(),
                 inf = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 2000 * options.effort() && !options.stop(); ++i) {
        std::vector<glm::dvec3> c =
            polygon(random, random.magnitude(1e-3, 1e6) * direction(random), direction(random), 2);
        const int kind = i % 6;
        if (kind == 0) c.resize(2);
        if (kind == 1) c[1].y = random.oneIn(2) ? nan : inf;
        if (kind == 2)
            for (glm::dvec3& p : c) p = c[0];
        if (kind == 3)
            for (std::size_t k = 0; k < c.size(); ++k) c[k] = glm::dvec3(static_cast<double>(k), 0, 0);
        if (kind == 4) std::swap(c[0], c.size() > 3 ? c[1] : c[2]);
        if (kind == 5 && c.size() > 3) c[0] += glm::dvec3(1, 1, 1);
        if (kind >= 4 && c.size() == 3) continue;  // three corners are always flat and convex
        MirrorSurface surface;
        ++row.tried;
        const MirrorResult made = MirrorPlane::make(c, surface);
        // A corner moved within its plane leaves a mirror.
        if (made.status == MirrorStatus::ok && kind != 5) fail(row, "kind " + std::to_string(kind));
    }
    row.worst = static_cast<double>(row.failures);
    return row;
}

/// What a leaning near plane costs: metres that depth can just tell apart 140 m away, seen at 45 degrees from
/// so far before the glass. Clip distances leave depth as it is.
std::vector<Row> depthSteps(const Options& options) {
    const MirrorPlane m =
        MirrorPlane::make(std::vector<glm::dvec3>{{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}}).mirror;
    std::vector<Row> rows;
    for (const double height : {10.0, 1.0, 1e-2, 1e-6}) {
        if (options.stop()) break;
        char name[80];
        std::snprintf(name, sizeof name, "depth step at 140 m, eye %g m before the glass, oblique", height);
        Row oblique{"mirrors",        name, 1, 0, 0, std::numeric_limits<double>::infinity(), "m",
                    "for comparison", ""};
        std::snprintf(name, sizeof name, "depth step at 140 m, eye %g m before the glass, clip distance",
                      height);
        Row plain{"mirrors", name,         1,   0,
                  0,         1.2e-7 * 142, "m", "reversed depth: a step of 2^-23 of any distance",
                  ""};
        const MirrorView v = mirrorView(perspectiveView({0, -height, 0}, {3, 3 - height, 0}, 1, 1), m);
        EyeView drawn = v.view;
        plain.worst = depthStep(drawn.clipFromRelative(), {100, -100, 0});
        drawn.clipFromView = obliqueNear(v.view, m).clipFromView;
        oblique.worst = depthStep(drawn.clipFromRelative(), {100, -100, 0});
        rows.push_back(oblique);
        rows.push_back(plain);
    }
    return rows;
}

/// Eyes nearer to a pane than any near plane: what stands anywhere before it, a millionth of its distance
/// from the glass or ten thousand times that distance, is drawn, at the pixel at which the pane shows it.
Row nearPanes(const Options& options, SeededRandom& random) {
    Row row{"mirrors",
            "eye 1e-6 to 0.1 m before a pane: what it shows is drawn, in its place",
            0,
            0,
            0,
            1e-6,
            "of half the picture",
            "the eye behind the glass is rounded at 1e-16 of a metre, 1e-10 of the smallest height",
            ""};
    for (int i = 0; i < 4000 * options.effort() && !options.stop(); ++i) {
        const MirrorResult made =
            MirrorPlane::make(polygon(random, random.unit() * direction(random), direction(random), 1));
        if (made.status != MirrorStatus::ok) continue;
        const MirrorPlane& m = made.mirror;
        const double height = random.magnitude(1e-6, 0.1);
        const glm::dvec3 along = glm::normalize(glm::cross(m.normal(), direction(random)));
        const glm::dvec3 eye = m.point() + random.between(0, 2) * along + height * m.normal();
        const EyeView view = perspectiveView(eye, m.point() + 0.2 * direction(random), 1.2, 1.5,
                                             random.oneIn(2) ? 0.1 : 0.1 * height);
        const Portal portal = portalThrough(view, frustumOf(view), m);
        const MirrorView seen = mirrorView(view, m);
        if (portal.status != PortalStatus::ok || seen.status != MirrorViewStatus::ok) continue;
        ++row.tried;
        const HalfSpaces frustum = frustumThrough(portal, seen.view, m);
        EyeView leaning = seen.view;
        leaning.clipFromView = obliqueNear(seen.view, m).clipFromView;
        // Somewhere on what is visible of the pane, and somewhere on the ray beyond it.
        glm::dvec3 on(0);
        double sum = 0;
        for (const glm::dvec3& c : portal.polygon) {
            const double weight = 0.01 + random.unit();
            on += weight * c;
            sum += weight;
        }
        on /= sum;
        const glm::dvec3 ray = eye + on - seen.view.eye;
        const glm::dvec3 p = seen.view.eye + (1 + random.magnitude(1e-6, 1e4)) * ray;
        const glm::dvec4 here = view.clip(eye + on), there = seen.view.clip(p), lean = leaning.clip(p);
        const double off = std::max(std::abs(here.x / here.w - there.x / there.w),
                                    std::abs(here.y / here.w - there.y / there.w));
        row.worst = std::max(row.worst, off);
        // Roundings at the edges of what is visible, of sums of metres; a leaning plane's of depths near 1.
        const bool drawn = touches(frustum, p - seen.view.eye, 1e-9 * (1 + glm::length(p - seen.view.eye))) &&
                           m.signedDistance(p) > 0 && there.w > 0 && there.z <= there.w * (1 + 1e-9) &&
                           there.z > 0 && lean.z <= lean.w * (1 + 1e-9) && lean.z >= -1e-9 * lean.w;
        if (!(off <= row.bound) || !drawn) {
            char text[96];
            std::snprintf(text, sizeof text, "pane %d, eye %g m before it, off by %g, drawn %d", i, height,
                          off, drawn ? 1 : 0);
            fail(row, text);
        }
    }
    return row;
}

/// Two mirrors, exactly parallel, as deep as the recursion goes.
Row facingMirrors(const Options& options, SeededRandom& random) {
    Row row{"mirrors",    "mirrors facing each other exactly, depth 32",       0, 0, 0, 1e-9,
            "of the gap", "each level adds the gap twice: 32 sums of doubles", ""};
    for (int i = 0; i < 50 * options.effort() && !options.stop(); ++i) {
        const double gap = random.magnitude(1e-2, 1e4), half = random.magnitude(0.1, 10) * gap;
        const auto wall = [&](double y, double towards) {
            std::vector<glm::dvec3> c{{-half, y, -half}, {half, y, -half}, {half, y, half}, {-half, y, half}};
            if (towards > 0) std::reverse(c.begin(), c.end());
            return MirrorPlane::make(c).mirror;
        };
        const std::vector<Mirror> mirrors{{0, wall(gap, -1), Mirror::alone}, {1, wall(0, 1), Mirror::alone}};
        const glm::dvec3 eye(0, gap * random.between(0.01, 0.99), 0);
        const TreeView view{
            perspectiveView(eye, eye + glm::dvec3(random.between(-0.3, 0.3), 1, random.between(-0.3, 0.3)),
                            1.2, 1.5, 1e-4 * gap),
            {1280, 720}};
        ReflectionScene scene;
        scene.mirrors = mirrors;
        TreeSettings settings;
        settings.depth = 32;
        settings.leastPixels = 0;
        const ReflectionTree tree = reflectionTree(std::span(&view, 1), scene, settings);
        ++row.tried;
        // One chain of reflections from each mirror in view, each eye a gap further; only the far one is.
        double worst = 0;
        for (const ReflectionNode& n : tree.nodes) {
            const double reach = std::abs(n.view.eye.y - eye.y);
            const double k = n.level + 1;
            const double expected = static_cast<int>(n.level) % 2 == 0 ? (k + 1) * gap - 2 * eye.y : k * gap;
            worst = std::max(worst, std::abs(reach - expected) / gap);
        }
        row.worst = std::max(row.worst, worst);
        if (tree.nodes.empty() || !(worst <= row.bound)) fail(row, "pair " + std::to_string(i));
    }
    return row;
}

/// Any number of mirrors, of any size, seen from anywhere: a tree within its cap, rectangles within their
/// images.
Row trees(const Options& options, SeededRandom& random) {
    Row row{"mirrors",
            "trees of 0 to 200 mirrors, depth 0 to 32",
            0,
            0,
            0,
            0,
            "broken nodes",
            "cap, parents before children, texels and scissors within the map",
            ""};
    for (int i = 0; i < 60 * options.effort() && !options.stop(); ++i) {
        std::vector<Mirror> mirrors;
        const int count = random.oneIn(8) ? 0 : 1 + random.below(200);
        const double spread = random.magnitude(1e-2, 1e5);
        while (static_cast<int>(mirrors.size()) < count) {
            MirrorSurface surface;
            surface.roughness = random.oneIn(3) ? static_cast<float>(random.unit()) : 0.f;
            const MirrorResult made =
                MirrorPlane::make(polygon(random, spread * direction(random), direction(random),
                                          spread * random.magnitude(1e-3, 3)),
                                  surface);
            if (made.status == MirrorStatus::ok)
                mirrors.push_back({mirrors.size(), made.mirror, Mirror::alone});
        }
        groupCoplanar(mirrors);
        const glm::dvec3 eye = spread * random.unit() * direction(random);
        const glm::ivec2 size(1 + random.below(4000), 1 + random.below(4000));
        const TreeView view{perspectiveView(eye, eye + direction(random), random.between(0.05, 3),
                                            static_cast<double>(size.x) / size.y),
                            size};
        ReflectionScene scene;
        scene.mirrors = mirrors;
        TreeSettings settings;
        settings.depth = random.below(33);
        settings.mostMaps = static_cast<std::uint32_t>(random.below(100));
        settings.levelScale = random.oneIn(2) ? 1 : random.between(0.3, 1);
        const ReflectionTree tree = reflectionTree(std::span(&view, 1), scene, settings);
        ++row.tried;
        bool good = tree.status == TreeStatus::ok && tree.nodes.size() <= settings.mostMaps;
        for (std::uint32_t n = 0; n < tree.nodes.size(); ++n) {
            const ReflectionNode& node = tree.nodes[n];
            good = good && (node.parent == ReflectionNode::none || node.parent < n) && finite(node.view) &&
                   node.resolution.x > 0 && node.resolution.y > 0 && node.resolution.x <= size.x + 1 &&
                   node.resolution.y <= size.y + 1 && node.scissor.high.x <= node.resolution.x &&
                   node.scissor.high.y <= node.resolution.y && !node.crop.empty();
        }
        if (!good) fail(row, "tree " + std::to_string(i));
    }
    row.worst = static_cast<double>(row.failures);
    return row;
}

}  // namespace

std::vector<Row> tryMirrors(const Options& options) {
    SeededRandom random(options.seed, 77);
    std::vector<Row> rows;
    rows.push_back(lawOfReflection(options, random));
    options.tell(0.3);
    rows.push_back(degenerateEyes(options, random));
    rows.push_back(nearPanes(options, random));
    rows.push_back(degeneratePolygons(options, random));
    options.tell(0.6);
    for (const Row& row : depthSteps(options)) rows.push_back(row);
    rows.push_back(facingMirrors(options, random));
    rows.push_back(trees(options, random));
    options.tell(1);
    return rows;
}

}  // namespace app::stability
