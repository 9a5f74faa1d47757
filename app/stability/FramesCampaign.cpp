// Places on Earth and places far from the origin: the poles, the antimeridian, high, low, and 100 km away.
#include <unistd.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "app/frame/View.h"
#include "app/stability/SeededRandom.h"
#include "app/stability/Stability.h"
#include "city/geodesy/LocalFrame.h"
#include "city/import/LoadCity.h"
#include "city/roads/RoadNetwork.h"
#include "vehicles/traffic/Traffic.h"

namespace app::stability {

namespace {

using Wide = glm::vec<3, long double>;

/// WGS84 (NIMA TR8350.2): the defining half axis and flattening.
constexpr long double halfAxis = 6378137.0L;
constexpr long double flattening = 1 / 298.257223563L;
constexpr long double degree = std::numbers::pi_v<long double> / 180;

/// Earth-centred coordinates by the textbook's formula, in long double: good to a nanometre.
Wide earthCentred(long double latitude, long double longitude, long double height) {
    const long double squared = flattening * (2 - flattening);
    const long double s = std::sin(latitude * degree), c = std::cos(latitude * degree);
    const long double normal = halfAxis / std::sqrt(1 - squared * s * s);
    return {(normal + height) * c * std::cos(longitude * degree),
            (normal + height) * c * std::sin(longitude * degree), (normal * (1 - squared) + height) * s};
}

/// East, north and up of a point as seen from an origin.
Wide eastNorthUp(const city::LocalFrame& frame, long double latitude, long double longitude,
                 long double height) {
    const auto originLatitude = static_cast<long double>(frame.latitude());
    const auto originLongitude = static_cast<long double>(frame.longitude());
    const Wide d = earthCentred(latitude, longitude, height) -
                   earthCentred(originLatitude, originLongitude, static_cast<long double>(frame.height()));
    const long double sp = std::sin(originLatitude * degree), cp = std::cos(originLatitude * degree);
    const long double sl = std::sin(originLongitude * degree), cl = std::cos(originLongitude * degree);
    return {-sl * d.x + cl * d.y, -sp * cl * d.x - sp * sl * d.y + cp * d.z,
            cp * cl * d.x + cp * sl * d.y + sp * d.z};
}

struct Place {
    const char* name;
    double latitude, longitude, height;
};
constexpr std::array<Place, 8> places{{{"the north pole", 90, 0, 0},
                                       {"the south pole", -90, 45, 2835},
                                       {"the antimeridian", -16.8, 180, 10},
                                       {"the antimeridian, from the west", 65.5, -180, 0},
                                       {"8,848 m", 27.988, 86.925, 8848},
                                       {"-430 m", 31.5, 35.47, -430},
                                       {"the equator", 0, 0, 0},
                                       {"a metre from the pole", 89.99999, 123, 0}}};

/// Points up to 100 km from the origin, there and back.
std::vector<Row> places100km(const Options& options) {
    std::vector<Row> rows;
    for (const Place& place : places) {
        Row row{"frames", std::string("points within 100 km of ") + place.name + ", there and back",
                0,        0,
                0,        1e-3,
                "m",      "a millimetre is asked for; WGS84 in long double is the reference",
                ""};
        const city::LocalFrame frame(place.latitude, place.longitude, place.height);
        SeededRandom random(options.seed, 21);
        for (int k = 0; k < 2000 * options.effort(); ++k) {
            const double reach = random.magnitude(1e-3, 1e5);
            const double angle = random.between(0, 2 * std::numbers::pi);
            const glm::dvec3 local(reach * std::cos(angle), reach * std::sin(angle),
                                   random.between(-500, 9000));
            const glm::dvec3 geodetic = frame.geodeticFromLocal(local);
            const Wide truth = eastNorthUp(frame, geodetic.x, geodetic.y, geodetic.z);
            const glm::dvec3 again = frame.localFromGeodetic(geodetic.x, geodetic.y, geodetic.z);
            const double error =
                std::max(static_cast<double>(glm::length(Wide(local) - truth)), glm::distance(local, again));
            ++row.tried;
            row.worst = std::max(row.worst, error);
            row.failures += !(error <= row.bound) ? 1 : 0;
        }
        rows.push_back(row);
    }
    return rows;
}

/// A folder of its own for the files of a campaign.
class Folder {
  public:
    Folder()
        : path_(std::filesystem::temp_directory_path() /
                ("mirrorstreet-stability-" + std::to_string(getpid()))) {
        std::filesystem::create_directories(path_);
    }
    ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

  private:
    std::filesystem::path path_;
};

/// Houses on a grid around a place, as an OpenStreetMap file; corners are told in degrees of 1e-7.
struct SmallTown {
    std::string text;
    std::vector<glm::dvec2> corners;  ///< latitude, longitude; of houses that are certainly within
};

SmallTown smallTown(const Place& place, bool withBounds) {
    const city::LocalFrame frame(place.latitude, place.longitude, 0);
    SmallTown town;
    std::string ways;
    char line[256];
    double south = 90, north = -90, west = 180, east = -180;
    long id = 0;
    for (int j = -4; j <= 4; ++j)
        for (int i = -4; i <= 4; ++i) {
            const long first = id + 1;
            for (const glm::dvec2& corner : {glm::dvec2(-8, -6), {8, -6}, {8, 6}, {-8, 6}}) {
                const glm::dvec3 g =
                    frame.geodeticFromLocal({40 * i + corner.x + 3 * j, 40 * j + corner.y, 0});
                const double latitude = std::round(g.x * 1e7) * 1e-7;
                const double longitude = std::round(g.y * 1e7) * 1e-7;
                // Houses on the rim may lie outside what counts as the city. The one on a pole itself is left
                // out by libosmium, which assembles rings in degrees, and CityModel::notes says so.
                if (std::max(std::abs(i), std::abs(j)) < 4 && (i != 0 || j != 0))
                    town.corners.emplace_back(latitude, longitude);
                south = std::min(south, latitude);
                north = std::max(north, latitude);
                west = std::min(west, longitude);
                east = std::max(east, longitude);
                std::snprintf(line, sizeof line, "<node id='%ld' version='1' lat='%.7f' lon='%.7f'/>\n", ++id,
                              latitude, longitude);
                town.text += line;
            }
            std::snprintf(line, sizeof line,
                          "<way id='%ld' version='1'><nd ref='%ld'/><nd ref='%ld'/><nd ref='%ld'/><nd "
                          "ref='%ld'/><nd ref='%ld'/><tag k='building' v='yes'/></way>\n",
                          10000 + id, first, first + 1, first + 2, first + 3, first);
            ways += line;
        }
    std::string head = "<?xml version='1.0' encoding='UTF-8'?>\n<osm version='0.6' generator='stability'>\n";
    if (withBounds) {
        std::snprintf(line, sizeof line,
                      "<bounds minlat='%.7f' minlon='%.7f' maxlat='%.7f' maxlon='%.7f'/>\n", south, west,
                      north, east);
        head += line;
    }
    town.text = head + town.text + ways + "</osm>\n";
    return town;
}

/// Imported houses stand where their corners are on Earth.
std::vector<Row> importedTowns(const Options& options) {
    std::vector<Row> rows;
    const Folder folder;
    for (const Place& place : places) {
        Row row{"frames", std::string("house corners of an OpenStreetMap file around ") + place.name,
                0,        0,
                0,        1e-3,
                "m",      "a millimetre is asked for; floats near the origin are good to 2^-24 of 300 m",
                ""};
        for (const bool withBounds : {false, true}) {
            const SmallTown town = smallTown(place, withBounds);
            const std::filesystem::path file = folder / "town.osm";
            std::ofstream(file) << town.text;
            try {
                const city::CityModel model = city::loadCity(file, {});
                std::vector<glm::vec3> vertices;
                for (const city::Chunk& chunk : model.chunks)
                    if (chunk.kind == city::ChunkKind::building)
                        for (const city::Vertex& v : chunk.mesh.vertices) vertices.push_back(v.position);
                for (const glm::dvec2& corner : town.corners) {
                    const Wide truth = eastNorthUp(*model.frame, corner.x, corner.y, 0);
                    double nearest = 1e9;
                    for (const glm::vec3& v : vertices)
                        nearest = std::min(
                            nearest, std::hypot(static_cast<double>(v.x) - static_cast<double>(truth.x),
                                                static_cast<double>(v.y) - static_cast<double>(truth.y)));
                    ++row.tried;
                    row.worst = std::max(row.worst, nearest);
                    if (!(nearest <= row.bound)) ++row.failures;
                }
            } catch (const std::exception& error) {
                ++row.tried;
                ++row.failures;
                if (row.example.empty()) row.example = error.what();
            }
        }
        rows.push_back(row);
        if (options.stop()) break;
    }
    return rows;
}

/// What the model's floats make of positions up to the edge of the widest city.
Row cityPositions(const Options& options) {
    Row row{"frames",
            "positions in a city of 32,768 m, as the model holds them",
            0,
            0,
            0,
            0x1p-11,
            "m",
            "half a step of floats below 2^14 m; importers put the origin in the middle and cut to that",
            ""};
    SeededRandom random(options.seed, 23);
    for (int k = 0; k < 100'000 * options.effort(); ++k) {
        const double x = random.between(-16384, 16384);
        const double error = std::abs(static_cast<double>(static_cast<float>(x)) - x);
        ++row.tried;
        row.worst = std::max(row.worst, error);
        row.failures += !(error <= row.bound) ? 1 : 0;
    }
    return row;
}

/// Pixels of a point by the arithmetic of the shaders (frame.glsl): floats throughout.
glm::vec2 pixelAsDrawn(const glm::vec3& world, const View& view) {
    const glm::vec3 high(view.eye);
    const glm::vec3 low(view.eye - glm::dvec3(high));
    const glm::vec3 relative = (world - high) - low;
    const glm::vec4 clip = view.clipFromView * view.viewFromWorld * glm::vec4(relative, 1);
    return (glm::vec2(clip) / clip.w * 0.5f + 0.5f) * glm::vec2(view.size);
}
/// A vehicle's: its place relative to the eye is taken in double.
glm::vec2 pixelAsDrawn(const glm::dvec3& world, const View& view) {
    const glm::vec4 clip = view.clipFromView * view.viewFromWorld * glm::vec4(glm::vec3(world - view.eye), 1);
    return (glm::vec2(clip) / clip.w * 0.5f + 0.5f) * glm::vec2(view.size);
}
glm::dvec2 pixelInTruth(const glm::dvec3& world, const View& view) {
    using Matrix = glm::mat<4, 4, long double>;
    const glm::vec<4, long double> relative(Wide(world) - Wide(view.eye), 1);
    const glm::vec<4, long double> clip = Matrix(view.clipFromView) * (Matrix(view.viewFromWorld) * relative);
    return (glm::dvec2(clip / clip.w) * 0.5 + 0.5) * glm::dvec2(view.size);
}

struct Far {
    const char* name;
    glm::dvec3 origin;
};
constexpr std::array<Far, 3> fars{{{"near the origin", {0, 0, 0}},
                                   {"at 8,848 m, 20 km out", {2e4, -1.5e4, 8848}},
                                   {"100 km from the origin", {1e5, -7e4, -430}}}};

/// A drive of a kilometre: how far the picture of a standing point is from where it belongs, frame by frame,
/// and how much that changes from one frame to the next.
std::vector<Row> drives(const Options& options) {
    std::vector<Row> rows;
    for (const Far& far : fars) {
        // 16 roundings of 2^-24 on the way from world to pixel, of numbers that are up to 4 times the depth
        // in the parts of the picture that are looked at, of half the picture's width.
        const double bound = 16 * 4 * 0x1p-24 * 640;
        Row jitter{"frames",
                   std::string("a drive of 1 km ") + far.name + ": standing points on screen",
                   0,
                   0,
                   0,
                   2 * bound,
                   "pixels from frame to frame",
                   "twice 16 roundings of 2^-24, of 4 depths and 640 pixels",
                   ""};
        Row car{"frames",
                std::string("a drive of 1 km ") + far.name + ": a car that keeps its distance",
                0,
                0,
                0,
                2 * bound,
                "pixels from frame to frame",
                "as for standing points",
                ""};
        SeededRandom random(options.seed, 22);
        const glm::dvec3 forward = glm::normalize(glm::dvec3(0.8, 0.6, 0));
        // Standing points are what the model holds: floats.
        std::vector<glm::vec3> points;
        for (int k = 0; k < 400; ++k) {
            const double along = random.between(0, 1050), aside = random.between(-20, 20);
            points.emplace_back(far.origin + along * forward + aside * glm::dvec3(-0.6, 0.8, 0) +
                                glm::dvec3(0, 0, random.between(-1.5, 10)));
        }
        std::vector<glm::dvec2> last(points.size(), glm::dvec2(1e9));
        glm::dvec2 lastOfCar(1e9);
        const int frames = 2000;
        for (int frame = 0; frame < frames; ++frame) {
            const glm::dvec3 eye = far.origin + (1000.0 * frame / frames) * forward + glm::dvec3(0, 0, 1.4);
            const View view = lookAt(eye, eye + forward, 1.0471975511965976, {1280, 720});
            for (std::size_t k = 0; k < points.size(); ++k) {
                const glm::dvec3 relative = glm::dvec3(points[k]) - eye;
                const double depth = glm::dot(relative, forward);
                if (depth < 1 || glm::length(relative) > 3 * depth) {
                    last[k] = glm::dvec2(1e9);
                    continue;
                }
                const glm::dvec2 off =
                    glm::dvec2(pixelAsDrawn(points[k], view)) - pixelInTruth(glm::dvec3(points[k]), view);
                if (last[k].x < 1e8) {
                    ++jitter.tried;
                    const double change = glm::distance(off, last[k]);
                    jitter.worst = std::max(jitter.worst, change);
                    jitter.failures += !(change <= jitter.bound) ? 1 : 0;
                }
                last[k] = off;
            }
            const glm::dvec3 place = eye + 8.0 * forward - glm::dvec3(0, 0, 1.4);
            const glm::dvec2 off = glm::dvec2(pixelAsDrawn(place, view)) - pixelInTruth(place, view);
            if (lastOfCar.x < 1e8) {
                ++car.tried;
                const double change = glm::distance(off, lastOfCar);
                car.worst = std::max(car.worst, change);
                car.failures += !(change <= car.bound) ? 1 : 0;
            }
            lastOfCar = off;
        }
        rows.push_back(jitter);
        rows.push_back(car);
    }
    return rows;
}

/// Traffic on a straight road far from the origin: a car keeps to the line between the road's ends.
std::vector<Row> straightRoads() {
    std::vector<Row> rows;
    for (const Far& far : fars) {
        Row row{"frames", std::string("cars on a straight road of 1 km ") + far.name + ": off its line",
                0,        0,
                0,        1e-3,
                "m",      "a millimetre is asked for; the road's ends are floats",
                ""};
        city::RoadNetwork roads;
        city::Lane lane;
        lane.centreLine = {glm::vec3(far.origin), glm::vec3(far.origin + glm::dvec3(797.3, 611.9, 0))};
        roads.lanes.push_back(lane);
        const glm::dvec3 from(lane.centreLine[0]), to(lane.centreLine[1]);
        const glm::dvec3 along = glm::normalize(to - from);
        vehicles::TrafficOptions settings;
        settings.cars = 10;
        vehicles::Traffic traffic(roads, {vehicles::VehicleKind{}}, settings);
        for (int step = 0; step < 1200; ++step) {
            traffic.step();
            for (const vehicles::VehiclePose& pose : traffic.poses()) {
                const glm::dvec3 off = pose.position - from;
                const double error = glm::length(off - glm::dot(off, along) * along);
                ++row.tried;
                row.worst = std::max(row.worst, error);
                row.failures += !(error <= row.bound) ? 1 : 0;
            }
        }
        rows.push_back(row);
    }
    return rows;
}

}  // namespace

std::vector<Row> tryFrames(const Options& options) {
    std::vector<Row> rows = places100km(options);
    const auto append = [&](std::vector<Row> more, double share) {
        rows.insert(rows.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
        options.tell(share);
    };
    append({cityPositions(options)}, 0.1);
    append(importedTowns(options), 0.3);
    if (!options.stop()) append(drives(options), 0.8);
    if (!options.stop()) append(straightRoads(), 1);
    return rows;
}

}  // namespace app::stability
