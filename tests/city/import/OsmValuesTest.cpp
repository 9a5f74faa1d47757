#include "city/import/OsmValues.h"

#include <gtest/gtest.h>

namespace city {
namespace {

TEST(OsmValues, LengthsAsPeopleWriteThem) {
    const std::pair<const char*, double> cases[] = {
        {"12.13 m", 12.13}, {"12", 12},        {"12,5", 12.5},    {"3;4", 4},      {"4; 3", 4},
        {"40'", 12.192},    {"5'6\"", 1.6764}, {"15 ft", 4.572},  {"0.2 km", 200}, {" 7 ", 7},
        {"+3", 3},          {"-2", -2},        {"10 metres", 10}, {"80 cm", 0.8},  {"6\"", 0.1524},
    };
    for (const auto& [text, metres] : cases) {
        const auto value = parseLength(text);
        ASSERT_TRUE(value) << text;
        EXPECT_NEAR(*value, metres, 1e-9) << text;
    }
    for (const char* text :
         {"", "high", "m", "12 parsecs", "1e5", "nan", "inf", "12..5", "--3", "'", "5'x", ";"})
        EXPECT_FALSE(parseLength(text)) << text;
}

TEST(OsmValues, NumbersHaveNoUnits) {
    EXPECT_EQ(parseNumber("3"), 3);
    EXPECT_EQ(parseNumber("2.5"), 2.5);
    EXPECT_EQ(parseNumber("3;5;4"), 5);
    EXPECT_EQ(parseNumber("-1;0"), 0);
    EXPECT_FALSE(parseNumber("3 m"));
    EXPECT_FALSE(parseNumber("many"));
}

TEST(OsmValues, SpeedsInAllUnits) {
    EXPECT_NEAR(*parseSpeed("50"), 13.8889, 1e-3);
    EXPECT_NEAR(*parseSpeed("30 mph"), 13.4112, 1e-3);
    EXPECT_NEAR(*parseSpeed("30;40"), 8.3333, 1e-3);
    EXPECT_TRUE(parseSpeed("walk"));
    for (const char* text : {"none", "signals", "FI:urban", "", "0", "-5"})
        EXPECT_FALSE(parseSpeed(text)) << text;
}

TEST(OsmValues, ColoursBecomeLinear) {
    EXPECT_NEAR(parseColour("#808080")->x, 0.21586, 1e-4);
    EXPECT_NEAR(parseColour("grey")->y, 0.21586, 1e-4);
    EXPECT_EQ(*parseColour("#fff"), glm::vec3(1));
    EXPECT_EQ(*parseColour("Light Yellow"), *parseColour("#ffffe0"));
    EXPECT_NEAR(parseColour("#f00")->x, 1, 1e-6);
    for (const char* text : {"", "#12", "#xyzxyz", "#1234567", "mauve-ish", "#"})
        EXPECT_FALSE(parseColour(text)) << text;
}

}  // namespace
}  // namespace city
