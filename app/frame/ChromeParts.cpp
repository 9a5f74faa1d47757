#include "app/frame/ChromeParts.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <condition_variable>
#include <deque>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <mutex>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <thread>
#include <tuple>
#include <utility>

#include "reflection/chrome/ReflectorStore.h"

namespace app {

namespace {

/// Metres to which parts are compared: a tenth of what bends an image by a visible angle, and far above what
/// floats lose when a part is modelled in another place.
constexpr float sameWithin = 2e-5f;
constexpr float sameNormal = 1e-3f;
/// Metres below which a part shows nothing.
constexpr float leastRadius = 0.005f;

/// Sharper than 30 degrees, an edge is where one mirror ends and another begins.
constexpr float creaseCosine = 0.866f;

/// Whether two parts, each around its own centre, are the same: corner by corner, rounding aside.
bool same(const city::Mesh& a, const city::Mesh& b) {
    if (a.indices != b.indices || a.vertices.size() != b.vertices.size()) return false;
    for (std::size_t i = 0; i < a.vertices.size(); ++i) {
        const glm::vec3 moved = glm::abs(a.vertices[i].position - b.vertices[i].position);
        const glm::vec3 turned = glm::abs(a.vertices[i].normal - b.vertices[i].normal);
        if (std::max({moved.x, moved.y, moved.z}) > sameWithin ||
            std::max({turned.x, turned.y, turned.z}) > sameNormal)
            return false;
    }
    return true;
}

/// Whether every edge has two triangles that face the same way, corners joined by position.
bool closed(const city::Mesh& mesh) {
    std::map<std::tuple<float, float, float>, std::uint32_t> places;
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    const auto corner = [&](std::uint32_t i) {
        const glm::vec3& p = mesh.vertices[i].position;
        return places.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(places.size())).first->second;
    };
    for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3)
        for (std::size_t c = 0; c < 3; ++c) {
            const std::uint32_t a = corner(mesh.indices[k + c]), b = corner(mesh.indices[k + (c + 1) % 3]);
            if (a == b) continue;
            edges[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
            if (std::abs(edges[{std::min(a, b), std::max(a, b)}]) > 1) return false;
        }
    return !edges.empty() && std::ranges::all_of(edges, [](const auto& edge) { return edge.second == 0; });
}

/// By how much of a part's width its corners may lie before its triangles: facets sag, and bars that follow a
/// body's outline are a little hollow here and there.
constexpr float hollow = 0.03f;

/// Whether a closed part bulges everywhere. Of very fine ones some corners and triangles speak for all.
bool convex(const city::Mesh& mesh, float width) {
    constexpr std::size_t most = 1024;
    const std::size_t vertexStep = mesh.vertices.size() / most + 1;
    const std::size_t triangleStep = mesh.triangleCount() / most + 1;
    for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3 * triangleStep) {
        const glm::vec3& a = mesh.vertices[mesh.indices[k]].position;
        const glm::vec3 n = glm::cross(mesh.vertices[mesh.indices[k + 1]].position - a,
                                       mesh.vertices[mesh.indices[k + 2]].position - a);
        const float area = glm::length(n);
        // Slivers face anywhere.
        if (!(area > 1e-4f * width * width)) continue;
        for (std::size_t i = 0; i < mesh.vertices.size(); i += vertexStep)
            if (glm::dot(n, mesh.vertices[i].position - a) > hollow * width * area) return false;
    }
    return true;
}

float areaOf(const city::Mesh& mesh) {
    float sum = 0;
    for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
        const glm::vec3& a = mesh.vertices[mesh.indices[k]].position;
        sum += 0.5f * glm::length(glm::cross(mesh.vertices[mesh.indices[k + 1]].position - a,
                                             mesh.vertices[mesh.indices[k + 2]].position - a));
    }
    return sum;
}

std::uint32_t root(std::vector<std::uint32_t>& parents, std::uint32_t i) {
    while (parents[i] != i) i = parents[i] = parents[parents[i]];
    return i;
}

}  // namespace

std::vector<city::Mesh> chromeComponents(const city::Mesh& mesh) {
    constexpr auto chrome = static_cast<std::uint32_t>(vehicles::Surface::chrome);
    const std::size_t n = mesh.vertices.size();
    std::vector<std::uint32_t> parents(n);
    std::iota(parents.begin(), parents.end(), 0u);
    std::multimap<std::tuple<float, float, float>, std::uint32_t> places;
    for (std::uint32_t i = 0; i < n; ++i) {
        const city::Vertex& v = mesh.vertices[i];
        if (v.material != chrome) continue;
        const std::tuple place(v.position.x, v.position.y, v.position.z);
        const auto [first, last] = places.equal_range(place);
        for (auto at = first; at != last; ++at)
            if (glm::dot(mesh.vertices[at->second].normal, v.normal) > creaseCosine)
                parents[root(parents, i)] = root(parents, at->second);
        places.emplace(place, i);
    }
    const auto isChrome = [&](std::size_t k) {
        for (std::size_t c = 0; c < 3; ++c) {
            const std::uint32_t i = mesh.indices[k + c];
            if (i >= n || mesh.vertices[i].material != chrome) return false;
            const glm::vec3& p = mesh.vertices[i].position;
            if (!std::isfinite(p.x + p.y + p.z)) return false;
        }
        return true;
    };
    for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
        if (!isChrome(k)) continue;
        for (const std::size_t c : {1u, 2u})
            parents[root(parents, mesh.indices[k + c])] = root(parents, mesh.indices[k]);
    }
    std::vector<city::Mesh> components;
    std::map<std::uint32_t, std::size_t> byRoot;
    std::map<std::uint32_t, std::uint32_t> placed;
    for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
        if (!isChrome(k)) continue;
        const auto [found, isNew] = byRoot.try_emplace(root(parents, mesh.indices[k]), components.size());
        if (isNew) components.emplace_back();
        city::Mesh& component = components[found->second];
        for (std::size_t c = 0; c < 3; ++c) {
            const std::uint32_t i = mesh.indices[k + c];
            const auto [at, first] =
                placed.try_emplace(i, static_cast<std::uint32_t>(component.vertices.size()));
            if (first) component.vertices.push_back(mesh.vertices[i]);
            component.indices.push_back(at->second);
        }
    }
    return components;
}

struct ChromeParts::Shape {
    city::Mesh mesh, companion;
    std::once_flag once;
    std::atomic<bool> made{false};
    bool asked = false;  ///< of the maker
    reflection::Reflector reflector;

    /// By whichever thread comes first; all others wait.
    void make(const Keeper* keeper);
};

struct ChromeParts::Keeper {
    reflection::ReflectorStore store;
    std::function<void(const std::string&)> tell;

    reflection::Reflector reflectorOf(const city::Mesh& mesh) const;
};

reflection::Reflector ChromeParts::Keeper::reflectorOf(const city::Mesh& mesh) const {
    const std::uint64_t hash = reflection::ReflectorStore::hashOf(mesh);
    reflection::ReflectorStore::Loaded loaded = store.load(hash);
    if (loaded.reflector) return std::move(*loaded.reflector);
    if (!loaded.refused.empty() && tell) tell(loaded.refused);
    reflection::Reflector made = reflection::makeReflector(mesh);
    try {
        store.save(hash, made);
    } catch (const std::runtime_error& error) {
        if (tell) tell(error.what());
    }
    return made;
}

void ChromeParts::Shape::make(const Keeper* keeper) {
    std::call_once(once, [&] {
        const city::Mesh& whole = companion.empty() ? mesh : companion;
        reflector = keeper != nullptr ? keeper->reflectorOf(whole) : reflection::makeReflector(whole);
        // What the companion adds is for searches; the part's own pixels are what is seen.
        if (!companion.empty()) {
            reflector.pieces.resize(std::min<std::size_t>(reflector.pieces.size(), 1));
            for (reflection::ReflectorPiece& piece : reflector.pieces) piece.mesh = mesh;
        }
        made.store(true, std::memory_order_release);
    });
}

/// One thread that makes what is asked for, in the order in which it was asked for.
class ChromeParts::Maker {
  public:
    explicit Maker(const Keeper* keeper) : keeper_(keeper), thread_([this] { work(); }) {}
    ~Maker() {
        {
            const std::lock_guard lock(mutex_);
            ended_ = true;
        }
        asked_.notify_one();
        thread_.join();
    }
    void ask(Shape& shape) {
        if (shape.asked) return;
        shape.asked = true;
        {
            const std::lock_guard lock(mutex_);
            waiting_.push_back(&shape);
        }
        asked_.notify_one();
    }

  private:
    void work() {
        for (;;) {
            Shape* next = nullptr;
            {
                std::unique_lock lock(mutex_);
                asked_.wait(lock, [this] { return ended_ || !waiting_.empty(); });
                if (ended_) return;
                next = waiting_.front();
                waiting_.pop_front();
            }
            next->make(keeper_);
        }
    }

    const Keeper* keeper_;
    std::mutex mutex_;
    std::condition_variable asked_;
    std::deque<Shape*> waiting_;
    bool ended_ = false;
    std::thread thread_;  ///< last: it uses all the others
};

ChromeParts::ChromeParts() = default;
ChromeParts::~ChromeParts() = default;
ChromeParts::ChromeParts(ChromeParts&&) noexcept = default;
ChromeParts& ChromeParts::operator=(ChromeParts&&) noexcept = default;

ChromeParts::ChromeParts(std::span<const vehicles::VehicleModel> models) {
    for (const vehicles::VehicleModel& model : models) {
        std::vector<ChromePart>& parts = models_.emplace_back();
        const auto take = [&](const city::Mesh& mesh, bool onWheel) {
            for (city::Mesh& component : chromeComponents(mesh)) {
                ChromePart part;
                part.onWheel = onWheel;
                const city::Aabb bounds = component.bounds();
                part.centre = bounds.centre();
                part.half = 0.5f * (bounds.max - bounds.min);
                for (city::Vertex& v : component.vertices) {
                    v.position -= part.centre;
                    part.radius = std::max(part.radius, glm::length(v.position));
                }
                if (part.radius < leastRadius) continue;
                part.width = areaOf(component) / (2 * std::numbers::pi_v<float> * part.radius);
                part.closed = closed(component);
                part.convex = part.closed && convex(component, part.width);
                const auto known = std::ranges::find_if(
                    shapes_, [&](const auto& shape) { return same(shape->mesh, component); });
                part.shape = static_cast<std::uint32_t>(known - shapes_.begin());
                if (known == shapes_.end())
                    shapes_.emplace_back(std::make_unique<Shape>())->mesh = std::move(component);
                parts.push_back(part);
            }
        };
        if (!model.levels.empty()) take(model.levels.front().body, false);
        if (!model.wheels.empty()) take(model.wheel, true);
        std::stable_sort(parts.begin(), parts.end(),
                         [](const ChromePart& a, const ChromePart& b) { return a.width > b.width; });
    }
}

void ChromeParts::giveCompanion(std::size_t model, city::Mesh companion) {
    if (model >= models_.size() || models_[model].empty() || companion.empty()) return;
    ChromePart& part = models_[model].front();
    for (city::Vertex& v : companion.vertices) v.position -= part.centre;
    part.closed = part.convex = true;
    shapes_[part.shape]->companion = std::move(companion);
}

void ChromeParts::keepIn(const std::filesystem::path& folder, std::function<void(const std::string&)> tell) {
    keeper_ = std::make_unique<Keeper>(Keeper{reflection::ReflectorStore(folder), std::move(tell)});
}

const reflection::Reflector& ChromeParts::reflectorOf(const ChromePart& part) const {
    Shape& shape = *shapes_[part.shape];
    shape.make(keeper_.get());
    return shape.reflector;
}

bool ChromeParts::ready(const ChromePart& part) const {
    Shape& shape = *shapes_[part.shape];
    if (shape.made.load(std::memory_order_acquire)) return true;
    if (!maker_) maker_ = std::make_unique<Maker>(keeper_.get());
    maker_->ask(shape);
    return false;
}

const city::Mesh& ChromeParts::meshOf(const ChromePart& part) const {
    return shapes_[part.shape]->mesh;
}

std::size_t ChromeParts::reflectorsMade() const {
    return static_cast<std::size_t>(
        std::ranges::count_if(shapes_, [](const auto& shape) { return shape->made.load(); }));
}

std::size_t ChromeParts::bytes() const {
    std::size_t sum = 0;
    for (const auto& shape : shapes_)
        if (shape->made)
            for (const reflection::ReflectorPiece& piece : shape->reflector.pieces)
                sum += piece.built.map.bytes();
    return sum;
}

}  // namespace app
