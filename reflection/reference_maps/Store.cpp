#include "reflection/reference_maps/Store.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfEnvmap.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfVecAttribute.h>

#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <stdexcept>

#include "city/terrain/ExrHeader.h"
#include "reflection/reference_maps/CubeMapping.h"

namespace reflection {

namespace {

constexpr const char* remedy =
    "make room, mend the permissions, or name another folder in MIRRORSTREET_CACHE.";
constexpr const char* hashAttribute = "mirrorstreetContent";
constexpr const char* positionAttribute = "mirrorstreetPosition";
constexpr const char* checksumAttribute = "mirrorstreetChecksum";
constexpr int greatestFace = 8192;

std::string hex(std::uint64_t value) {
    std::ostringstream text;
    text << std::hex << std::setfill('0') << std::setw(16) << value;
    return text.str();
}

/// Of all that a map consists of, as it is stored (FNV-1a over 32-bit words). OpenEXR has none of its own: it
/// would take a changed byte in the position or in a block that did not compress.
std::uint64_t checksumOf(const ReferenceMap& map) {
    std::uint64_t sum = 14695981039346656037ULL;
    const auto add = [&sum](std::uint64_t word) { sum = (sum ^ (word & 0xffffffffu)) * 1099511628211ULL; };
    for (int k = 0; k < 3; ++k) {
        const auto bits = std::bit_cast<std::uint64_t>(map.position[k]);
        add(bits);
        add(bits >> 32);
    }
    add(static_cast<std::uint64_t>(map.faceSize));
    for (std::size_t i = 0; i < map.texelCount(); ++i) {
        for (int k = 0; k < 3; ++k) add(std::bit_cast<std::uint32_t>(map.colour[i][k]));
        add(std::bit_cast<std::uint32_t>(map.distance[i]));
    }
    return sum;
}

/// Pixel in OpenEXR's picture for every texel of ours.
std::vector<std::size_t> pictureIndex(int n) {
    const Imath::Box2i window(Imath::V2i(0, 0), Imath::V2i(n - 1, 6 * n - 1));
    // OpenEXR counts 0 .. n-1 from edge to edge; ask it for the direction that it gives this texel's number,
    // drawn in a little so that an edge texel does not slip onto the next face.
    const auto pixel = [&](const CubeFace& f, int x, int y) {
        const float inside = 1 - 1e-4f;
        const float s = (2.0f * static_cast<float>(x) / static_cast<float>(n - 1) - 1) * inside;
        const float t = (2.0f * static_cast<float>(y) / static_cast<float>(n - 1) - 1) * inside;
        const glm::vec3 d = f.major + s * f.sAxis + t * f.tAxis;
        Imf::CubeMapFace exrFace;
        Imath::V2f within;
        Imf::CubeMap::faceAndPixelPosition(Imath::V3f(d.x, d.y, d.z), window, exrFace, within);
        const Imath::V2f at = Imf::CubeMap::pixelPosition(exrFace, window, within);
        return std::lround(at.y) * n + std::lround(at.x);
    };
    std::vector<std::size_t> index(6 * static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
    std::size_t i = 0;
    for (const CubeFace& f : cubeFaces) {
        // Faces are only turned and mirrored: a corner and two steps tell the rest.
        const long corner = pixel(f, 0, 0);
        const long alongX = (pixel(f, n - 1, 0) - corner) / (n - 1),
                   alongY = (pixel(f, 0, n - 1) - corner) / (n - 1);
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x, ++i)
                index[i] = static_cast<std::size_t>(corner + x * alongX + y * alongY);
    }
    return index;
}

void renameInto(const std::filesystem::path& aside, const std::filesystem::path& file) {
    std::error_code error;
    std::filesystem::rename(aside, file, error);
    if (error) {
        const std::string cause = error.message();
        std::filesystem::remove(aside, error);
        throw std::runtime_error(file.string() + ": the finished file could not be put in place (" + cause +
                                 "); " + remedy);
    }
}

std::filesystem::path asideOf(const std::filesystem::path& file) {
    return file.parent_path() / (file.filename().string() + ".partial");
}

}  // namespace

ReferenceMapStore::ReferenceMapStore(std::filesystem::path folder, std::uint64_t contentHash)
    : folder_(std::move(folder)), contentHash_(contentHash) {}

std::filesystem::path ReferenceMapStore::file(std::size_t index) const {
    std::ostringstream name;
    name << "map_" << std::setfill('0') << std::setw(5) << index << ".exr";
    return folder_ / name.str();
}

std::filesystem::path ReferenceMapStore::packedFile(std::size_t index) const {
    return file(index).replace_extension(".packed");
}

void ReferenceMapStore::save(std::size_t index, const ReferenceMap& map) const {
    const std::filesystem::path target = file(index);
    const int n = map.faceSize;
    std::error_code error;
    std::filesystem::create_directories(folder_, error);
    if (error)
        throw std::runtime_error(folder_.string() + ": the cache folder cannot be made (" + error.message() +
                                 "); " + remedy);

    const std::vector<std::size_t> picture = pictureIndex(n);
    std::vector<Imath::half> red(map.texelCount()), green(map.texelCount()), blue(map.texelCount());
    std::vector<float> distance(map.texelCount());
    ReferenceMap stored = map;
    for (std::size_t i = 0; i < map.texelCount(); ++i) {
        const auto half = [](float x) { return Imath::half(std::min(x, 65504.0f)); };
        red[picture[i]] = half(map.colour[i].r);
        green[picture[i]] = half(map.colour[i].g);
        blue[picture[i]] = half(map.colour[i].b);
        distance[picture[i]] = map.distance[i];
        stored.colour[i] = {red[picture[i]], green[picture[i]], blue[picture[i]]};
    }

    const std::filesystem::path aside = asideOf(target);
    try {
        Imf::Header header(n, 6 * n);
        header.compression() = Imf::ZIP_COMPRESSION;
        Imf::addEnvmap(header, Imf::ENVMAP_CUBE);
        header.insert(hashAttribute, Imf::StringAttribute(hex(contentHash_)));
        header.insert(checksumAttribute, Imf::StringAttribute(hex(checksumOf(stored))));
        header.insert(positionAttribute,
                      Imf::V3dAttribute(Imath::V3d(map.position.x, map.position.y, map.position.z)));
        Imf::FrameBuffer pixels;
        const auto add = [&](const char* name, Imf::PixelType type, void* data, std::size_t size) {
            header.channels().insert(name, Imf::Channel(type));
            pixels.insert(
                name, Imf::Slice(type, static_cast<char*>(data), size, size * static_cast<std::size_t>(n)));
        };
        add("R", Imf::HALF, red.data(), sizeof(Imath::half));
        add("G", Imf::HALF, green.data(), sizeof(Imath::half));
        add("B", Imf::HALF, blue.data(), sizeof(Imath::half));
        add("Z", Imf::FLOAT, distance.data(), sizeof(float));
        Imf::OutputFile out(aside.string().c_str(), header, 1);
        out.setFrameBuffer(pixels);
        out.writePixels(6 * n);
    } catch (const std::exception& e) {
        std::filesystem::remove(aside, error);
        throw std::runtime_error(target.string() + ": a reference map could not be written (" + e.what() +
                                 "); " + remedy);
    }
    renameInto(aside, target);
}

std::filesystem::path ReferenceMapStore::planFile() const {
    return folder_ / "plan.txt";
}

ReferenceMapStore::Loaded ReferenceMapStore::load(std::size_t index) const {
    const std::filesystem::path source = file(index);
    std::error_code error;
    if (!std::filesystem::exists(source, error)) return {};
    try {
        // Before OpenEXR sees it: it makes room for whatever a header tells of.
        const city::ExrHeader told = city::readExrHeader(source);
        if (!told.fault.empty()) return {std::nullopt, told.fault};
        if (told.compression != city::ExrHeader::Compression::zip)
            return {std::nullopt, "is not packed as reference maps are"};
        if (told.width < 4 || told.width % 2 != 0 || told.width > greatestFace ||
            told.height != 6 * told.width)
            return {std::nullopt, "is not six even square faces"};
        Imf::InputFile in(source.string().c_str(), 1);
        const Imf::Header& header = in.header();
        const auto* hash = header.findTypedAttribute<Imf::StringAttribute>(hashAttribute);
        const auto* position = header.findTypedAttribute<Imf::V3dAttribute>(positionAttribute);
        if (!hash || hash->value() != hex(contentHash_))
            return {std::nullopt, "made from another city or light"};
        if (!position || !std::isfinite(position->value().x + position->value().y + position->value().z))
            return {std::nullopt, "has no position"};
        const Imath::Box2i window = header.dataWindow();
        const auto n = static_cast<int>(told.width);
        for (const char* channel : {"R", "G", "B", "Z"})
            if (!header.channels().findChannel(channel))
                return {std::nullopt, std::string("lacks channel ") + channel};

        ReferenceMap map;
        map.faceSize = n;
        map.position = {position->value().x, position->value().y, position->value().z};
        std::array<std::vector<float>, 4> planes;
        Imf::FrameBuffer pixels;
        const char* names[] = {"R", "G", "B", "Z"};
        for (std::size_t c = 0; c < 4; ++c) {
            planes[c].resize(map.texelCount());
            const std::size_t stride = sizeof(float) * static_cast<std::size_t>(n);
            // OpenEXR counts from pixel (0, 0) even when the window starts elsewhere.
            char* origin = reinterpret_cast<char*>(planes[c].data()) -
                           static_cast<std::ptrdiff_t>(window.min.x) * 4 -
                           static_cast<std::ptrdiff_t>(window.min.y) * static_cast<std::ptrdiff_t>(stride);
            pixels.insert(names[c], Imf::Slice(Imf::FLOAT, origin, sizeof(float), stride));
        }
        in.setFrameBuffer(pixels);
        in.readPixels(window.min.y, window.max.y);

        const std::vector<std::size_t> picture = pictureIndex(n);
        map.colour.resize(map.texelCount());
        map.distance.resize(map.texelCount());
        for (std::size_t i = 0; i < map.texelCount(); ++i) {
            map.colour[i] = {planes[0][picture[i]], planes[1][picture[i]], planes[2][picture[i]]};
            map.distance[i] = planes[3][picture[i]];
            if (std::isnan(map.distance[i]) || map.distance[i] < 0)
                return {std::nullopt, "holds a distance that is not a distance"};
        }
        const auto* checksum = header.findTypedAttribute<Imf::StringAttribute>(checksumAttribute);
        if (!checksum) return {std::nullopt, "has no checksum"};
        if (checksum->value() != hex(checksumOf(map))) return {std::nullopt, "does not match its checksum"};
        return {std::move(map), {}};
    } catch (const std::exception& e) {
        return {std::nullopt, e.what()};
    }
}

void ReferenceMapStore::savePlan(const Plan& plan) const {
    std::error_code error;
    std::filesystem::create_directories(folder_, error);
    if (error)
        throw std::runtime_error(folder_.string() + ": the cache folder cannot be made (" + error.message() +
                                 "); " + remedy);
    const std::filesystem::path target = planFile();
    const std::filesystem::path aside = asideOf(target);
    {
        std::ofstream out(aside);
        out << "mirrorstreet-plan 1 " << hex(contentHash_) << ' ' << plan.positions.size() << ' '
            << std::setprecision(17) << plan.coverage << '\n';
        for (const glm::dvec3& p : plan.positions) out << p.x << ' ' << p.y << ' ' << p.z << '\n';
        out << "end\n";
        out.close();
        if (!out) {
            const std::string cause = std::strerror(errno);
            std::filesystem::remove(aside, error);
            throw std::runtime_error(target.string() + ": the list of reference maps cannot be written (" +
                                     cause + "); " + remedy);
        }
    }
    renameInto(aside, target);
}

std::optional<ReferenceMapStore::Plan> ReferenceMapStore::loadPlan() const {
    std::ifstream in(planFile());
    std::string word, version, hash, last;
    std::size_t count = 0;
    Plan plan;
    // No memory for what the file does not hold: a position is three digits and three blanks at least.
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(planFile(), error);
    if (error) return std::nullopt;
    const std::uintmax_t most = size / 6;
    if (!(in >> word >> version >> hash >> count >> plan.coverage) || word != "mirrorstreet-plan" ||
        version != "1" || hash != hex(contentHash_) || count > most || !std::isfinite(plan.coverage))
        return std::nullopt;
    plan.positions.resize(count);
    for (glm::dvec3& p : plan.positions)
        if (!(in >> p.x >> p.y >> p.z) || !std::isfinite(p.x + p.y + p.z)) return std::nullopt;
    if (!(in >> last) || last != "end") return std::nullopt;
    return plan;
}

}  // namespace reflection
