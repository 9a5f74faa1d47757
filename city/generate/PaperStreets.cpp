#include "city/generate/PaperStreets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>

#include "city/generate/Shapes.h"

namespace city {

namespace {

using L = PaperLayout;

constexpr float markingHeight =
    0.012f;  // metres above the asphalt: clear of it in depth buffers, not seen from the side

std::array<glm::vec2, 4> rectangle(float x0, float y0, float x1, float y1) {
    return {{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}};
}

/// Marking across or along: a strip from a to b, `width` metres wide.
void addStrip(Mesh& mesh, glm::vec2 a, glm::vec2 b, float width, std::uint32_t material) {
    const glm::vec2 right = 0.5f * width * outward(a, b);
    addDeck(mesh, std::array{a + right, b + right, b - right, a - right}, markingHeight, material);
}

/// From the edge of the crossing at line k to the edge of the next.
float segmentStart(int k) {
    return L::line(k) + L::kerbLine;
}
float segmentEnd(int k) {
    return L::line(k + 1) - L::kerbLine;
}

/// Turns (along, across) into the world for streets that run east (0) or north (1).
glm::vec2 place(int direction, float along, float across) {
    return direction == 0 ? glm::vec2(along, across) : glm::vec2(-across, along);
}

void addAsphalt(const Palette& p, ChunkCollector& chunks) {
    const float repeat = p.repeat(p.streets.asphalt);
    for (int i = 0; i < L::lines; ++i) {
        for (int j = 0; j < L::lines; ++j) {
            const float x = L::line(i), y = L::line(j), e = L::kerbLine;
            addDeck(chunks.at(ChunkKind::ground, x, y), rectangle(x - e, y - e, x + e, y + e), 0,
                    p.streets.asphalt, repeat);
            if (i + 1 < L::lines) {
                const float x0 = segmentStart(i), x1 = segmentEnd(i);
                addDeck(chunks.at(ChunkKind::ground, 0.5f * (x0 + x1), y), rectangle(x0, y - e, x1, y + e), 0,
                        p.streets.asphalt, repeat);
            }
            if (j + 1 < L::lines) {
                const float y0 = segmentStart(j), y1 = segmentEnd(j);
                addDeck(chunks.at(ChunkKind::ground, x, 0.5f * (y0 + y1)), rectangle(x - e, y0, x + e, y1), 0,
                        p.streets.asphalt, repeat);
            }
        }
    }
}

/// Pavement, kerb and inner ground of one block between street lines (or the city's border, where there is
/// neither).
void addBlock(int i, int j, const Palette& p, ChunkCollector& chunks) {
    const auto low = [](int k) { return k < 0 ? -L::half : L::line(k) + L::kerbLine; };
    const auto high = [](int k) { return k + 1 >= L::lines ? L::half : L::line(k + 1) - L::kerbLine; };
    const float x0 = low(i), x1 = high(i), y0 = low(j), y1 = high(j), w = L::pavementWidth;
    const bool west = i >= 0, east = i + 1 < L::lines, south = j >= 0, north = j + 1 < L::lines;
    Mesh& mesh = chunks.at(ChunkKind::ground, 0.5f * (x0 + x1), 0.5f * (y0 + y1));
    const float z = L::kerbHeight, repeat = p.repeat(p.streets.pavement);
    const float ix0 = x0 + (west ? w : 0), ix1 = x1 - (east ? w : 0), iy0 = y0 + (south ? w : 0),
                iy1 = y1 - (north ? w : 0);
    const std::uint32_t inside = p.grass;
    if (south) addDeck(mesh, rectangle(x0, y0, x1, iy0), z, p.streets.pavement, repeat);
    if (north) addDeck(mesh, rectangle(x0, iy1, x1, y1), z, p.streets.pavement, repeat);
    if (west) addDeck(mesh, rectangle(x0, iy0, ix0, iy1), z, p.streets.pavement, repeat);
    if (east) addDeck(mesh, rectangle(ix1, iy0, x1, iy1), z, p.streets.pavement, repeat);
    addDeck(mesh, rectangle(ix0, iy0, ix1, iy1), z, inside, p.repeat(inside));
    // Kerbs face the carriageway.
    if (south) addWall(mesh, {x0, y0}, {x1, y0}, 0, z, p.streets.kerb, x1 - x0, z);
    if (east) addWall(mesh, {x1, y0}, {x1, y1}, 0, z, p.streets.kerb, y1 - y0, z);
    if (north) addWall(mesh, {x1, y1}, {x0, y1}, 0, z, p.streets.kerb, x1 - x0, z);
    if (west) addWall(mesh, {x0, y1}, {x0, y0}, 0, z, p.streets.kerb, y1 - y0, z);
}

}  // namespace

StreetGraph paperStreetGraph() {
    StreetGraph graph;
    const auto node = [](int i, int j) { return static_cast<std::uint32_t>(j * L::lines + i); };
    for (int j = 0; j < L::lines; ++j) {
        for (int i = 0; i < L::lines; ++i) {
            const int arms = (i > 0) + (i + 1 < L::lines) + (j > 0) + (j + 1 < L::lines);
            graph.nodes.push_back({{L::line(i), L::line(j), 0}, arms > 2});
        }
    }
    const auto edge = [&](std::uint32_t from, std::uint32_t to, std::string name) {
        StreetGraph::Edge e;
        e.from = from;
        e.to = to;
        e.shape = {graph.nodes[from].position, graph.nodes[to].position};
        e.lanesForward = e.lanesBackward = 2;
        e.laneWidth = L::laneWidth;
        e.pavementWidth = L::pavementWidth;
        e.name = std::move(name);
        graph.edges.push_back(std::move(e));
    };
    for (int k = 0; k < L::lines; ++k) {
        for (int s = 0; s + 1 < L::lines; ++s) {
            edge(node(s, k), node(s + 1, k), "East street " + std::to_string(k + 1));
            edge(node(k, s), node(k, s + 1), "North street " + std::to_string(k + 1));
        }
    }
    return graph;
}

void addPaperStreets(const RoadNetwork& roads, const Palette& palette, std::size_t triangles,
                     ChunkCollector& chunks) {
    ChunkCollector surfaces(260);
    addAsphalt(palette, surfaces);
    for (int j = -1; j < L::lines; ++j)
        for (int i = -1; i < L::lines; ++i) addBlock(i, j, palette, surfaces);

    const std::uint32_t paint = palette.streets.marking;
    for (const Lane& lane : roads.lanes) {
        if (lane.centreLine.size() < 2 || lane.connections.empty()) continue;
        const glm::vec2 end(lane.centreLine.back()), before(lane.centreLine[lane.centreLine.size() - 2]);
        const glm::vec2 along = glm::normalize(end - before), right(along.y, -along.x);
        const glm::vec2 middle = end - 0.2f * along;
        const float side = 0.5f * lane.width - 0.12f;
        addStrip(surfaces.at(ChunkKind::ground, middle.x, middle.y), middle - side * right,
                 middle + side * right, 0.4f, paint);
    }
    // Centre lines are whole, and keep clear of the crossings.
    constexpr float clear = 8;
    for (int direction = 0; direction < 2; ++direction) {
        for (int k = 0; k < L::lines; ++k) {
            for (int s = 0; s + 1 < L::lines; ++s) {
                const float a0 = segmentStart(s) + clear, a1 = segmentEnd(s) - clear;
                const glm::vec2 a = place(direction, a0, 0), b = place(direction, a1, 0);
                // place() mirrors the across axis for northbound streets; centre lines do not care.
                const float across = direction == 0 ? L::line(k) : -L::line(k);
                const glm::vec2 offset = place(direction, 0, across);
                Mesh& mesh =
                    surfaces.at(ChunkKind::ground, 0.5f * (a + b).x + offset.x, 0.5f * (a + b).y + offset.y);
                for (const float lean : {-0.12f, 0.12f}) {
                    const glm::vec2 shift = offset + place(direction, 0, lean);
                    addStrip(mesh, a + shift, b + shift, 0.12f, paint);
                }
            }
        }
    }
    std::vector<Chunk> made = surfaces.take();
    std::size_t used = 0;
    for (const Chunk& chunk : made) used += chunk.mesh.triangleCount();
    if (used + 2 > triangles || (triangles - used) % 2 != 0) {
        throw std::logic_error("paper city: the surfaces take " + std::to_string(used) + " triangles of " +
                               std::to_string(triangles));
    }
    for (Chunk& chunk : made) chunks.addWhole(chunk.kind, std::move(chunk.mesh));

    // Dashes between the lanes: spread evenly over all segments, what does not divide goes to the first ones.
    const std::size_t dashes = (triangles - used) / 2;
    constexpr std::size_t lines = L::lines;
    const std::size_t rows = 4 * lines * (lines - 1);
    ChunkCollector dashed(260);
    std::size_t row = 0;
    for (int direction = 0; direction < 2; ++direction) {
        for (int k = 0; k < L::lines; ++k) {
            for (int s = 0; s + 1 < L::lines; ++s) {
                for (const float lane : {-L::laneWidth, L::laneWidth}) {
                    const std::size_t count = dashes / rows + (row < dashes % rows ? 1 : 0);
                    ++row;
                    const float a0 = segmentStart(s) + clear, a1 = segmentEnd(s) - clear;
                    const float step = (a1 - a0) / static_cast<float>(std::max<std::size_t>(count, 1));
                    for (std::size_t d = 0; d < count; ++d) {
                        const float at = a0 + (static_cast<float>(d) + 0.5f) * step;
                        const float across = (direction == 0 ? L::line(k) : -L::line(k)) + lane;
                        const glm::vec2 from = place(direction, at - 2, across),
                                        to = place(direction, at + 2, across);
                        addStrip(dashed.at(ChunkKind::ground, from.x, from.y), from, to, 0.13f, paint);
                    }
                }
            }
        }
    }
    for (Chunk& chunk : dashed.take()) chunks.addWhole(chunk.kind, std::move(chunk.mesh));
}

}  // namespace city
