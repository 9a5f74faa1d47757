// The cache's reader of reference maps as OpenEXR files, and of the list of their positions: an input that
// begins as OpenEXR files do goes to the one, others to the other.
#include "reflection/reference_maps/Store.h"
#include "tests/fuzz/FuzzTarget.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const bool picture = size > 0 && data[0] == 0x76;
    fuzz::feed({data, size}, picture ? "map_00000.exr" : "plan.txt", [&](const std::filesystem::path& file) {
        const reflection::ReferenceMapStore store(file.parent_path(), 7);
        if (picture)
            store.load(0);
        else
            store.loadPlan();
    });
    return 0;
}
