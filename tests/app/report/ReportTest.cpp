#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <sstream>

#include "app/report/AsideFile.h"
#include "app/report/Picture.h"
#include "app/report/ResultFile.h"
#include "app/report/Table.h"
#include "app/report/Timing.h"
#include "app/report/VideoWriter.h"

namespace app {
namespace {

namespace fs = std::filesystem;

/// An empty folder of this test's own.
fs::path emptyFolder() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    fs::path folder = fs::path(MIRRORSTREET_TEST_OUT) / "report" /
                      (std::string(test->test_suite_name()) + "." + test->name());
    fs::remove_all(folder);
    fs::create_directories(folder);
    return folder;
}

std::string contents(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

std::size_t entries(const fs::path& folder) {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(AsideFileTest, anUncommittedFileLeavesTheOldOneAndNothingElse) {
    const fs::path folder = emptyFolder();
    writeTextFile(folder / "a.txt", "old");
    {
        AsideFile aside(folder / "a.txt");
        std::ofstream(aside.aside()) << "half";
        EXPECT_EQ(aside.aside().extension(), ".txt");
    }
    EXPECT_EQ(contents(folder / "a.txt"), "old");
    EXPECT_EQ(entries(folder), 1u);
    writeTextFile(folder / "a.txt", "new");
    EXPECT_EQ(contents(folder / "a.txt"), "new");
    EXPECT_EQ(entries(folder), 1u);
}

TEST(AsideFileTest, makesItsFolderAndNamesWhatItCannotMake) {
    const fs::path folder = emptyFolder();
    writeTextFile(folder / "deep" / "er" / "a.txt", "x");
    EXPECT_EQ(contents(folder / "deep" / "er" / "a.txt"), "x");
    try {
        writeTextFile(folder / "deep" / "er" / "a.txt" / "b.txt", "x");
        FAIL();
    } catch (const std::runtime_error& error) {
        EXPECT_NE(std::string(error.what()).find("a.txt"), std::string::npos);
    }
}

TEST(AsideFileTest, whatCannotBeWrittenIsToldBeforeTheWork) {
    const fs::path folder = emptyFolder();
    requireWritable(folder / "deep" / "a.json");
    EXPECT_EQ(entries(folder / "deep"), 0u);
    writeTextFile(folder / "a.json", "old");
    requireWritable(folder / "a.json");
    EXPECT_EQ(contents(folder / "a.json"), "old");
    EXPECT_EQ(entries(folder), 2u);
    EXPECT_THROW(requireWritable(folder / "deep"), std::runtime_error) << "a folder has that name";
    EXPECT_THROW(requireWritable(folder / "a.json" / "b.json"), std::runtime_error);
    EXPECT_THROW(requireWritable(""), std::runtime_error);
}

TEST(TimingTest, minMedianMaxOfOddAndEvenCounts) {
    const Timing odd = timingOf({5, 1, 9});
    EXPECT_EQ(odd.min, 1);
    EXPECT_EQ(odd.median, 5);
    EXPECT_EQ(odd.max, 9);
    EXPECT_EQ(odd.n, 3u);
    EXPECT_EQ(timingOf({4, 1, 3, 2}).median, 2.5);
    EXPECT_EQ(timingOf({7}).median, 7);
    EXPECT_EQ(timingOf({}).n, 0u);
}

TEST(ResultFileTest, hasTheAgreedShape) {
    ResultFile results("cars", "1.2.3", "llvmpipe");
    results.add({{"method", "mem"},
                 {"frame_ms", toJson(timingOf({1, 2, 3}))},
                 {"psnr_db", std::numeric_limits<double>::infinity()}});
    const fs::path file = emptyFolder() / "r.json";
    results.write(file, false);
    const auto read = nlohmann::json::parse(contents(file));
    EXPECT_EQ(read["bench"], "cars");
    EXPECT_EQ(read["version"], "1.2.3");
    EXPECT_EQ(read["renderer"], "llvmpipe");
    EXPECT_TRUE(read["cpu"].is_string());
    EXPECT_FALSE(read.contains("partial"));
    ASSERT_EQ(read["rows"].size(), 1u);
    EXPECT_EQ(read["rows"][0]["frame_ms"]["median"], 2);
    EXPECT_EQ(read["rows"][0]["frame_ms"]["n"], 3);
    EXPECT_TRUE(read["rows"][0]["psnr_db"].is_null());
    EXPECT_TRUE(toJson(Timing{}).is_null());
}

TEST(ResultFileTest, cutShortResultsSayThatTheyArePartial) {
    ResultFile results("cars", "1", "");
    const fs::path file = emptyFolder() / "r.json";
    results.write(file, true);
    const auto read = nlohmann::json::parse(contents(file));
    EXPECT_EQ(read["partial"], true);
    EXPECT_TRUE(read["rows"].is_array());
    EXPECT_TRUE(read["rows"].empty());
}

TEST(TableTest, columnsAlign) {
    EXPECT_EQ(formatTable({{"name", "ms"}, {"a", "10.5"}, {"longer", "3"}}),
              "name      ms\n"
              "------------\n"
              "a       10.5\n"
              "longer     3\n");
    EXPECT_EQ(formatTable({}), "");
    EXPECT_EQ(formatTable({{"m²", "x"}, {"abc", "y"}}), "m²   x\n------\nabc  y\n");
}

TEST(TableTest, numbersForPeople) {
    EXPECT_EQ(fixed(1.005, 1), "1.0");
    EXPECT_EQ(fixed(std::nan(""), 1), "-");
    EXPECT_EQ(fixed(1e300, 2).size(), 301u + 3u);
    EXPECT_EQ(byteSize(512), "512 B");
    EXPECT_EQ(byteSize(1536), "1.5 KiB");
    EXPECT_EQ(byteSize(20.0 * 1024 * 1024), "20.0 MiB");
}

Picture gradient(int width, int height, int shift) {
    Picture picture{width, height, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 4; ++c)
                picture.rgba.push_back(static_cast<std::uint8_t>((x * 3 + y * 2 + c * 40 + shift) & 255));
    return picture;
}

TEST(PictureTest, emptyPicturesAndBadPlacesAreRefused) {
    const fs::path folder = emptyFolder();
    EXPECT_THROW(writePng({}, folder / "a.png"), std::runtime_error);
    EXPECT_THROW(writePng({4, 4, {1, 2, 3}}, folder / "a.png"), std::runtime_error);
    EXPECT_EQ(entries(folder), 0u);
    writePng(gradient(33, 17, 0), folder / "b.png");
    EXPECT_EQ(entries(folder), 1u);
    const Picture written = gradient(33, 17, 0);
    auto input = OIIO::ImageInput::open((folder / "b.png").string());
    ASSERT_TRUE(input);
    ASSERT_EQ(input->spec().width, 33);
    ASSERT_EQ(input->spec().height, 17);
    ASSERT_EQ(input->spec().nchannels, 3);
    std::vector<std::uint8_t> read(std::size_t{33} * 17 * 3);
    ASSERT_TRUE(input->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, read.data()));
    for (std::size_t i = 0; i < read.size(); ++i) ASSERT_EQ(read[i], written.rgba[i / 3 * 4 + i % 3]);
}

/// What ffprobe says about a file: "width,height,frames".
std::string probe(const fs::path& file) {
    const std::string command =
        "ffprobe -v error -count_frames -select_streams v:0 -show_entries stream=width,height,nb_read_frames "
        "-of csv=p=0 '" +
        file.string() + "'";
    FILE* pipe = popen(command.c_str(), "r");
    std::string text;
    for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) text += static_cast<char>(c);
    pclose(pipe);
    return text;
}

TEST(VideoWriterTest, everyFrameArrivesAndOddSizesArePadded) {
    if (!VideoWriter::available()) GTEST_SKIP() << "no ffmpeg here";
    const fs::path folder = emptyFolder();
    VideoWriter video(folder / "v.mp4", 65, 47, 30);
    for (int i = 0; i < 12; ++i) video.add(gradient(65, 47, i * 5));
    EXPECT_THROW(video.add(gradient(64, 47, 0)), std::runtime_error);
    video.finish();
    EXPECT_EQ(probe(folder / "v.mp4"), "66,48,12\n");
    EXPECT_EQ(entries(folder), 1u);
}

TEST(VideoWriterTest, whatIsDroppedHalfwayIsStillPlayable) {
    if (!VideoWriter::available()) GTEST_SKIP() << "no ffmpeg here";
    const fs::path folder = emptyFolder();
    {
        VideoWriter video(folder / "v.mp4", 64, 48, 30);
        for (int i = 0; i < 5; ++i) video.add(gradient(64, 48, i * 5));
    }
    EXPECT_EQ(probe(folder / "v.mp4"), "64,48,5\n");
    { VideoWriter none(folder / "none.mp4", 64, 48, 30); }
    EXPECT_EQ(entries(folder), 1u);
}

TEST(VideoWriterTest, namesLikeOptionsOrProtocolsAreNames) {
    if (!VideoWriter::available()) GTEST_SKIP() << "no ffmpeg here";
    const fs::path folder = emptyFolder(), before = fs::current_path();
    fs::current_path(folder);
    for (const char* name : {"-y.mp4", "pipe:1.mp4", "with space.mp4"}) {
        VideoWriter video(name, 64, 48, 30);
        video.add(gradient(64, 48, 5));
        video.finish();
        EXPECT_EQ(probe(folder / name), "64,48,1\n") << name;
    }
    fs::current_path(before);
    EXPECT_EQ(entries(folder), 3u);
}

TEST(PictureTest, base64IsThatOfTheStandard) {
    // RFC 4648, section 10.
    const auto of = [](const std::string& text) { return base64({text.begin(), text.end()}); };
    EXPECT_EQ(of(""), "");
    EXPECT_EQ(of("f"), "Zg==");
    EXPECT_EQ(of("fo"), "Zm8=");
    EXPECT_EQ(of("foo"), "Zm9v");
    EXPECT_EQ(of("foobar"), "Zm9vYmFy");
    EXPECT_EQ(base64({0xff, 0xfe, 0xfb}), "//77");
}

TEST(PictureTest, picturesInPagesAreWholeFiles) {
    const Picture picture{5, 3, std::vector<std::uint8_t>(5 * 3 * 4, 200)};
    const std::vector<unsigned char> png = encodePicture(picture, PictureFormat::png),
                                     jpeg = encodePicture(picture, PictureFormat::jpeg);
    ASSERT_GT(png.size(), 8u);
    EXPECT_EQ(png[1], 'P');
    ASSERT_GT(jpeg.size(), 4u);
    EXPECT_EQ(jpeg[0], 0xff);
    EXPECT_EQ(jpeg.back(), 0xd9);
    EXPECT_TRUE(dataUrl(picture, PictureFormat::jpeg).starts_with("data:image/jpeg;base64,"));
    EXPECT_THROW(encodePicture({}, PictureFormat::png), std::runtime_error);
}

}  // namespace
}  // namespace app
