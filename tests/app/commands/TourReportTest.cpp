#include "app/commands/TourReport.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

namespace app {
namespace {

FrameStats frame(double ms, std::uint32_t rebuilt, std::uint64_t bytes) {
    FrameStats stats;
    stats.frameMs = ms;
    stats.reflectionMs = ms / 10;
    stats.reflections.rebuilt = rebuilt;
    stats.reflections.localMapBytes = bytes;
    return stats;
}

class TourReportTest : public testing::Test {
  protected:
    TourReportTest() {
        std::filesystem::create_directories(file.parent_path());
        options.json = file;
    }
    nlohmann::json written() const {
        std::ifstream in(file);
        return nlohmann::json::parse(in);
    }

    const std::filesystem::path file =
        std::filesystem::path(MIRRORSTREET_TEST_OUT) / "tour-report" / "report.json";
    Options options;
    std::ostringstream out;
};

TEST_F(TourReportTest, everyWayOfDrawingHasItsOwnRow) {
    TourReport report(options, "some renderer");
    DriveSettings mem, none;
    none.method = ReflectionMethod::none;
    report.add(frame(10, 2, 100), mem, {640, 360});
    report.add(frame(30, 4, 300), mem, {640, 360});
    report.add(frame(5, 0, 0), none, {640, 360});
    report.add(frame(20, 3, 200), mem, {640, 360});  // back to what there was
    report.add(frame(90, 1, 100), mem, {1280, 720});
    report.finish(false, out);

    EXPECT_EQ(report.frames(), 5u);
    const nlohmann::json document = written(), &rows = document["rows"];
    EXPECT_FALSE(document.contains("partial"));
    ASSERT_EQ(rows.size(), 3u);
    EXPECT_EQ(rows[0]["method"], "mem");
    EXPECT_EQ(rows[0]["frame_ms"]["n"], 3);
    EXPECT_EQ(rows[0]["frame_ms"]["min"], 10.0);
    EXPECT_EQ(rows[0]["frame_ms"]["median"], 20.0);
    EXPECT_EQ(rows[0]["frame_ms"]["max"], 30.0);
    EXPECT_EQ(rows[0]["maps_updated_per_frame"], 3.0);
    EXPECT_EQ(rows[0]["texture_bytes"], 300);
    EXPECT_EQ(rows[1]["method"], "none");
    EXPECT_EQ(rows[1]["frame_ms"]["n"], 1);
    EXPECT_EQ(rows[2]["width"], 1280);
    EXPECT_EQ(rows[2]["frame_ms"]["max"], 90.0);

    for (const char* text : {"mem, medium, 60, 640x360", "none, medium", "1280x720"})
        EXPECT_NE(out.str().find(text), std::string::npos) << out.str();
}

TEST_F(TourReportTest, aDriveWithoutAFrameIsAnEmptyPartialFileAndNoTable) {
    TourReport(options, "some renderer").finish(true, out);
    EXPECT_TRUE(out.str().empty());
    EXPECT_EQ(written()["partial"], true);
    EXPECT_TRUE(written()["rows"].empty());
}

}  // namespace
}  // namespace app
