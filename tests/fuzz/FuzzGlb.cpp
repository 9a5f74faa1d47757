// The vehicle importer on binary glTF files.
#include "tests/fuzz/FuzzTarget.h"
#include "vehicles/import/LoadVehicle.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::feed({data, size}, "input.glb", [](const auto& file) { vehicles::loadVehicle(file, 4.5f); });
    return 0;
}
