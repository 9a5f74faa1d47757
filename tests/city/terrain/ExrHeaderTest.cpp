#include "city/terrain/ExrHeader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <string>

namespace city {
namespace {

using testing::HasSubstr;

std::string bytesOf(std::int32_t value) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    return bytes;
}

std::string attribute(const std::string& name, const std::string& type, const std::string& value) {
    return name + '\0' + type + '\0' + bytesOf(static_cast<std::int32_t>(value.size())) + value;
}

/// A channel of floats.
std::string channel(const std::string& name) {
    return name + '\0' + bytesOf(2) + bytesOf(0) + bytesOf(1) + bytesOf(1);
}

std::string window(std::int32_t width, std::int32_t height) {
    return attribute("dataWindow", "box2i",
                     bytesOf(-3) + bytesOf(7) + bytesOf(width - 4) + bytesOf(height + 6));
}

class ExrHeaderTest : public testing::Test {
  protected:
    ~ExrHeaderTest() override { std::filesystem::remove(file_); }

    ExrHeader read(const std::string& bytes) const {
        std::ofstream(file_, std::ios::binary) << bytes;
        return readExrHeader(file_);
    }
    /// Of a file with a header of these attributes, and 200 bytes behind it.
    ExrHeader readHeader(const std::string& attributes, std::int32_t version = 2) const {
        return read(bytesOf(20000630) + bytesOf(version) + attributes + std::string(1, '\0') +
                    std::string(200, 'x'));
    }

    const std::string channels_ =
        attribute("channels", "chlist", channel("B") + channel("Y") + std::string(1, '\0'));
    const std::string zip_ = attribute("compression", "compression", std::string(1, '\3'));
    const std::string rest_ = channels_ + zip_;

  private:
    std::filesystem::path file_ =
        std::filesystem::path(testing::TempDir()) / ("header-" + std::to_string(::getpid()) + ".exr");
};

TEST_F(ExrHeaderTest, tellsWhatStandsInTheHeader) {
    const ExrHeader header = readHeader(rest_ + window(30, 20) + attribute("maker", "string", "nobody"));
    EXPECT_EQ(header.fault, "");
    EXPECT_EQ(header.width, 30);
    EXPECT_EQ(header.height, 20);
    EXPECT_EQ(header.pixelBytes, 8u);
    EXPECT_EQ(header.compression, ExrHeader::Compression::zip);
}

TEST_F(ExrHeaderTest, headerCutOffAnywhereIsAFault) {
    const std::string whole = bytesOf(20000630) + bytesOf(2) + rest_ + window(30, 20) + std::string(1, '\0');
    for (std::size_t length = 0; length < whole.size(); ++length)
        EXPECT_NE(read(whole.substr(0, length)).fault, "") << length;
}

TEST_F(ExrHeaderTest, attributesStayWithinTheHeader) {
    std::string long_ = attribute("maker", "string", "nobody");
    long_.replace(long_.size() - 10, 4, bytesOf(0x7fffffff));
    EXPECT_THAT(readHeader(rest_ + window(4, 4) + long_).fault, HasSubstr("attribute maker reaches out"));
    long_.replace(long_.size() - 10, 4, bytesOf(-1));
    EXPECT_THAT(readHeader(rest_ + window(4, 4) + long_).fault, HasSubstr("attribute maker reaches out"));
    const auto faultOf = [&](const std::string& type, const std::string& value) {
        return readHeader(rest_ + window(4, 4) + attribute("a", type, value)).fault;
    };
    EXPECT_EQ(faultOf("stringvector", bytesOf(2) + "ab" + bytesOf(0)), "");
    EXPECT_NE(faultOf("stringvector", bytesOf(3) + "ab"), "");
    EXPECT_EQ(faultOf("preview", bytesOf(1) + bytesOf(2) + "12345678"), "");
    EXPECT_NE(faultOf("preview", bytesOf(30000) + bytesOf(30000) + "12345678"), "");
    EXPECT_EQ(faultOf("v2f", bytesOf(0) + bytesOf(0)), "");
    EXPECT_NE(faultOf("v2f", bytesOf(0)), "");
    EXPECT_NE(faultOf("chlist", "no end"), "");
    EXPECT_EQ(faultOf("of my own", "anything"), "");
}

TEST_F(ExrHeaderTest, sizesStayWithinWhatTheFileCanHold) {
    EXPECT_THAT(readHeader(rest_).fault, HasSubstr("0 x 0 pixels"));
    EXPECT_THAT(readHeader(zip_ + window(4, 4)).fault, HasSubstr("no channels"));
    EXPECT_THAT(readHeader(rest_ + window(65537, 1)).fault, HasSubstr("65537 x 1"));
    EXPECT_THAT(readHeader(rest_ + window(0, 4)).fault, HasSubstr("0 x 4"));
    EXPECT_THAT(readHeader(rest_ + window(4, -2147483647)).fault, HasSubstr("pixels"));
    EXPECT_THAT(readHeader(rest_ + window(4000, 4000)).fault, HasSubstr("more than the file can hold"));
    EXPECT_THAT(readHeader(rest_ + window(1, 65536)).fault, HasSubstr("more than the file can hold"))
        << "the table of blocks alone is larger";
    const auto tiles = [&](std::int32_t size) {
        return readHeader(rest_ + window(20, 20) +
                              attribute("tiles", "tiledesc", bytesOf(size) + bytesOf(size) + '\0'),
                          0x202)
            .fault;
    };
    EXPECT_EQ(tiles(16), "");
    EXPECT_THAT(tiles(1), HasSubstr("more than the file can hold")) << "a table of 400 tiles";
    EXPECT_THAT(tiles(0), HasSubstr("tiles of 0 x 0"));
    EXPECT_THAT(tiles(60000), HasSubstr("tiles of 60000 x 60000"));
}

TEST_F(ExrHeaderTest, deepDataAndSeveralPartsAreAFault) {
    EXPECT_THAT(readHeader(rest_ + window(4, 4), 0x802).fault, HasSubstr("deep"));
    EXPECT_THAT(readHeader(rest_ + window(4, 4), 0x1002).fault, HasSubstr("parts"));
    EXPECT_THAT(read("no image at all").fault, HasSubstr("no OpenEXR file"));
    EXPECT_THAT(readExrHeader("/absent.exr").fault, HasSubstr("cannot be read"));
}

}  // namespace
}  // namespace city
