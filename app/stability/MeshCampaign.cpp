// The adaptive mesh: depth ratios to 1e6, all sky, slits as narrow as a texel.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "app/stability/SeededRandom.h"
#include "app/stability/Stability.h"
#include "reflection/local_map/LocalMapBuilder.h"
#include "reflection/local_map/LocalMapMesh.h"
#include "reflection/tracing/GridTracer.h"

namespace app::stability {

namespace {

using reflection::LocalMapMesh;

/// A place that is hard on the mesh, and where the map stands in it.
struct Scene {
    std::string name;
    city::Heightfield field;
    glm::vec3 centre{0};
};

Scene makeScene(int kind, SeededRandom& random) {
    const float endless = std::numeric_limits<float>::infinity();
    switch (kind % 4) {
        case 0: {
            // A wall a centimetre away, the next ones 10 km: a ratio of 10^6.
            city::Heightfield field(201, 201, 100, {-10050, -10050});
            for (int j = 0; j < 201; ++j)
                for (int i = 0; i < 201; ++i)
                    field.set(i, j, i == 0 || j == 0 || i == 200 || j == 200 ? endless : -8000.0f);
            field.set(101, 100, 30);
            return {"depth ratio 10^6", field, {49.99f, static_cast<float>(random.between(-40, 40)), 1.5f}};
        }
        case 1:
            return {"all sky",
                    city::Heightfield(20, 20, 1, {-10, -10}),
                    {random.between(-9, 9), random.between(-9, 9), random.between(-100, 100)}};
        case 2: {
            // A fence of posts with gaps of a cell before walls far away: slits of about a texel.
            city::Heightfield field(400, 400, 0.25f, {-50, -50});
            for (int j = 0; j < 400; ++j)
                for (int i = 0; i < 400; ++i) {
                    const int ring = std::max(std::abs(i - 200), std::abs(j - 200));
                    field.set(i, j, ring > 195 ? 40.0f : ring == 48 && (i + j) % 3 != 0 ? 20.0f : 0.0f);
                }
            return {"one-texel slits",
                    field,
                    {random.between(-2, 2), random.between(-2, 2), random.between(0.5, 6)}};
        }
        default: {
            // Columns of any height from 1e-3 to 1e4 m around the map.
            city::Heightfield field(60, 60, 1, {-30, -30});
            for (float& h : field.cells()) h = static_cast<float>(random.magnitude(1e-3, 1e4));
            field.set(30, 30, 0);
            return {"columns of 1e-3 to 1e4 m", field, {0.5f, 0.5f, 0.5f}};
        }
    }
}

struct Tally {
    Row cracks{"mesh", "", 0, 0, 0, 0, "cells not covered once", "quads tile a face", ""};
    Row values{"mesh", "", 0, 0, 0, 1000, "1/m", "1/t of a hit at a millimetre, LocalMapMesh.cpp", ""};
    Row budget{"mesh", "", 0, 0, 0, 1, "of the budget", "a lattice has (n+1)^2 corners and n^2 middles", ""};
    Row texels{
        "mesh",
        "",
        0,
        0,
        0,
        1,
        "of the bound",
        "bilinear in float: 8 roundings, and 3 of a place in quads' widths from the face's edge, of 2^-24",
        ""};
};

void checkQuads(const LocalMapMesh& mesh, Tally& tally) {
    const auto n = static_cast<std::size_t>(mesh.latticeSize());
    std::vector<std::uint8_t> covered(n * n, 0);
    for (const LocalMapMesh::Quad& q : mesh.quads()) {
        for (std::size_t y = q.y; y < std::size_t{q.y} + q.size; ++y)
            for (std::size_t x = q.x; x < std::size_t{q.x} + q.size; ++x)
                if (x >= n || y >= n || covered[y * n + x]++ != 0) ++tally.cracks.failures;
        for (const float w : {q.corner[0], q.corner[1], q.corner[2], q.corner[3], q.centre}) {
            ++tally.values.tried;
            tally.values.worst = std::max(tally.values.worst, static_cast<double>(w));
            tally.values.failures += !(w >= 0 && w <= 1000.001f) ? 1 : 0;
        }
    }
    for (const std::uint8_t times : covered) tally.cracks.failures += times == 0 ? 1 : 0;
    tally.cracks.tried += n * n;
    ++tally.budget.tried;
    const double most = static_cast<double>((n + 1) * (n + 1) + n * n);
    const double used = std::max(static_cast<double>(mesh.raysTraced()) / most,
                                 static_cast<double>(mesh.quads().size()) / static_cast<double>(n * n));
    tally.budget.worst = std::max(tally.budget.worst, used);
    tally.budget.failures += used > 1 ? 1 : 0;
}

/// How far a texel is from what a quad says of it, as a share of the bound. u, v: its middle in units of
/// 1 / `unit` of the lattice's.
double shareOfBound(const LocalMapMesh::Quad& q, double got, long u, long v, long unit) {
    double want = static_cast<double>(q.centre);
    if (q.smooth) {
        const double s = (static_cast<double>(u) / static_cast<double>(unit) - q.x) / q.size;
        const double t = (static_cast<double>(v) / static_cast<double>(unit) - q.y) / q.size;
        const auto c = [&](int k) { return static_cast<double>(q.corner[k]); };
        want = (1 - t) * ((1 - s) * c(0) + s * c(1)) + t * ((1 - s) * c(2) + s * c(3));
    }
    double scale = std::abs(want);
    for (const float w : q.corner) scale = std::max(scale, static_cast<double>(w));
    const double place = static_cast<double>(std::max(q.x, q.y)) / q.size + 1;
    const double bound = scale * (8 + 2 * 3 * place) * 0x1p-24;
    const double error = std::abs(got - want);
    return error == 0 ? 0 : error / bound;
}

/// Every texel of the map comes from the quad in which its middle lies: none is left out between quads of
/// different sizes.
void checkTexels(const LocalMapMesh& mesh, const std::vector<float>& texels, int faceSize, Tally& tally) {
    const long n = mesh.latticeSize(), unit = 2L * faceSize;
    std::vector<std::uint32_t> quadOf(static_cast<std::size_t>(n * n));
    for (std::uint32_t k = 0; k < mesh.quads().size(); ++k) {
        const LocalMapMesh::Quad& q = mesh.quads()[k];
        for (long y = q.y; y < q.y + q.size; ++y)
            for (long x = q.x; x < q.x + q.size; ++x) quadOf[static_cast<std::size_t>(y * n + x)] = k;
    }
    for (long y = 0; y < faceSize; ++y)
        for (long x = 0; x < faceSize; ++x) {
            // In lattice units, times 2 * faceSize: exact. A middle on a border may go to either side.
            const long u = (2 * x + 1) * n, v = (2 * y + 1) * n;
            const auto got = static_cast<double>(texels[static_cast<std::size_t>(y * faceSize + x)]);
            double least = std::numeric_limits<double>::infinity();
            for (const long i : {(u - 1) / unit, u / unit})
                for (const long j : {(v - 1) / unit, v / unit}) {
                    const std::uint32_t k = quadOf[static_cast<std::size_t>(j * n + i)];
                    least = std::min(least, shareOfBound(mesh.quads()[k], got, u, v, unit));
                }
            ++tally.texels.tried;
            tally.texels.worst = std::max(tally.texels.worst, least);
            tally.texels.failures += !(least <= tally.texels.bound) ? 1 : 0;
        }
}

}  // namespace

std::vector<Row> tryMesh(const Options& options) {
    constexpr int kinds = 4;
    std::vector<Tally> tallies(kinds);
    const int rounds = 10 * options.effort();
    for (int round = 0; round < rounds && !options.stop(); ++round) {
        for (int kind = 0; kind < kinds; ++kind) {
            SeededRandom random(options.seed, 1000 + static_cast<std::uint64_t>(round));
            const Scene scene = makeScene(kind, random);
            const reflection::GridTracer tracer(scene.field);
            Tally& tally = tallies[static_cast<std::size_t>(kind)];
            for (Row* row : {&tally.cracks, &tally.values, &tally.budget, &tally.texels})
                row->what = scene.name;
            reflection::LocalMapRequest request;
            request.centre = scene.centre;
            request.mesh.criterion = random.oneIn(2) ? reflection::RefineCriterion::planarity
                                                     : reflection::RefineCriterion::depthRatio;
            request.mesh.baseCells = 1 + random.below(20);
            request.mesh.depth = random.below(5);
            request.mesh.threshold = static_cast<float>(random.magnitude(1e-6, 1));
            // Any size, a power of two, and a multiple of the lattice: three ways of filling texels.
            const int lattice = request.mesh.baseCells << request.mesh.depth;
            const int multiple = lattice * (1 + random.below(std::max(1, 256 / lattice)));
            for (const int faceSize : {1 + random.below(200), 8 << random.below(5), multiple})
                for (int face = 0; face < 6; ++face) {
                    // A builder without a past: what is not written stays 0.
                    reflection::LocalMapBuilder builder;
                    request.faceSize = faceSize;
                    const auto side = static_cast<std::size_t>(faceSize);
                    std::vector<float> texels(side * side, -1);
                    builder.buildStarts(tracer, request, face, texels);
                    checkQuads(builder.mesh(), tally);
                    if (face == round % 6) checkTexels(builder.mesh(), texels, faceSize, tally);
                }
        }
        options.tell((round + 1.0) / rounds);
    }
    std::vector<Row> rows;
    for (Tally& tally : tallies) {
        tally.cracks.worst = static_cast<double>(tally.cracks.failures);
        tally.cracks.what += ": cracks and overlaps";
        tally.values.what += ": reciprocal distances";
        tally.values.bound *= 1.000001;
        tally.budget.what += ": rays and quads";
        tally.texels.what += ": texels at T-junctions and everywhere";
        for (const Row& row : {tally.cracks, tally.values, tally.budget, tally.texels}) rows.push_back(row);
    }
    return rows;
}

}  // namespace app::stability
