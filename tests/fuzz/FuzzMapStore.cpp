// The cache's reader of reference maps as OpenEXR files, and of the list of their positions.
#include "reflection/reference_maps/Store.h"
#include "tests/fuzz/FuzzTarget.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::feed({data, size}, ".exr", [](const std::filesystem::path& file) {
        const reflection::ReferenceMapStore store(file.parent_path(), 7);
        std::filesystem::copy_file(file, store.planFile());
        std::filesystem::rename(file, store.file(0));
        store.load(0);
        store.loadPlan();
    });
    return 0;
}
