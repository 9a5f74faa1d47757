#include "reflection/chrome/ReflectorStore.h"

#include <unistd.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <iterator>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "reflection/reference_maps/PackedFile.h"

#ifndef MIRRORSTREET_REFLECTOR_MAKER
#error "the build names the code that makes reflectors: see CMakeLists.txt"
#endif

namespace reflection {

namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::string_view magic = "MSREFL01";
/// A face of more cells is nothing that this program makes.
constexpr std::uint32_t mostCells = 4096;
constexpr const char *ending = ".reflector", *partialEnding = ".partial";
/// Nobody writes at one file for so long.
constexpr std::chrono::hours abandonedAfter{24};

class Writer {
  public:
    void addBytes(const void* from, std::size_t size) {
        const std::size_t at = bytes.size();
        bytes.resize(at + size);
        if (size > 0) std::memcpy(bytes.data() + at, from, size);
    }
    template <typename T>
    void add(const T& value) {
        static_assert(std::is_trivially_copyable_v<T>);
        addBytes(&value, sizeof(T));
    }
    template <typename T>
    void addAll(std::span<const T> values) {
        add(static_cast<std::uint64_t>(values.size()));
        addBytes(values.data(), values.size_bytes());
    }
    std::vector<std::uint8_t> bytes;
};

/// Ends at the first thing that is not there.
class Reader {
  public:
    explicit Reader(std::span<const std::uint8_t> bytes) : left_(bytes) {}
    template <typename T>
    bool take(T& value) {
        static_assert(std::is_trivially_copyable_v<T>);
        if (left_.size() < sizeof(T)) return false;
        std::memcpy(&value, left_.data(), sizeof(T));
        left_ = left_.subspan(sizeof(T));
        return true;
    }
    template <typename T>
    bool takeAll(std::vector<T>& values) {
        std::uint64_t count = 0;
        if (!take(count) || count > left_.size() / sizeof(T)) return false;
        values.resize(static_cast<std::size_t>(count));
        if (!values.empty()) std::memcpy(values.data(), left_.data(), values.size() * sizeof(T));
        left_ = left_.subspan(values.size() * sizeof(T));
        return true;
    }
    bool done() const { return left_.empty(); }

  private:
    std::span<const std::uint8_t> left_;
};

void addVertices(Writer& to, std::span<const city::Vertex> vertices) {
    to.add(static_cast<std::uint64_t>(vertices.size()));
    for (const city::Vertex& v : vertices) {
        to.add(v.position);
        to.add(v.normal);
        to.add(v.texcoord);
        to.add(v.material);
    }
}

bool takeVertices(Reader& from, std::vector<city::Vertex>& vertices) {
    std::uint64_t count = 0;
    if (!from.take(count)) return false;
    for (std::uint64_t i = 0; i < count; ++i) {
        city::Vertex v{};
        if (!from.take(v.position) || !from.take(v.normal) || !from.take(v.texcoord) ||
            !from.take(v.material))
            return false;
        vertices.push_back(v);
    }
    return true;
}

void addReport(Writer& to, const ReflectorMapReport& r) {
    for (const double x : {r.worstDistance, r.meanDistance, r.worstAngle, r.meanAngle, r.coveredShare})
        to.add(x);
    for (const std::size_t n : {r.skipped, r.overlapping, r.tilted}) to.add(static_cast<std::uint64_t>(n));
}

bool takeReport(Reader& from, ReflectorMapReport& r) {
    for (double* x : {&r.worstDistance, &r.meanDistance, &r.worstAngle, &r.meanAngle, &r.coveredShare})
        if (!from.take(*x)) return false;
    for (std::size_t* n : {&r.skipped, &r.overlapping, &r.tilted}) {
        std::uint64_t value = 0;
        if (!from.take(value)) return false;
        *n = static_cast<std::size_t>(value);
    }
    return true;
}

bool finite(const glm::dvec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// A part of this world's size, in a frame that turns and stretches.
bool sound(const MapFrame& frame) {
    constexpr double largest = 1e6, smallest = 1e-9, flattest = 1e-3, off = 1e-6;
    const glm::dmat3 square = glm::transpose(frame.axes) * frame.axes;
    for (int i = 0; i < 3; ++i) {
        if (!(glm::length(square[i] - glm::dmat3(1)[i]) < off)) return false;
        if (!(frame.stretch[i] >= flattest && frame.stretch[i] <= 1)) return false;
    }
    return finite(frame.centre) && glm::length(frame.centre) < largest && frame.scale > smallest &&
           frame.scale < largest;
}

/// Unit normals, and a surface in every direction.
bool sound(int cells, std::span<const ReflectorMap::Corner> corners) {
    constexpr double off = 1e-3, nearest = 1e-6, farthest = 1e6;
    for (int face = 0; face < 6; ++face)
        for (int row = 0; row <= cells; ++row)
            for (int column = 0; column <= cells; ++column) {
                const glm::dvec4 c(corners[ReflectorMap::cornerIndex(cells, face, column, row)]);
                const glm::dvec3 g = ReflectorMap::cornerPoint(cells, face, column, row), m(c);
                const double reciprocal = c.w * glm::dot(m, g);
                if (!(std::abs(glm::length(m) - glm::length(g)) < off * glm::length(g)) ||
                    !(reciprocal > 1 / farthest && reciprocal < 1 / nearest))
                    return false;
            }
    return true;
}

bool takePiece(Reader& from, ReflectorPiece& piece) {
    std::uint8_t bend = 0, status = 0;
    std::uint32_t cells = 0;
    MapFrame frame;
    std::vector<ReflectorMap::Corner> corners;
    std::vector<std::uint8_t> covered;
    if (!takeVertices(from, piece.mesh.vertices) || !from.takeAll(piece.mesh.indices) || !from.take(bend) ||
        !from.take(piece.margin) || !from.take(status) || !takeReport(from, piece.built.report) ||
        !from.take(cells) || bend > 1 ||
        status > static_cast<std::uint8_t>(ReflectorMapStatus::notStarShaped))
        return false;
    for (const std::uint32_t index : piece.mesh.indices)
        if (index >= piece.mesh.vertices.size()) return false;
    for (const city::Vertex& v : piece.mesh.vertices)
        if (!finite(glm::dvec3(v.position)) || !finite(glm::dvec3(v.normal))) return false;
    piece.bend = static_cast<Bend>(bend);
    piece.built.status = static_cast<ReflectorMapStatus>(status);
    if (cells == 0) return true;
    if (cells > mostCells || !from.take(frame.centre) || !from.take(frame.axes) || !from.take(frame.scale) ||
        !from.take(frame.stretch) || !from.takeAll(corners) || !from.takeAll(covered))
        return false;
    const std::size_t expected = ReflectorMap::cornerCount(static_cast<int>(cells));
    if (corners.size() != expected || covered.size() != expected || !sound(frame) ||
        !sound(static_cast<int>(cells), corners))
        return false;
    piece.built.map =
        ReflectorMap(static_cast<int>(cells), piece.bend, frame, std::move(corners), std::move(covered));
    return true;
}

}  // namespace

std::uint64_t ReflectorStore::hashOf(const city::Mesh& part, const CutOptions& options) {
    Writer w;
    const std::string_view maker = MIRRORSTREET_REFLECTOR_MAKER;
    w.addBytes(maker.data(), maker.size());
    w.add(options.cellsPerSide);
    w.add(options.leastMargin);
    addVertices(w, part.vertices);
    w.addAll(std::span<const std::uint32_t>(part.indices));
    return packedFileHash(w.bytes);
}

std::filesystem::path ReflectorStore::fileOf(std::uint64_t hash) const {
    std::ostringstream name;
    name << std::hex << hash << ending;
    return folder_ / name.str();
}

void ReflectorStore::makeRoom(const std::filesystem::path& saved) const {
    namespace fs = std::filesystem;
    struct File {
        fs::path path;
        fs::file_time_type used;
        std::uintmax_t bytes = 0;
    };
    std::vector<File> files;
    std::uintmax_t all = 0;
    const fs::file_time_type now = fs::file_time_type::clock::now();
    std::error_code error;  // whatever cannot be looked at or removed stays
    for (fs::directory_iterator at(folder_, error), end; !error && at != end; at.increment(error)) {
        std::error_code own;
        const fs::path& path = at->path();
        if (!at->is_regular_file(own) || own) continue;
        const File file{path, at->last_write_time(own), at->file_size(own)};
        if (own) continue;
        if (path.extension() == partialEnding && now - file.used > abandonedAfter) {
            fs::remove(path, own);
        } else if (path.extension() == ending) {
            all += file.bytes;
            if (path.filename() != saved.filename()) files.push_back(file);
        }
    }
    std::ranges::sort(files, [](const File& a, const File& b) {
        return a.used != b.used ? a.used < b.used : a.path < b.path;
    });
    for (const File& file : files) {
        if (all <= mostBytes_) return;
        std::error_code own;
        fs::remove(file.path, own);
        if (!own) all -= file.bytes;
    }
}

ReflectorStore::Loaded ReflectorStore::load(std::uint64_t hash) const {
    const std::filesystem::path file = fileOf(hash);
    std::ifstream in(file, std::ios::binary);
    if (!in) return {};
    const std::vector<char> text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    const std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(text.data()),
                                              text.size());
    const auto refuse = [&](const char* why) {
        return Loaded{std::nullopt, file.string() + ": " + why + "; it is made anew."};
    };
    constexpr std::size_t ends = magic.size() + 2 * sizeof(std::uint64_t);
    if (bytes.size() < ends || std::memcmp(bytes.data(), magic.data(), magic.size()) != 0)
        return refuse("no reflector of this program");
    std::uint64_t told = 0;
    std::memcpy(&told, bytes.data() + bytes.size() - sizeof told, sizeof told);
    if (packedFileHash(bytes.first(bytes.size() - sizeof told)) != told)
        return refuse("damaged, or not written to its end");
    Reader from(bytes.subspan(magic.size(), bytes.size() - magic.size() - sizeof told));
    std::uint64_t content = 0, skipped = 0, count = 0;
    Reflector reflector;
    if (!from.take(content) || content != hash) return refuse("made from something else");
    bool whole = from.take(skipped) && from.take(count);
    for (std::uint64_t i = 0; whole && i < count; ++i)
        whole = takePiece(from, reflector.pieces.emplace_back());
    if (!whole || !from.done()) return refuse("its content does not make sense");
    reflector.skipped = static_cast<std::size_t>(skipped);
    std::error_code notOurs;  // a folder that cannot be written is read all the same
    std::filesystem::last_write_time(file, std::filesystem::file_time_type::clock::now(), notOurs);
    return {std::move(reflector), {}};
}

void ReflectorStore::save(std::uint64_t hash, const Reflector& reflector) const {
    Writer w;
    w.addBytes(magic.data(), magic.size());
    w.add(hash);
    w.add(static_cast<std::uint64_t>(reflector.skipped));
    w.add(static_cast<std::uint64_t>(reflector.pieces.size()));
    for (const ReflectorPiece& piece : reflector.pieces) {
        addVertices(w, piece.mesh.vertices);
        w.addAll(std::span<const std::uint32_t>(piece.mesh.indices));
        w.add(static_cast<std::uint8_t>(piece.bend));
        w.add(piece.margin);
        w.add(static_cast<std::uint8_t>(piece.built.status));
        addReport(w, piece.built.report);
        const ReflectorMap& map = piece.built.map;
        w.add(static_cast<std::uint32_t>(map.cellsPerSide()));
        if (map.empty()) continue;
        w.add(map.frame().centre);
        w.add(map.frame().axes);
        w.add(map.frame().scale);
        w.add(map.frame().stretch);
        w.addAll(map.corners());
        w.addAll(map.coverage());
    }
    w.add(packedFileHash(w.bytes));
    const std::filesystem::path file = fileOf(hash);
    std::filesystem::path aside = file;
    aside += "." + std::to_string(::getpid()) + partialEnding;
    std::error_code error;
    std::filesystem::create_directories(folder_, error);
    std::ofstream out(aside, std::ios::binary | std::ios::trunc);
    out.write(reinterpret_cast<const char*>(w.bytes.data()), static_cast<std::streamsize>(w.bytes.size()));
    out.close();
    if (out) std::filesystem::rename(aside, file, error);
    if (out && !error) return makeRoom(file);
    std::error_code ignored;
    std::filesystem::remove(aside, ignored);
    throw std::runtime_error(file.string() + ": cannot be written" +
                             (error ? " (" + error.message() + ")" : std::string()) +
                             "; make room, mend the permissions, or name another folder in "
                             "MIRRORSTREET_CACHE.");
}

}  // namespace reflection
