// The cache's reader of chrome's reflectors. The hash at the end and that of the content are put right, or
// nothing would get past them.
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "reflection/chrome/ReflectionSearch.h"
#include "reflection/chrome/ReflectorStore.h"
#include "reflection/reference_maps/PackedFile.h"
#include "tests/fuzz/FuzzTarget.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    constexpr std::uint64_t content = 7;
    constexpr std::size_t magic = 8;
    std::vector<std::uint8_t> bytes(data, data + size);
    if (size >= magic + sizeof content) std::memcpy(bytes.data() + magic, &content, sizeof content);
    if (size >= sizeof(std::uint64_t)) {
        const std::size_t end = size - sizeof(std::uint64_t);
        const std::uint64_t hash = reflection::packedFileHash(std::span(bytes).first(end));
        std::memcpy(bytes.data() + end, &hash, sizeof hash);
    }
    fuzz::feed(bytes, "7.reflector", [](const auto& file) {
        const auto loaded = reflection::ReflectorStore(file.parent_path()).load(content);
        if (!loaded.reflector) {
            if (loaded.refused.empty()) std::abort();  // it is there, so something must be said of it
            return;
        }
        // What was read can be searched.
        const glm::dvec3 eye(3, -2, 1);
        const std::array<glm::dvec3, 4> vertices{glm::dvec3(2, 2, 2), {-3, 0, 0}, {0, 0, 0}, {1e6, 0, 1}};
        std::array<reflection::ReflectionPoint, 4> points;
        for (const reflection::ReflectorPiece& piece : loaded.reflector->pieces) {
            if (piece.built.map.empty()) continue;
            reflection::findReflectionPoints(piece.built.map, eye, vertices, points);
            for (const reflection::ReflectionPoint& p : points)
                if (!std::isfinite(p.point.x + p.point.y + p.point.z + p.residual + p.path)) std::abort();
        }
    });
    return 0;
}
