#include "reflection/gl/LocalMapPass.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <glm/vec4.hpp>
#include <limits>
#include <vector>

#include "reflection/gl/Buffer.h"
#include "reflection/gl/Program.h"
#include "reflection/gl/ReferenceMapBuffer.h"
#include "reflection/gl/SkyBuffer.h"

namespace reflection {

namespace {

// Bindings and layouts (std430) of data/shaders/local_map.comp and what it includes.
constexpr GLuint mapsBinding = 0, viewsBinding = 1, jobsBinding = 2, reciprocalsBinding = 3,
                 overlaysBinding = 4, meansBinding = 5, skiesBinding = 6;
constexpr int groupSize = 8;
/// Levels that one dispatch writes.
constexpr int levelsAtOnce = 4;

struct MapView {
    std::uint32_t words = 0, chroma = 0;
    std::int32_t faceSize = 0, chromaColumns = 0;
    glm::vec3 offset{0};
    float radianceScale = 0;
};
static_assert(sizeof(MapView) == 32);

struct FaceJob {
    std::uint32_t start = 0;
    std::int32_t face = 0, layer = 0, lookups = 0;
    std::uint32_t firstView = 0, viewCount = 0;
    float agreement = 0;
    std::uint32_t overlay = 0;
    std::array<std::int32_t, 4> overlayBox{};
    std::uint32_t sky = SkyBuffer::none;
    std::array<std::uint32_t, 3> padding{};  ///< to a multiple of the box's alignment
};
static_assert(sizeof(FaceJob) == 64);

/// The processor asks no more.
constexpr std::size_t mostCandidates = 16;

std::size_t texelsOf(int faceSize) {
    return static_cast<std::size_t>(faceSize) * static_cast<std::size_t>(faceSize);
}

/// What moving objects cover of one face.
struct Overlay {
    std::array<std::int32_t, 4> box{};
    std::vector<glm::vec4> texels;
};

/// What a thread needs to make the input of one face.
struct Scratch {
    LocalMapBuilder builder;
    LocalMap drawn;
};

void drawOverlay(std::span<const MovingObject> objects, int face, int faceSize, LocalMap& drawn,
                 Overlay& out) {
    out.box = {};
    out.texels.clear();
    if (objects.empty()) return;
    if (drawn.faceSize != faceSize) drawn.resize(faceSize);
    const std::size_t offset = drawn.faceOffset(face);
    const auto depth = drawn.depth.begin() + static_cast<std::ptrdiff_t>(offset);
    std::fill_n(depth, texelsOf(faceSize), std::numeric_limits<float>::infinity());
    if (drawMovingObjects(objects, face, drawn) == 0) return;
    std::array<std::int32_t, 4> box{faceSize, faceSize, 0, 0};
    for (int y = 0; y < faceSize; ++y)
        for (int x = 0; x < faceSize; ++x) {
            if (depth[y * faceSize + x] == std::numeric_limits<float>::infinity()) continue;
            box = {std::min(box[0], x), std::min(box[1], y), std::max(box[2], x + 1),
                   std::max(box[3], y + 1)};
        }
    out.box = box;
    for (int y = box[1]; y < box[3]; ++y)
        for (int x = box[0]; x < box[2]; ++x) {
            const std::size_t i = offset + static_cast<std::size_t>(y * faceSize + x);
            out.texels.emplace_back(drawn.red[i], drawn.green[i], drawn.blue[i], drawn.depth[i]);
        }
    // Texels of the box that nothing covers keep colours of an earlier face; their depth hides them.
}

}  // namespace

struct LocalMapPass::Impl {
    explicit Impl(std::span<const PackedReferenceMap> all, std::size_t budget) : maps(all, budget) {}

    ReferenceMapBuffer maps;
    SkyBuffer skies;
    gl::Program fine, coarse;
    gl::Buffer views, jobs, reciprocals, overlays, means;
    std::size_t meansCapacity = 0;
    std::uint32_t dispatches = 0;

    tbb::enumerable_thread_specific<Scratch> scratch;
    // Of one batch, faces in order of size class.
    std::vector<MapView> viewData;
    std::vector<FaceJob> jobData;
    std::vector<float> startData;
    std::vector<Overlay> overlayOf;
    std::vector<glm::vec4> overlayData;

    std::uint64_t buildBatch(const GridTracer& tracer, std::span<const LocalMapJob* const> batch,
                             const LocalMapAtlas& atlas);
    void describe(std::span<const LocalMapJob* const> batch);
    std::uint64_t makeInput(const GridTracer& tracer, std::span<const LocalMapJob* const> batch);
    void dispatch(std::span<const LocalMapJob* const> batch, const LocalMapAtlas& atlas);
    std::span<const Candidate> candidatesOf(const LocalMapJob& job) const;
    bool holdAll(std::span<const Candidate> candidates);
};

LocalMapPass::LocalMapPass(std::span<const PackedReferenceMap> maps, std::size_t budget)
    : impl_(std::make_unique<Impl>(maps, budget)) {
    impl_->fine = gl::Program::fromFiles({"local_map.comp"});
    impl_->coarse = gl::Program::fromFiles({"local_map_coarse.comp"});
    for (gl::Buffer* buffer :
         {&impl_->views, &impl_->jobs, &impl_->reciprocals, &impl_->overlays, &impl_->means})
        *buffer = gl::Buffer::create();
}

LocalMapPass::~LocalMapPass() = default;

bool LocalMapPass::usable() const {
    return impl_->maps.places() > 0;
}
void LocalMapPass::forgetSkies() {
    impl_->skies.forget();
}
std::size_t LocalMapPass::bytes() const {
    return impl_->maps.bytes();
}
std::size_t LocalMapPass::skyBytes() const {
    return impl_->skies.bytes();
}
double LocalMapPass::bytesPerTexel() const {
    const std::size_t texels = impl_->maps.heldTexels();
    return texels == 0 ? 0 : static_cast<double>(impl_->maps.heldBytes()) / static_cast<double>(texels);
}
std::size_t LocalMapPass::mapsUploaded() const {
    return impl_->maps.uploads();
}
std::uint32_t LocalMapPass::dispatches() const {
    return impl_->dispatches;
}

std::span<const Candidate> LocalMapPass::Impl::candidatesOf(const LocalMapJob& job) const {
    const std::span<const Candidate> all = job.request.candidates;
    return all.first(std::min({all.size(), mostCandidates, maps.places()}));
}

bool LocalMapPass::Impl::holdAll(std::span<const Candidate> candidates) {
    return std::ranges::all_of(candidates, [&](const Candidate& c) { return maps.hold(*c.map); });
}

std::uint64_t LocalMapPass::build(const GridTracer& tracer, std::span<const LocalMapJob> jobs,
                                  const LocalMapAtlas& atlas) {
    impl_->dispatches = 0;
    std::uint64_t rays = 0;
    std::vector<const LocalMapJob*> batch;
    impl_->maps.startBatch();
    for (const LocalMapJob& job : jobs) {
        if (!impl_->holdAll(impl_->candidatesOf(job))) {
            rays += impl_->buildBatch(tracer, batch, atlas);
            batch.clear();
            impl_->maps.startBatch();
            // No more than there are places: this succeeds.
            impl_->holdAll(impl_->candidatesOf(job));
        }
        batch.push_back(&job);
    }
    return rays + impl_->buildBatch(tracer, batch, atlas);
}

std::uint64_t LocalMapPass::Impl::buildBatch(const GridTracer& tracer,
                                             std::span<const LocalMapJob* const> batch,
                                             const LocalMapAtlas& atlas) {
    if (batch.empty()) return 0;
    std::vector<const LocalMapJob*> bySize(batch.begin(), batch.end());
    std::ranges::stable_sort(bySize, {}, [](const LocalMapJob* job) { return job->slot.sizeClass; });
    describe(bySize);
    const std::uint64_t rays = makeInput(tracer, bySize);
    dispatch(bySize, atlas);
    return rays;
}

/// Everything but what the rays and objects give.
void LocalMapPass::Impl::describe(std::span<const LocalMapJob* const> batch) {
    viewData.clear();
    jobData.clear();
    std::size_t start = 0;
    for (const LocalMapJob* job : batch) {
        const LocalMapRequest& request = job->request;
        const std::span<const Candidate> candidates = candidatesOf(*job);
        FaceJob face;
        face.lookups = std::clamp(request.lookup.lookups, 1, 8);
        face.agreement = request.lookup.agreement;
        face.firstView = static_cast<std::uint32_t>(viewData.size());
        face.viewCount = static_cast<std::uint32_t>(candidates.size());
        for (const Candidate& c : candidates) {
            const PackedReferenceMap::Level& level = c.map->levelFor(request.faceSize);
            const BufferedLevel at = maps.levelOf(*c.map, level);
            viewData.push_back({at.words, at.chroma, level.faceSize(), level.chromaColumns(), c.offset,
                                c.map->radianceScale()});
        }
        // Without candidates a face is black, as on the processor.
        const std::uint32_t sky =
            candidates.empty() ? SkyBuffer::none : skies.firstTexelOf(request.lookup.sky);
        for (int k = 0; k < 6; ++k) {
            face.sky = sky == SkyBuffer::none
                           ? sky
                           : sky + static_cast<std::uint32_t>(k) *
                                       static_cast<std::uint32_t>(texelsOf(request.faceSize));
            face.face = k;
            face.layer = 6 * job->slot.layer + k;
            face.start = static_cast<std::uint32_t>(start);
            start += texelsOf(request.faceSize);
            jobData.push_back(face);
        }
    }
    startData.resize(start);
    overlayOf.resize(std::max(overlayOf.size(), jobData.size()));
}

std::uint64_t LocalMapPass::Impl::makeInput(const GridTracer& tracer,
                                            std::span<const LocalMapJob* const> batch) {
    std::atomic<std::uint64_t> rays{0};
    tbb::parallel_for(std::size_t{0}, jobData.size(), [&](std::size_t i) {
        const LocalMapJob& job = *batch[i / 6];
        const int face = static_cast<int>(i % 6), n = job.request.faceSize;
        Scratch& own = scratch.local();
        rays += own.builder.buildStarts(tracer, job.request, face,
                                        std::span(startData).subspan(jobData[i].start, texelsOf(n)));
        drawOverlay(job.objects, face, n, own.drawn, overlayOf[i]);
    });
    overlayData.clear();
    for (std::size_t i = 0; i < jobData.size(); ++i) {
        jobData[i].overlay = static_cast<std::uint32_t>(overlayData.size());
        jobData[i].overlayBox = overlayOf[i].box;
        overlayData.insert(overlayData.end(), overlayOf[i].texels.begin(), overlayOf[i].texels.end());
    }
    return rays;
}

void LocalMapPass::Impl::dispatch(std::span<const LocalMapJob* const> batch, const LocalMapAtlas& atlas) {
    /// Faces of one size, neighbours in the job buffer.
    struct Run {
        GLuint array, nearness;
        int faceSize;
        std::size_t firstJob, jobCount, firstMean;
    };
    std::vector<Run> runs;
    std::size_t meanCount = 0;
    for (std::size_t i = 0; i < batch.size(); ++i) {
        const auto sizeClass = static_cast<std::size_t>(batch[i]->slot.sizeClass);
        const int faceSize = localMapFaceSizes[sizeClass];
        if (i == 0 || batch[i - 1]->slot.sizeClass != batch[i]->slot.sizeClass)
            runs.push_back({atlas.wordArray(batch[i]->slot.sizeClass),
                            atlas.nearnessArray(batch[i]->slot.sizeClass), faceSize, 6 * i, 0, meanCount});
        runs.back().jobCount += 6;
        meanCount += 6 * texelsOf(faceSize / groupSize);
    }
    const auto hand = [](gl::Buffer& buffer, const auto& data, GLuint binding) {
        // An empty buffer cannot be bound to a block; its contents are not asked for then.
        using Element = typename std::remove_cvref_t<decltype(data)>::value_type;
        static const Element nothing{};
        buffer.replace(data.empty() ? std::span<const Element>(&nothing, 1) : std::span<const Element>(data));
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, buffer.name());
    };
    hand(views, viewData, viewsBinding);
    hand(jobs, jobData, jobsBinding);
    hand(reciprocals, startData, reciprocalsBinding);
    hand(overlays, overlayData, overlaysBinding);
    glBindTextureUnit(mapsBinding, maps.name());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, skiesBinding, skies.name());
    if (meanCount > meansCapacity) {
        meansCapacity = 2 * meanCount;
        means = gl::Buffer::sized(meansCapacity * sizeof(glm::vec4));
    }
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, meansBinding, means.name());

    const auto run = [&](const gl::Program& program, const Run& r, int firstLevel, int groups) {
        program.set("faceSize", r.faceSize);
        program.set("firstJob", static_cast<int>(r.firstJob));
        program.set("firstMean", static_cast<int>(r.firstMean));
        for (int k = 0; k < levelsAtOnce; ++k) {
            const int level = firstLevel + k;
            if ((r.faceSize >> level) == 0) continue;
            glBindImageTexture(static_cast<GLuint>(k), r.array, level, GL_TRUE, 0, GL_WRITE_ONLY, GL_R32UI);
        }
        glDispatchCompute(static_cast<GLuint>(groups), static_cast<GLuint>(groups),
                          static_cast<GLuint>(r.jobCount));
        ++dispatches;
    };
    fine.use();
    for (const Run& r : runs) {
        fine.set("keepNearness", static_cast<int>(r.nearness != 0));
        // Not looked at where nothing is to be kept, but what is bound must be fit for it.
        if (r.nearness != 0)
            glBindImageTexture(levelsAtOnce, r.nearness, 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_R16F);
        run(fine, r, 0, r.faceSize / groupSize);
    }
    if (std::ranges::any_of(runs, [](const Run& r) { return r.faceSize > groupSize; })) {
        glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
        coarse.use();
        for (const Run& r : runs)
            if (r.faceSize > groupSize) run(coarse, r, levelsAtOnce, 1);
    }
    // Sampled by what draws the vehicles, copied when the atlas grows, uploaded over by other methods.
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT |
                    GL_FRAMEBUFFER_BARRIER_BIT);
    glUseProgram(0);
}

}  // namespace reflection
