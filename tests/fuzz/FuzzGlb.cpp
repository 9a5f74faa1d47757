// The vehicle importer on binary glTF files. Levels of detail of many triangles, as a few bytes make by nodes
// that share a mesh, take a thousand times as long as the file: one such input in 64 gets them.
#include "tests/fuzz/FuzzTarget.h"
#include "vehicles/import/LoadVehicle.h"

namespace {

constexpr std::size_t fewTriangles = 400;
constexpr std::uint64_t inputsPerLargeVehicle = 64;

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::feed({data, size}, "input.glb", [&](const auto& file) {
        const vehicles::GltfScene scene = vehicles::readGltf(file);
        if (scene.triangles.size() <= fewTriangles || fuzz::oneIn(inputsPerLargeVehicle, {data, size}))
            vehicles::vehicleFrom(scene, file, 4.5f);
    });
    return 0;
}
