#include "app/raytrace/PartedPicture.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>

#include "app/report/AsideFile.h"

namespace app {

namespace {

constexpr int rowsOfBand = 16;
constexpr char magic[8] = {'M', 'S', 'T', 'R', 'U', 'T', 'H', '1'};

class Hash {
  public:
    void add(std::uint64_t value) {
        // splitmix64's finaliser over the running hash.
        std::uint64_t z = hash_ + value + 0x9e3779b97f4a7c15ull;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
        hash_ = z ^ (z >> 31);
    }
    void add(float value) { add(std::uint64_t{std::bit_cast<std::uint32_t>(value)}); }
    void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
    template <glm::length_t n, class T>
    void add(const glm::vec<n, T>& v) {
        for (glm::length_t i = 0; i < n; ++i) add(v[i]);
    }
    void add(const glm::mat4& m) {
        for (int i = 0; i < 4; ++i) add(m[i]);
    }
    std::uint64_t value() const { return hash_; }

  private:
    std::uint64_t hash_ = 0;
};

/// Calls visit with each plane of a picture.
template <class Picture, class Visit>
void eachPlane(Picture& picture, Visit visit) {
    visit(picture.radiance);
    visit(picture.displayFactor);
    visit(picture.distance);
    visit(picture.normal);
    visit(picture.kind);
    visit(picture.vehicle);
    visit(picture.surface);
    visit(picture.fresnel);
    visit(picture.mirrored);
}

struct Head {
    char magic[8];
    std::uint64_t key;
    std::int32_t width, rows, first, reserved;
};

std::string packed(const TracedPicture& band, std::uint64_t key, int first) {
    Head head{{}, key, band.size.x, band.size.y, first, 0};
    std::memcpy(head.magic, magic, sizeof(magic));
    std::string bytes(reinterpret_cast<const char*>(&head), sizeof(head));
    eachPlane(band, [&](const auto& plane) {
        bytes.append(reinterpret_cast<const char*>(plane.data()), plane.size() * sizeof(plane[0]));
    });
    return bytes;
}

std::optional<TracedPicture> unpacked(const std::filesystem::path& file, std::uint64_t key, glm::ivec2 size,
                                      int first) {
    std::ifstream in(file, std::ios::binary);
    if (!in) return std::nullopt;
    const std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    Head head{};
    if (bytes.size() < sizeof(head)) return std::nullopt;
    std::memcpy(&head, bytes.data(), sizeof(head));
    if (std::memcmp(head.magic, magic, sizeof(magic)) != 0 || head.key != key || head.width != size.x ||
        head.rows != size.y || head.first != first)
        return std::nullopt;
    TracedPicture band;
    band.size = size;
    const std::size_t count = static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y);
    std::size_t at = sizeof(head);
    bool whole = true;
    eachPlane(band, [&](auto& plane) {
        plane.resize(count);
        const std::size_t length = count * sizeof(plane[0]);
        whole = whole && at + length <= bytes.size();
        if (whole) std::memcpy(plane.data(), bytes.data() + at, length);
        at += length;
    });
    return whole && at == bytes.size() ? std::optional(std::move(band)) : std::nullopt;
}

}  // namespace

std::uint64_t pictureKey(const city::CityModel& city, const FrameScene& frame, const View& view,
                         const TraceOptions& options) {
    Hash hash;
    hash.add(city.contentHash());
    for (const vehicles::VehiclePose& pose : frame.vehicles) {
        hash.add(std::uint64_t{pose.id} << 32 | pose.model);
        hash.add(pose.position);
        hash.add(pose.heading);
        hash.add(pose.pitch);
        hash.add(pose.wheelAngle);
        hash.add(pose.steering);
        hash.add(pose.paint);
        hash.add(std::uint64_t{pose.braking});
    }
    for (const vehicles::SignalColour colour : frame.signalColours)
        hash.add(static_cast<std::uint64_t>(colour));
    const Lighting& light = frame.lighting;
    for (const glm::vec3& v :
         {light.sunDirection, light.sunIrradiance, light.skyIrradiance, light.groundIrradiance})
        hash.add(v);
    hash.add(light.turbidity);
    hash.add(std::uint64_t{light.lampsLit});
    hash.add(view.eye);
    hash.add(view.viewFromWorld);
    hash.add(view.clipFromView);
    hash.add(static_cast<std::uint64_t>(view.size.x));
    hash.add(static_cast<std::uint64_t>(view.size.y));
    hash.add(static_cast<std::uint64_t>(options.samples));
    hash.add(static_cast<std::uint64_t>(options.bounces));
    hash.add(std::uint64_t{options.plain});
    hash.add(static_cast<std::uint64_t>(options.windows));
    hash.add(std::uint64_t{options.wet});
    hash.add(static_cast<std::uint64_t>(options.film));
    hash.add(options.mirrorFade);
    hash.add(options.seed);
    return hash.value();
}

std::optional<TracedPicture> renderInParts(const RayTracer& tracer, const View& view,
                                           const TraceOptions& options, const std::filesystem::path& folder,
                                           std::uint64_t key,
                                           const std::function<bool(int done, int total)>& carryOn) {
    TracedPicture picture;
    const int bands = (std::max(view.size.y, 0) + rowsOfBand - 1) / rowsOfBand;
    for (int band = 0; band < bands; ++band) {
        if (carryOn && !carryOn(band, bands)) return std::nullopt;
        const int first = band * rowsOfBand, end = std::min(first + rowsOfBand, view.size.y);
        const std::filesystem::path file = folder / ("rows_" + std::to_string(first) + ".part");
        std::optional<TracedPicture> rows = unpacked(file, key, {view.size.x, end - first}, first);
        if (!rows) {
            rows = tracer.renderRows(view, options, first, end);
            writeTextFile(file, packed(*rows, key, first));
        }
        picture.append(*rows);
    }
    if (carryOn) carryOn(bands, bands);
    return picture;
}

}  // namespace app
