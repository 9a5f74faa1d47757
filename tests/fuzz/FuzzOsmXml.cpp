// The OpenStreetMap importer on .osm files.
#include "tests/fuzz/ReadOsm.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::readOsm({data, size}, "osm", "input.osm");
    return 0;
}
