// The heightfield importer on TIFF and GeoTIFF files.
#include "city/import/HeightfieldFile.h"
#include "tests/fuzz/FuzzTarget.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::feed({data, size}, "input.tif", [](const auto& file) { city::loadHeightfield(file); });
    return 0;
}
