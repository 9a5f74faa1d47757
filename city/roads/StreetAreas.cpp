#include "city/roads/StreetAreas.h"

#include <algorithm>

namespace city {

namespace {

constexpr double kerbWidth = 0.15;
constexpr double kerbTolerance =
    0.04;  // by which a kerb may be straighter than planned: less than its own width
constexpr double narrowestMedian = 0.6;  // narrower ones are painted, not built

Region kerbsideOf(const StreetLayout& layout, const StreetJunction& junction) {
    std::vector<Region> parts;
    std::vector<glm::dvec3> corners;
    for (const StreetJunction::Arm& arm : junction.arms) {
        const Street& street = layout.streets[arm.street];
        if (!street.cars) continue;
        const double cut = street.cut[static_cast<std::size_t>(arm.end)];
        const Polyline axis = arm.end == 0 ? street.axis : reversed(street.axis);
        parts.push_back(Region::strip(partOf(axis, 0, std::min(street.length, cut + 8)), street.halfWidth()));
        const double section = std::max(0.2, cut - kerbRadius);
        const glm::dvec3 p = pointAt(axis, section);
        const glm::dvec3 right = rightOf(directionAt(axis, section)) * street.halfWidth();
        corners.push_back(p - right);
        corners.push_back(p + right);
    }
    if (junction.arms.size() == 1 && !parts.empty()) {
        // Room to turn, where the turning ways run.
        const Street& street = layout.streets[junction.arms.front().street];
        const int end = junction.arms.front().end;
        const double stop = street.stop[static_cast<std::size_t>(end)];
        const double half = 0.5 * street.halfWidth();
        const double radius = std::max(half, std::clamp(0.4 * stop, 2.5, 6.0));
        if (street.drivable(0) && street.drivable(1) && radius > half) {
            const Polyline axis = end == 0 ? street.axis : reversed(street.axis);
            const double ahead = std::max(1.5 * (radius - half), 0.5 * radius);
            parts.push_back(Region::disc(pointAt(axis, std::max(0.0, stop - ahead)), radius + 1.7));
        }
    } else if (corners.size() >= 4) {
        parts.push_back(Region::convexHull(corners));
    }
    // Growing and shrinking again rounds the corners that point inwards.
    return Region::united(parts).grown(kerbRadius).grown(-kerbRadius);
}

}  // namespace

StreetAreas areasOf(const StreetLayout& layout) {
    std::vector<Region> carriageways;
    std::vector<Region> walks;
    std::vector<Region> beds;
    std::vector<Region> ownBeds;
    std::vector<Region> islands;
    for (const Street& street : layout.streets) {
        if (!street.cars) {
            ownBeds.push_back(Region::strip(street.axis, street.halfWidth()));
            continue;
        }
        carriageways.push_back(Region::strip(street.axis, street.halfWidth()));
        if (street.pavement > 0.2)
            walks.push_back(Region::strip(street.axis, street.halfWidth() + street.pavement));
        if (street.median >= narrowestMedian) {
            Polyline middle = partOf(street.axis, street.stop[0], street.length - street.stop[1]);
            middle = offsetToTheRight(middle, street.medianOffset());
            (street.tram ? beds : islands).push_back(Region::strip(middle, 0.5 * street.median));
        }
    }
    for (const StreetJunction& junction : layout.junctions) {
        const Region area = kerbsideOf(layout, junction);
        if (area.empty()) continue;
        double pavement = 0;
        for (const StreetJunction::Arm& arm : junction.arms) {
            const Street& street = layout.streets[arm.street];
            if (street.cars) pavement = std::max(pavement, street.pavement);
        }
        if (pavement > 0.2) walks.push_back(area.grown(pavement));
        carriageways.push_back(area);
    }
    StreetAreas areas;
    const Region driven = Region::united(carriageways).simplified(kerbTolerance);
    const Region island = Region::united(islands);
    const Region medianBed = Region::united(beds);
    areas.tramBed = medianBed.with(Region::united(ownBeds).without(driven));
    areas.carriageway = driven.without(medianBed).without(island);
    const Region level = driven.without(island).with(areas.tramBed);
    const Region raised =
        Region::united(walks).simplified(kerbTolerance).without(driven).with(island).without(level);
    areas.kerb = raised.within(level.widened(kerbWidth));
    areas.pavement = raised.without(areas.kerb);
    return areas;
}

}  // namespace city
