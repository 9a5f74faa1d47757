#include "city/import/HeightfieldFile.h"

#include <geotiff/geotiff.h>
#include <geotiff/geovalues.h>
#include <geotiff/xtiffio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>

namespace city {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class HeightfieldFileTest : public testing::Test {
  protected:
    void SetUp() override {
        folder = fs::path(testing::TempDir()) / ("heightfields-" + std::to_string(::getpid()));
        fs::create_directories(folder);
    }
    void TearDown() override { fs::remove_all(folder); }

    std::string complaint(const fs::path& file) {
        try {
            loadHeightfield(file);
        } catch (const std::runtime_error& error) {
            EXPECT_THAT(error.what(), HasSubstr(file.filename().string()));
            return error.what();
        }
        ADD_FAILURE() << "no exception for " << file;
        return "";
    }

    /// A 4 x 3 float GeoTIFF; `tags` sets what it says about its place.
    fs::path geoTiff(const char* name, const std::function<void(TIFF*, GTIF*)>& tags) {
        fs::path file = folder / name;
        TIFF* tiff = XTIFFOpen(file.c_str(), "w");
        TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, 4);
        TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, 3);
        TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 32);
        TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP);
        TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
        TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
        TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 3);
        GTIF* keys = GTIFNew(tiff);
        tags(tiff, keys);
        GTIFWriteKeys(keys);
        for (int y = 0; y < 3; ++y) {
            float row[4] = {y * 10.0f, y * 10.0f + 1, y * 10.0f + 2, y * 10.0f + 3};
            TIFFWriteScanline(tiff, row, static_cast<std::uint32_t>(y), 0);
        }
        GTIFFree(keys);
        XTIFFClose(tiff);
        return file;
    }

    fs::path folder;
};

fs::path sharedData() {
    if (const char* named = std::getenv("MIRRORSTREET_SHARED_DATA")) return named;
    return fs::path(MIRRORSTREET_SOURCE_DIR) / ".." / "shared" / "data";
}

TEST_F(HeightfieldFileTest, roundTripIsExact) {
    Heightfield field(37, 29, 0.1f, {1043000.1, -6297000.3});
    for (std::size_t k = 0; k < field.cells().size(); ++k)
        field.cells()[k] = std::ldexp(1.0f + static_cast<float>(k) * 1e-3f, static_cast<int>(k % 60) - 30) *
                           (k % 2 == 0 ? 1 : -1);
    field.set(3, 4, std::numeric_limits<float>::infinity());
    field.set(4, 4, -std::numeric_limits<float>::infinity());
    field.set(5, 4, std::numeric_limits<float>::quiet_NaN());
    field.set(6, 4, 1e-45f);
    for (const char* name : {"a.exr", "a.tif", "a.tiff"}) {
        saveHeightfield(field, folder / name);
        const LoadedHeightfield loaded = loadHeightfield(folder / name);
        ASSERT_EQ(loaded.field.width(), 37) << name;
        ASSERT_EQ(loaded.field.height(), 29) << name;
        EXPECT_EQ(loaded.field.cellSize(), 0.1f);
        EXPECT_EQ(loaded.field.origin(), field.origin());
        EXPECT_TRUE(loaded.notes.empty());
        for (std::size_t k = 0; k < field.cells().size(); ++k)
            ASSERT_EQ(std::bit_cast<std::uint32_t>(loaded.field.cells()[k]),
                      std::bit_cast<std::uint32_t>(field.cells()[k]))
                << name << ' ' << k;
    }
    int files = 0;
    for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder)) ++files;
    EXPECT_EQ(files, 3) << "nothing is left aside";
}

TEST_F(HeightfieldFileTest, geoTiffPlaceAndNoDataAreRead) {
    for (const char* name : {"i16_strip_lzw.tif", "f32_tile_deflate.tif"}) {
        const fs::path file = sharedData() / "geotiff" / name;
        if (!fs::exists(file)) GTEST_SKIP() << "needs " << file;
        const LoadedHeightfield loaded = loadHeightfield(file);
        EXPECT_EQ(loaded.field.width(), 64);
        EXPECT_EQ(loaded.field.height(), 48);
        EXPECT_EQ(loaded.field.cellSize(), 5);
        EXPECT_EQ(loaded.field.origin(), glm::dvec2(1043000, 6297000 - 48 * 5));
        EXPECT_EQ(loaded.coordinateSystem, "EPSG:2154");
        int unknown = 0;
        for (float z : loaded.field.cells()) {
            unknown += std::isnan(z);
            EXPECT_NE(z, -9999);
            // Integers divided by their range would all lie within 1 m.
        }
        EXPECT_GT(unknown, 0) << name;
        EXPECT_GT(loaded.field.highest(), 2) << name;
    }
}

TEST_F(HeightfieldFileTest, northIsUp) {
    const fs::path file = geoTiff("north.tif", [](TIFF* tiff, GTIF* keys) {
        const double scale[3] = {2, 2, 0}, tie[6] = {0, 0, 0, 100, 206, 0};
        TIFFSetField(tiff, TIFFTAG_GEOPIXELSCALE, 3, scale);
        TIFFSetField(tiff, TIFFTAG_GEOTIEPOINTS, 6, tie);
        GTIFKeySet(keys, GTModelTypeGeoKey, TYPE_SHORT, 1, ModelTypeProjected);
        GTIFKeySet(keys, ProjectedCSTypeGeoKey, TYPE_SHORT, 1, 25832);
    });
    const LoadedHeightfield loaded = loadHeightfield(file);
    EXPECT_EQ(loaded.field.origin(), glm::dvec2(100, 200));
    EXPECT_EQ(loaded.field.at(1, 2), 1) << "the first image row is the northern edge";
    EXPECT_EQ(loaded.field.at(0, 0), 20);
    EXPECT_EQ(loaded.coordinateSystem, "EPSG:25832");
}

TEST_F(HeightfieldFileTest, pixelIsPointAndMatrixAndFeetAreHonoured) {
    const fs::path file = geoTiff("matrix.tif", [](TIFF* tiff, GTIF* keys) {
        const double matrix[16] = {10, 0, 0, 1000, 0, -10, 0, 2000, 0, 0, 0, 0, 0, 0, 0, 1};
        TIFFSetField(tiff, TIFFTAG_GEOTRANSMATRIX, 16, matrix);
        GTIFKeySet(keys, GTModelTypeGeoKey, TYPE_SHORT, 1, ModelTypeProjected);
        GTIFKeySet(keys, GTRasterTypeGeoKey, TYPE_SHORT, 1, RasterPixelIsPoint);
        GTIFKeySet(keys, ProjLinearUnitsGeoKey, TYPE_SHORT, 1, Linear_Foot);
    });
    const LoadedHeightfield loaded = loadHeightfield(file);
    EXPECT_FLOAT_EQ(loaded.field.cellSize(), 3.048f);
    EXPECT_NEAR(loaded.field.origin().x, 995 * 0.3048, 1e-9);
    EXPECT_NEAR(loaded.field.origin().y, (2005 - 30) * 0.3048, 1e-9);
}

TEST_F(HeightfieldFileTest, absurdPlacesAreRefusedWithARemedy) {
    const auto placed = [](double sx, double sy, double x) {
        return [=](TIFF* tiff, GTIF*) {
            const double scale[3] = {sx, sy, 0}, tie[6] = {0, 0, 0, x, 0, 0};
            TIFFSetField(tiff, TIFFTAG_GEOPIXELSCALE, 3, scale);
            TIFFSetField(tiff, TIFFTAG_GEOTIEPOINTS, 6, tie);
        };
    };
    EXPECT_THAT(complaint(geoTiff("nan.tif", placed(std::nan(""), 1, 0))), HasSubstr("cell size"));
    EXPECT_THAT(complaint(geoTiff("zero.tif", placed(0, 0, 0))), HasSubstr("cell size"));
    EXPECT_THAT(complaint(geoTiff("oblong.tif", placed(1, 2, 0))), HasSubstr("gdalwarp -tr"));
    EXPECT_THAT(complaint(geoTiff("corner.tif", placed(1, 1, INFINITY))), HasSubstr("corner"));
    EXPECT_THAT(complaint(geoTiff("degrees.tif",
                                  [&](TIFF* tiff, GTIF* keys) {
                                      placed(0.001, 0.001, 0)(tiff, keys);
                                      GTIFKeySet(keys, GTModelTypeGeoKey, TYPE_SHORT, 1, ModelTypeGeographic);
                                  })),
                HasSubstr("degrees"));
    EXPECT_THAT(complaint(geoTiff("rotated.tif",
                                  [](TIFF* tiff, GTIF*) {
                                      const double m[16] = {1, 0.1, 0, 0, 0.1, -1, 0, 0,
                                                            0, 0,   0, 0, 0,   0,  0, 1};
                                      TIFFSetField(tiff, TIFFTAG_GEOTRANSMATRIX, 16, m);
                                  })),
                HasSubstr("rotated"));
}

TEST_F(HeightfieldFileTest, unreadableFilesAreRefused) {
    EXPECT_THAT(complaint(folder / "absent.tif"), HasSubstr("no such file"));
    std::ofstream(folder / "empty.tif").flush();
    EXPECT_THAT(complaint(folder / "empty.tif"), HasSubstr("empty"));
    std::ofstream(folder / "text.exr") << "this is not an image";
    EXPECT_THAT(complaint(folder / "text.exr"), HasSubstr("cannot be read"));
    fs::create_directories(folder / "folder.tif");
    EXPECT_THAT(complaint(folder / "folder.tif"), HasSubstr("folder"));
}

TEST_F(HeightfieldFileTest, truncatedFilesAreRefusedAtEveryLength) {
    Heightfield field(64, 64, 1, {0, 0});
    for (std::size_t k = 0; k < field.cells().size(); ++k)
        field.cells()[k] = std::sin(static_cast<float>(k * k));
    for (const char* name : {"cut.exr", "cut.tif"}) {
        saveHeightfield(field, folder / name);
        const auto whole = fs::file_size(folder / name);
        for (int part = 1; part < 10; ++part) {
            saveHeightfield(field, folder / name);
            fs::resize_file(folder / name, whole * static_cast<std::uintmax_t>(part) / 10);
            complaint(folder / name);
        }
    }
}

TEST_F(HeightfieldFileTest, failedSavesLeaveNothingBehind) {
    const Heightfield field(2, 2, 1, {0, 0});
    EXPECT_THROW(saveHeightfield(field, folder / "no" / "such" / "folder.exr"), std::runtime_error);
    EXPECT_THROW(saveHeightfield(field, folder / "picture.png"), std::runtime_error);
    EXPECT_TRUE(fs::is_empty(folder));
}

TEST_F(HeightfieldFileTest, fileWithoutPlaceSaysWhatWasAssumed) {
    const fs::path file = geoTiff("bare.tif", [](TIFF*, GTIF*) {});
    const LoadedHeightfield loaded = loadHeightfield(file, 2.5f);
    EXPECT_EQ(loaded.field.cellSize(), 2.5f);
    ASSERT_EQ(loaded.notes.size(), 1u);
    EXPECT_THAT(loaded.notes[0], HasSubstr("2.5 m"));
}

}  // namespace
}  // namespace city
