#include "tests/fuzz/ReadOsm.h"

#include "city/generate/Palette.h"
#include "city/import/LoadCity.h"
#include "city/import/OsmBuildings.h"
#include "city/import/OsmGround.h"
#include "city/import/OsmReader.h"
#include "city/import/OsmStreets.h"
#include "tests/fuzz/FuzzTarget.h"

namespace fuzz {

namespace {

constexpr double size = 2000;
constexpr std::uint64_t inputsPerCity = 128;

}  // namespace

void readOsm(std::span<const std::uint8_t> bytes, const std::string& format, const std::string& name) {
    if (oneIn(inputsPerCity, bytes)) {
        feed(bytes, name, [](const auto& file) { city::loadCity(file, {.seed = 1, .size = size}); });
        return;
    }
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    orRefuse([&] {
        const city::OsmData data = city::readOsm(text, format, size);
        city::Palette palette = city::makePalette();
        city::MaterialTable materials(palette.materials);
        const city::StreetPlan streets = city::planStreets(data);
        city::planBuildings(data, streets.mainStreets, 1, materials);
        city::planGround(data);
    });
}

}  // namespace fuzz
