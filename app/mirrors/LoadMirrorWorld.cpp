#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "app/mirrors/Lathe.h"
#include "app/mirrors/LitShapes.h"
#include "app/mirrors/MirrorWorld.h"
#include "app/report/JsonPlace.h"

namespace app {

namespace {

using Place = JsonPlace;

reflection::MirrorSurface surfaceOf(const Place& p) {
    reflection::MirrorSurface surface;
    surface.reflectance = p.at("reflectance").share();
    if (p.has("roughness")) surface.roughness = static_cast<float>(p.at("roughness").number(0, 1));
    return surface;
}

glm::vec3 tintOf(const Place& p) {
    return p.has("tint") ? p.at("tint").share() : glm::vec3(0);
}

void readMirror(const Place& p, MirrorWorld& world) {
    p.only({"kind", "corners", "reflectance", "roughness", "tint", "ripples", "fade"});
    std::vector<glm::dvec3> corners;
    for (const Place& c : p.at("corners").items()) corners.push_back(c.vector());
    const reflection::MirrorResult made = reflection::MirrorPlane::make(corners, surfaceOf(p));
    if (made.status != reflection::MirrorStatus::ok) {
        const std::string says(reflection::remedyOf(made.status));
        const std::size_t parted = says.find("; ");
        p.at("corners").refuse(says.substr(0, parted), says.substr(parted + 2));
    }
    MirrorWorld::Flat flat{{world.mirrors.size(), made.mirror, reflection::Mirror::alone}, tintOf(p), {}, 0};
    if (p.has("ripples")) {
        const Place ripples = p.at("ripples");
        ripples.only({"slope", "wavelength"});
        if (made.mirror.surface().roughness > 0)
            ripples.refuse("the mirror is rough as well", "leave out one of 'roughness' and 'ripples'");
        flat.ripples.slope = ripples.at("slope").number(0, 0.3);
        flat.ripples.wavelength = ripples.at("wavelength").number(1e-3, 1e3);
        flat.mirror.reach = flat.ripples.reach();
    }
    if (p.has("fade")) flat.fade = p.at("fade").number(1e-3, 1e6);
    world.mirrors.push_back(std::move(flat));
}

void readCurved(const Place& p, MirrorWorld& world) {
    p.only({"kind", "centre", "radius", "slices", "stacks", "reflectance", "roughness", "tint"});
    MirrorWorld::Curved c;
    c.reflector.id = world.curved.size();
    c.reflector.centre = p.at("centre").vector();
    c.reflector.radius = p.at("radius").number(1e-3, 1e6);
    c.reflector.surface = surfaceOf(p);
    c.tint = tintOf(p);
    c.mesh = litBall(glm::vec3(c.reflector.centre), static_cast<float>(c.reflector.radius),
                     p.at("slices").whole(3, 512), p.at("stacks").whole(2, 512), glm::vec3(1));
    world.curved.push_back(std::move(c));
}

constexpr double degree = 0.017453292519943295;

Lathe latheOf(const Place& p) {
    Lathe lathe;
    lathe.foot = p.at("foot").vector();
    if (p.has("axis")) lathe.axis = p.at("axis").vector();
    const std::vector<Place> points = p.at("profile").items();
    if (points.size() > 256) p.at("profile").refuse("has more than 256 points", "leave some out");
    for (const Place& point : points) {
        const std::vector<Place> two = point.items();
        if (two.size() != 2)
            point.refuse("has " + std::to_string(two.size()) + " numbers", "write two, [radius, height]");
        lathe.profile.emplace_back(two[0].number(0, 1e6), two[1].number(-1e6, 1e6));
    }
    lathe.steps = p.at("steps").whole(1, 64);
    lathe.slices = p.at("slices").whole(3, 512);
    if (p.has("arc")) {
        const std::vector<Place> two = p.at("arc").items();
        if (two.size() != 2)
            p.at("arc").refuse("has " + std::to_string(two.size()) + " numbers", "write two, [from, to]");
        lathe.from = degree * two[0].number(-360, 360);
        lathe.to = degree * two[1].number(-360, 720);
    }
    if (const std::optional<LatheProblem> problem = latheProblem(lathe))
        p.refuse(problem->what, problem->remedy);
    return lathe;
}

void readChromeLathe(const Place& p, MirrorWorld& world) {
    p.only({"kind", "foot", "axis", "profile", "steps", "slices", "arc", "fine", "reflectance", "roughness",
            "tint"});
    const Lathe lathe = latheOf(p);
    const int times = p.has("fine") ? p.at("fine").whole(1, 16) : 4;
    if (std::int64_t{times} * times * lathe.triangles() > 4000000)
        p.refuse("its fine surface has more than 4000000 triangles",
                 "make 'fine', 'steps' or 'slices' smaller");
    MirrorWorld::Curved c;
    c.reflector.id = world.curved.size();
    c.reflector.surface = surfaceOf(p);
    c.tint = tintOf(p);
    c.mesh = LatheSurface(lathe).mesh(glm::vec3(1), glm::vec3(1));
    auto surface = std::make_shared<const LatheSurface>(lathe.finer(times));
    c.fine = surface->mesh(glm::vec3(1), glm::vec3(1));
    c.surface = std::move(surface);
    const city::Aabb box = c.mesh.bounds();
    c.reflector.centre = glm::dvec3(0.5f * (box.min + box.max));
    double radius = 0;
    for (const LitMesh::Corner& corner : c.fine.corners)
        radius = std::max(radius, glm::distance(glm::dvec3(corner.position), c.reflector.centre));
    c.reflector.radius = radius;
    world.curved.push_back(std::move(c));
}

/// Of one object, by its numbers alone; 0 for what `readObject` will refuse.
int trianglesOf(const Place& p) {
    const std::string kind = p.at("kind").text();
    if (kind == "box") return 12;
    if (kind == "mirror" && p.has("corners"))
        return std::max(static_cast<int>(p.at("corners").items().size()) - 2, 0);
    if (kind == "panel" && p.has("columns") && p.has("rows"))
        return 2 * p.at("columns").whole(1, 1000) * p.at("rows").whole(1, 1000);
    if (kind == "lathe" || kind == "chrome lathe") return latheOf(p).triangles();
    if (kind == "pillar" && p.has("slices")) return 2 * p.at("slices").whole(3, 512);
    if ((kind == "ball" || kind == "chrome ball") && p.has("slices") && p.has("stacks"))
        return 2 * p.at("slices").whole(3, 512) * (p.at("stacks").whole(2, 512) - 1);
    return 0;
}

void readObject(const Place& p, MirrorWorld& world) {
    const std::string kind = p.at("kind").text();
    LitMesh mesh;
    if (kind == "mirror") return readMirror(p, world);
    if (kind == "chrome ball") return readCurved(p, world);
    if (kind == "chrome lathe") return readChromeLathe(p, world);
    if (kind == "box") {
        p.only({"kind", "low", "high", "colour"});
        const glm::vec3 low(p.at("low").vector()), high(p.at("high").vector());
        for (int i = 0; i < 3; ++i)
            if (!(low[i] < high[i]))
                p.refuse("the box has no volume", "make every number of 'low' smaller than that of 'high'");
        mesh = litBox(low, high, p.at("colour").share());
        city::Aabb solid;
        solid.extend(low);
        solid.extend(high);
        world.occluders.push_back(solid);
    } else if (kind == "panel") {
        p.only({"kind", "origin", "u", "v", "columns", "rows", "colour", "second"});
        const glm::vec3 u(p.at("u").vector()), v(p.at("v").vector());
        if (!(glm::length(glm::cross(u, v)) > 0))
            p.refuse("'u' and 'v' span no area", "make them differ in direction");
        const glm::vec3 colour = p.at("colour").share();
        mesh =
            litPanel(glm::vec3(p.at("origin").vector()), u, v, p.at("columns").whole(1, 1000),
                     p.at("rows").whole(1, 1000), colour, p.has("second") ? p.at("second").share() : colour);
    } else if (kind == "ball") {
        p.only({"kind", "centre", "radius", "slices", "stacks", "colour"});
        mesh =
            litBall(glm::vec3(p.at("centre").vector()), static_cast<float>(p.at("radius").number(1e-3, 1e6)),
                    p.at("slices").whole(3, 512), p.at("stacks").whole(2, 512), p.at("colour").share());
    } else if (kind == "pillar") {
        p.only({"kind", "foot", "radius", "height", "slices", "colour"});
        mesh =
            litPillar(glm::vec3(p.at("foot").vector()), static_cast<float>(p.at("radius").number(1e-3, 1e6)),
                      static_cast<float>(p.at("height").number(1e-3, 1e6)), p.at("slices").whole(3, 512),
                      p.at("colour").share());
    } else if (kind == "lathe") {
        p.only({"kind", "foot", "axis", "profile", "steps", "slices", "arc", "colour", "second"});
        const glm::vec3 colour = p.at("colour").share();
        mesh = LatheSurface(latheOf(p)).mesh(colour, p.has("second") ? p.at("second").share() : colour);
    } else {
        p.at("kind").refuse("there is no '" + kind + "'",
                            "choose mirror, chrome ball, chrome lathe, box, panel, ball, pillar or lathe");
    }
    bakeLight(mesh);
    world.objects.push_back(std::move(mesh));
}

}  // namespace

MirrorWorld parseMirrorWorld(const std::string& text, const std::string& name) {
    const nlohmann::json document = parseJson(text, name);
    const Place top(document, name, "data/scenes/README.md");
    top.only({"name", "source", "licence", "depth", "camera", "objects", "triangles", "beyond", "sky"});
    MirrorWorld world;
    world.name = top.at("name").text();
    top.at("source").text();
    top.at("licence").text();
    world.depth = top.at("depth").whole(0, 32);
    const Place camera = top.at("camera");
    camera.only({"eye", "target", "fov_y_deg"});
    world.eye = camera.at("eye").vector();
    world.target = camera.at("target").vector();
    if (world.eye == world.target) camera.refuse("'eye' and 'target' are the same point", "move one of them");
    world.fovYDegrees = camera.at("fov_y_deg").number(1, 170);
    if (top.has("beyond")) world.beyond = top.at("beyond").share();
    if (top.has("sky")) {
        const Place sky = top.at("sky");
        sky.only({"zenith", "horizon", "nadir"});
        world.zenith = sky.at("zenith").share();
        world.horizon = sky.at("horizon").share();
        world.nadir = sky.at("nadir").share();
    }
    const Place triangles = top.at("triangles");
    const int promised = triangles.whole(0, 10000000);
    int counted = 0;
    for (const Place& p : top.at("objects").items()) {
        // Before anything is made of it: a number too many must not cost the machine's memory.
        const int more = trianglesOf(p);
        if (more > promised - counted)
            p.refuse("with its " + std::to_string(more) + " triangles there are more than 'triangles' says",
                     "correct that number or the objects");
        counted += more;
        readObject(p, world);
    }
    if (promised != counted)
        triangles.refuse("the objects have " + std::to_string(counted) + " triangles, not the number given",
                         "correct the number or the objects");
    return world;
}

MirrorWorld loadMirrorWorld(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    if (!in || !(text << in.rdbuf()))
        throw std::runtime_error(file.string() +
                                 ": cannot be read, or is empty; check the name and its permissions.");
    return parseMirrorWorld(text.str(), file.string());
}

}  // namespace app
