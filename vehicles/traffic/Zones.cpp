#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <tuple>
#include <unordered_map>

#include "vehicles/traffic/WayNetwork.h"

namespace vehicles {

namespace {

constexpr std::size_t longestChain = 16;  // ways that a body may lie on
constexpr double clearance = 0.15;        // metres kept between two swept paths
constexpr double alongside = 0.5;         // radians; less between two directions is running along
constexpr double shortestShared = 12.0;   // metres; shorter overlaps are crossed one at a time
constexpr float sameTrack = 1.2f;         // metres between two lines that are driven as one
constexpr double entryLength = 1.0;  // metres at the start of a shared stretch where vehicles get into file
constexpr double joinReach =
    14.0;  // metres of drive within which two points on consecutive ways are neighbours
constexpr double clusterGap = 6.0;  // metres between two contacts that are two zones

/// For every sample of every way, how far the bodies of the kinds reach sideways from the line when they
/// drive along it: half the width, and in bends the cutting in of the middle and the swinging out of the
/// ends.
class Reach {
  public:
    Reach(const WayNetwork& network, std::span<const VehicleKind> kinds)
        : network_(network), reach_(2 * network.samples.size(), 0.0f) {
        for (std::uint32_t w = 0; w < network.ways.size(); ++w) {
            const Way& way = network.ways[w];
            for (const VehicleKind& kind : kinds) {
                if (kind.tram != way.tram) continue;
                for (std::uint32_t i = 0; i < way.sampleCount; ++i) {
                    for (const std::uint32_t side : {0U, 1U}) {
                        float& r = reach_[2 * (way.firstSample + i) + side];
                        r = std::max(r, 0.5f * kind.width);
                    }
                }
            }
        }
        for (std::uint32_t w = 0; w < network.ways.size(); ++w) {
            const Way& way = network.ways[w];
            if (way.connection) {
                drive(way.previous.front(), w, way.next.front(), kinds);
            } else {
                drive(way.previous.empty() ? city::noIndex : way.previous.front(), w,
                      way.next.empty() ? city::noIndex : way.next.front(), kinds);
            }
        }
    }
    float at(std::uint32_t sample) const { return std::max(towards(sample, true), towards(sample, false)); }
    /// To the left or to the right alone: a bus swings out on one side of a bend and cuts in on the other.
    float towards(std::uint32_t sample, bool left) const {
        return reach_[std::size_t{2} * sample + (left ? 1 : 0)];
    }

  private:
    void drive(std::uint32_t before, std::uint32_t way, std::uint32_t after,
               std::span<const VehicleKind> kinds) {
        line_.clear();
        ids_.clear();
        double longest = 0;
        for (const VehicleKind& kind : kinds) {
            if (kind.tram == network_.ways[way].tram)
                longest = std::max(longest, static_cast<double>(kind.length));
        }
        const auto append = [&](std::uint32_t w, double from, double to) {
            const Way& part = network_.ways[w];
            for (std::uint32_t i = 0; i < part.sampleCount; ++i) {
                const double s = i * part.spacing;
                if (s < from || s > to) continue;
                const glm::dvec3 p = network_.samples[part.firstSample + i];
                if (!line_.empty() && glm::distance(line_.back(), glm::dvec2(p)) < 1e-4) continue;
                line_.push_back(glm::dvec2(p));
                ids_.push_back(part.firstSample + i);
            }
        };
        // A long body lies over several short ways: as many behind and ahead as it covers, along one of the
        // routes.
        std::vector<std::uint32_t> behind;
        double covered = 0;
        for (std::uint32_t w = before;
             w != city::noIndex && covered < longest + 3 && behind.size() < longestChain;) {
            behind.push_back(w);
            covered += network_.ways[w].length;
            w = network_.ways[w].previous.empty() ? city::noIndex : network_.ways[w].previous.front();
        }
        for (std::size_t k = behind.size(); k-- > 0;) {
            const bool last = k + 1 == behind.size();
            append(behind[k], last ? covered - longest - 3 : 0, 1e9);
        }
        append(way, 0, 1e9);
        covered = 0;
        for (std::uint32_t w = after, n = 0; w != city::noIndex && covered < longest + 3 && n < longestChain;
             ++n) {
            append(w, 0, longest + 3 - covered);
            covered += network_.ways[w].length;
            w = network_.ways[w].next.empty() ? city::noIndex : network_.ways[w].next.front();
        }
        along_.assign(1, 0.0);
        double bend = 0;
        for (std::size_t i = 1; i < line_.size(); ++i) {
            along_.push_back(along_.back() + glm::distance(line_[i - 1], line_[i]));
            if (i > 1) {
                const glm::dvec2 u = line_[i - 1] - line_[i - 2];
                const glm::dvec2 v = line_[i] - line_[i - 1];
                bend = std::max(bend, std::abs(std::atan2(u.x * v.y - u.y * v.x, glm::dot(u, v))));
            }
        }
        if (bend < 0.01) return;  // straight: nothing swings
        for (const VehicleKind& kind : kinds) {
            if (kind.tram != network_.ways[way].tram) continue;
            const double overhang = 0.5 * (kind.length - kind.wheelbase);
            for (double front = kind.length; front <= along_.back(); front += 1.0) {
                const glm::dvec2 f = point(front - overhang);
                const glm::dvec2 r = point(front - overhang - kind.wheelbase);
                const glm::dvec2 d = glm::distance(f, r) > 1e-6 ? glm::normalize(f - r) : glm::dvec2(1, 0);
                const glm::dvec2 middle = 0.5 * (f + r);
                const glm::dvec2 side(-d.y, d.x);
                const int n = std::max(4, static_cast<int>(std::ceil(kind.length / 1.5)));
                for (int k = 0; k <= n; ++k) {
                    const double x = kind.length * (static_cast<double>(k) / n - 0.5);
                    for (double y : {-0.5, 0.5}) {
                        mark(middle + d * x + side * (y * kind.width), front - 0.5 * kind.length + x);
                    }
                }
            }
        }
    }

    glm::dvec2 point(double s) const {
        const auto it = std::lower_bound(along_.begin(), along_.end(), s);
        const auto i = std::clamp<std::ptrdiff_t>(it - along_.begin(), 1,
                                                  static_cast<std::ptrdiff_t>(along_.size()) - 1);
        const auto k = static_cast<std::size_t>(i);
        const double t = std::clamp((s - along_[k - 1]) / (along_[k] - along_[k - 1]), 0.0, 1.0);
        return (1 - t) * line_[k - 1] + t * line_[k];
    }

    /// A point of the body that belongs near a place on the line: the nearest sample reaches at least that
    /// far.
    void mark(const glm::dvec2& p, double near) {
        const auto lo = static_cast<std::size_t>(std::lower_bound(along_.begin(), along_.end(), near - 2.5) -
                                                 along_.begin());
        std::size_t best = ids_.size();
        double bestDistance = 1e18;
        for (std::size_t i = lo; i < along_.size() && along_[i] < near + 2.5; ++i) {
            const double d = glm::distance(line_[i], p);
            if (d < bestDistance) {
                bestDistance = d;
                best = i;
            }
        }
        if (best == ids_.size()) return;
        // The distance to the line itself, not to the sample: the sample may be half a spacing off along the
        // line.
        double toLine = bestDistance;
        for (std::size_t i = best == 0 ? 1 : best; i <= best + 1 && i < line_.size(); ++i) {
            const glm::dvec2 e = line_[i] - line_[i - 1];
            const double t = std::clamp(glm::dot(p - line_[i - 1], e) / glm::dot(e, e), 0.0, 1.0);
            toLine = std::min(toLine, glm::distance(p, line_[i - 1] + t * e));
        }
        const std::size_t k = std::clamp<std::size_t>(best, 1, line_.size() - 1);
        const glm::dvec2 d = line_[k] - line_[k - 1];
        const glm::dvec2 e = p - line_[best];
        const bool left = d.x * e.y - d.y * e.x > 0;
        for (std::size_t i = best == 0 ? 0 : best - 1; i <= best + 1 && i < ids_.size(); ++i) {
            float& r = reach_[2 * ids_[i] + (left ? 1 : 0)];
            r = std::max(r, static_cast<float>(toLine));
        }
    }

    const WayNetwork& network_;
    std::vector<float> reach_;
    std::vector<glm::dvec2> line_;
    std::vector<double> along_;
    std::vector<std::uint32_t> ids_;
};

struct Contact {
    std::uint32_t a, b;  // ways, a < b
    std::uint32_t i, j;  // samples within them
};

glm::dvec2 directionOf(const WayNetwork& network, const Way& way, std::uint32_t i) {
    const std::uint32_t k = std::min(i, way.sampleCount - 2);
    const glm::dvec2 d =
        glm::dvec2(network.samples[way.firstSample + k + 1] - network.samples[way.firstSample + k]);
    const double n = glm::length(d);
    return n > 0 ? d / n : glm::dvec2(1, 0);
}

void addZone(WayNetwork& network, std::uint32_t a, double a0, double a1, std::uint32_t b, double b0,
             double b1) {
    const std::uint32_t zone = network.zoneCount++;
    network.ways[a].zones.push_back({a0, a1, zone, 0});
    network.ways[b].zones.push_back({b0, b1, zone, 1});
}

/// One cluster of contacts between two ways becomes a zone, or a shared stretch.
void classify(WayNetwork& network, std::span<const Contact> contacts) {
    const Contact& any = contacts.front();
    Way& a = network.ways[any.a];
    Way& b = network.ways[any.b];
    double a0 = 1e18, a1 = -1e18, b0 = 1e18, b1 = -1e18;
    bool along = true;
    double apart = 1e9;
    for (const Contact& c : contacts) {
        a0 = std::min(a0, c.i * a.spacing);
        a1 = std::max(a1, c.i * a.spacing);
        b0 = std::min(b0, c.j * b.spacing);
        b1 = std::max(b1, c.j * b.spacing);
        apart = std::min(
            apart, glm::distance(network.samples[a.firstSample + c.i], network.samples[b.firstSample + c.j]));
        along = along &&
                glm::dot(directionOf(network, a, c.i), directionOf(network, b, c.j)) > std::cos(alongside);
    }
    // Samples stand for half a spacing on each side.
    a0 = std::max(0.0, a0 - 0.5 * a.spacing);
    b0 = std::max(0.0, b0 - 0.5 * b.spacing);
    a1 = std::min(a.length, a1 + 0.5 * a.spacing);
    b1 = std::min(b.length, b1 + 0.5 * b.spacing);
    const bool siblings =
        a.connection && b.connection && a.previous.front() == b.previous.front() && a0 < 1.5 && b0 < 1.5;
    const bool sharedRun = along && apart < sameTrack && a.connection == b.connection &&
                           a1 - a0 > shortestShared && b1 - b0 > shortestShared &&
                           std::abs((a1 - a0) - (b1 - b0)) < 0.2 * (a1 - a0);
    if (siblings) {
        // Both start at the end of the same lane: in file until they have parted.
        a.shared.push_back({0, a1, any.b, 0, 1});
        b.shared.push_back({0, b1, any.a, 0, 1});
        return;
    }
    if (sharedRun) {
        const double scale = (b1 - b0) / (a1 - a0);
        a.shared.push_back({a0, a1, any.b, b0, scale});
        b.shared.push_back({b0, b1, any.a, a0, 1 / scale});
        addZone(network, any.a, a0, a0 + entryLength, any.b, b0, b0 + entryLength);
        return;
    }
    addZone(network, any.a, a0, a1, any.b, b0, b1);
}

}  // namespace

void findZones(WayNetwork& network, std::span<const VehicleKind> kinds) {
    const Reach reach(network, kinds);
    std::vector<std::uint32_t> wayOf(network.samples.size());
    float widest = 0;
    for (std::uint32_t w = 0; w < network.ways.size(); ++w) {
        const Way& way = network.ways[w];
        for (std::uint32_t i = 0; i < way.sampleCount; ++i) {
            wayOf[way.firstSample + i] = w;
            widest = std::max(widest, reach.at(way.firstSample + i));
        }
    }
    const double cell = std::max(4.0, 2.0 * widest + 1);
    const auto key = [&](const glm::dvec3& p, int dx, int dy) {
        const auto x = static_cast<std::int64_t>(std::floor(p.x / cell)) + dx;
        const auto y = static_cast<std::int64_t>(std::floor(p.y / cell)) + dy;
        return static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15ULL ^ static_cast<std::uint64_t>(y);
    };
    std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells;
    for (std::uint32_t s = 0; s < network.samples.size(); ++s) {
        if (reach.at(s) > 0) cells[key(network.samples[s], 0, 0)].push_back(s);
    }
    // A way and the one behind it touch where they join; further apart along the drive, they cross like any
    // others.
    const auto joined = [&](std::uint32_t a, double sa, std::uint32_t b, double sb) {
        const auto follows = [&](std::uint32_t first, double s, std::uint32_t second, double t) {
            const auto& n = network.ways[first].next;
            if (std::find(n.begin(), n.end(), second) == n.end()) return false;
            return network.ways[first].length - s + t < joinReach;
        };
        return follows(a, sa, b, sb) || follows(b, sb, a, sa);
    };
    std::vector<Contact> contacts;
    for (std::uint32_t s = 0; s < network.samples.size(); ++s) {
        if (!(reach.at(s) > 0)) continue;
        const std::uint32_t w = wayOf[s];
        const glm::dvec3 p = network.samples[s];
        for (int dx = -1; dx <= 1; ++dx) {
            for (int dy = -1; dy <= 1; ++dy) {
                const auto found = cells.find(key(p, dx, dy));
                if (found == cells.end()) continue;
                for (std::uint32_t t : found->second) {
                    const std::uint32_t v = wayOf[t];
                    if (v <= w) continue;
                    const glm::dvec3 q = network.samples[t];
                    // Bridges: four metres of height keep vehicles apart.
                    if (std::abs(p.z - q.z) > 4) continue;
                    const double sum = reach.at(s) + reach.at(t) + clearance;
                    const double ex = p.x - q.x;
                    const double ey = p.y - q.y;
                    if (ex * ex + ey * ey > sum * sum) continue;
                    const glm::dvec2 u =
                        directionOf(network, network.ways[w], s - network.ways[w].firstSample);
                    const glm::dvec2 o =
                        directionOf(network, network.ways[v], t - network.ways[v].firstSample);
                    const double facing = reach.towards(s, u.y * ex - u.x * ey > 0) +
                                          reach.towards(t, o.x * ey - o.y * ex > 0) + clearance;
                    if (ex * ex + ey * ey > facing * facing) continue;
                    const std::uint32_t i = s - network.ways[w].firstSample;
                    const std::uint32_t j = t - network.ways[v].firstSample;
                    if (joined(w, i * network.ways[w].spacing, v, j * network.ways[v].spacing)) continue;
                    contacts.push_back({w, v, i, j});
                }
            }
        }
    }
    std::sort(contacts.begin(), contacts.end(), [](const Contact& x, const Contact& y) {
        return std::tie(x.a, x.b, x.i, x.j) < std::tie(y.a, y.b, y.i, y.j);
    });
    contacts.erase(std::unique(contacts.begin(), contacts.end(),
                               [](const Contact& x, const Contact& y) {
                                   return std::tie(x.a, x.b, x.i, x.j) == std::tie(y.a, y.b, y.i, y.j);
                               }),
                   contacts.end());
    std::size_t begin = 0;
    for (std::size_t k = 1; k <= contacts.size(); ++k) {
        const bool cut =
            k == contacts.size() || contacts[k].a != contacts[k - 1].a ||
            contacts[k].b != contacts[k - 1].b ||
            (contacts[k].i - contacts[k - 1].i) * network.ways[contacts[k].a].spacing > clusterGap;
        if (!cut) continue;
        classify(network, std::span(contacts).subspan(begin, k - begin));
        begin = k;
    }
    for (Way& way : network.ways) {
        std::stable_sort(way.zones.begin(), way.zones.end(),
                         [](const Way::ZoneSide& x, const Way::ZoneSide& y) { return x.begin < y.begin; });
    }
}

}  // namespace vehicles
