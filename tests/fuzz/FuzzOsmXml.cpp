// The OpenStreetMap importer on .osm files.
#include "city/import/LoadCity.h"
#include "tests/fuzz/FuzzTarget.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::feed({data, size}, ".osm",
               [](const auto& file) { city::loadCity(file, {.seed = 1, .size = 2000}); });
    return 0;
}
