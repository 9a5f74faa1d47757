#include "app/commands/Options.h"

#include <gtest/gtest.h>

#include "app/commands/Program.h"

namespace app {
namespace {

Command tour() {
    return {.name = "tour",
            .summary = "test",
            .groups = cityOptions | trafficOptions | reflectionOptions | budgetOption | errorOptions |
                      pictureOptions | outOptions | jsonOptions | durationOptions | displayOptions,
            .benches = {},
            .run = [](const Options&) { return exitOk; }};
}

Command bench() {
    return {.name = "bench",
            .summary = "test",
            .groups = cityOptions | jsonOptions,
            .benches = {{"cars", "frames", trafficOptions | severalCars | resolutionOption},
                        {"stills", "pictures", trafficOptions | outOptions},
                        {"bodies", "options that traffic has, too, for what does not drive", bodyOption},
                        {"tracer", "rays", cellOption}},
            .run = [](const Options&) { return exitOk; }};
}

Command exporting() {
    return {.name = "export",
            .summary = "test",
            .groups = cityOptions | trafficOptions | exportOptions,
            .benches = {},
            .run = [](const Options&) { return exitOk; }};
}

Command truth() {
    return {.name = "truth",
            .summary = "test",
            .groups = cityOptions | rayOptions,
            .benches = {},
            .run = [](const Options&) { return exitOk; }};
}

ParseOutcome parse(const Command& command, std::vector<std::string> arguments) {
    return parseOptions(command, arguments);
}

/// The exit code and what was said on stderr.
std::pair<int, std::string> refused(const Command& command, std::vector<std::string> arguments) {
    testing::internal::CaptureStderr();
    const ParseOutcome outcome = parse(command, std::move(arguments));
    const std::string said = testing::internal::GetCapturedStderr();
    const int* code = std::get_if<int>(&outcome);
    return {code ? *code : -1, said};
}

TEST(OptionsTest, defaultsAreThoseOfTheHelp) {
    const ParseOutcome outcome = parse(tour(), {});
    const auto& o = std::get<Options>(outcome);
    EXPECT_EQ(o.city, "boulevard");
    EXPECT_EQ(o.method, ReflectionMethod::mem);
    EXPECT_EQ(o.mem, MemVariant::ours);
    EXPECT_EQ(o.resolution, glm::ivec2(1280, 720));
    EXPECT_EQ(o.cars, std::vector<std::uint32_t>{60});
    EXPECT_EQ(o.mapsOn, MapsOn::automatic);
    EXPECT_EQ(o.gpuMapBytes(), std::size_t{512} << 20);
    EXPECT_FALSE(o.frameCount());
}

TEST(OptionsTest, everyOptionReachesItsField) {
    const ParseOutcome outcome = parse(tour(), {"paper",
                                                "--seed",
                                                "18446744073709551615",
                                                "--size",
                                                "400",
                                                "--cars",
                                                "7",
                                                "--method",
                                                "static",
                                                "--mem",
                                                "paper",
                                                "--quality",
                                                "high",
                                                "--time",
                                                "8.5",
                                                "--resolution",
                                                "640x360",
                                                "--out",
                                                "x",
                                                "--json",
                                                "y.json",
                                                "--quiet",
                                                "--cell",
                                                "0.5",
                                                "--seconds",
                                                "2",
                                                "--fps",
                                                "25",
                                                "--maps-on",
                                                "gpu",
                                                "--gpu-map-memory",
                                                "96",
                                                "--offscreen"});
    const auto& o = std::get<Options>(outcome);
    EXPECT_EQ(o.city, "paper");
    EXPECT_EQ(o.seed, 18446744073709551615ull);
    EXPECT_EQ(o.size, 400.0);
    EXPECT_EQ(o.cars, std::vector<std::uint32_t>{7});
    EXPECT_EQ(o.method, ReflectionMethod::fixed);
    EXPECT_EQ(o.mem, MemVariant::paper);
    EXPECT_EQ(o.quality, Quality::high);
    EXPECT_EQ(o.mapsOn, MapsOn::gpu);
    EXPECT_EQ(o.gpuMapBytes(), std::size_t{96} << 20);
    EXPECT_EQ(o.hour, 8.5);
    EXPECT_EQ(o.resolution, glm::ivec2(640, 360));
    EXPECT_EQ(o.out, "x");
    EXPECT_EQ(o.json, std::filesystem::path("y.json"));
    EXPECT_TRUE(o.quiet);
    EXPECT_EQ(o.cell, 0.5);
    EXPECT_EQ(o.frameCount(), 50u);
    EXPECT_TRUE(o.offscreen);
}

TEST(OptionsTest, absurdNumbersAreRefusedAndNamed) {
    const std::vector<std::pair<std::string, std::vector<std::string>>> absurd{
        {"--size", {"nan", "inf", "-5", "0", "1e9", "12m", ""}},
        {"--seed", {"-1", "1.5", "18446744073709551616", "x"}},
        {"--cars", {"-1", "100001", "3.5", "two"}},
        {"--time", {"25", "-1", "nan"}},
        {"--cell", {"0", "nan", "-1", "51"}},
        {"--seconds", {"0", "-1", "inf"}},
        {"--frames", {"0", "-3"}},
        {"--fps", {"0", "241"}},
        {"--resolution", {"1280", "1280x", "x720", "0x0", "15x720", "99999x720", "1280x720x3", "-5x5"}},
        {"--method", {"memm", ""}},
        {"--quality", {"ultra"}},
        {"--maps-on", {"graphics", ""}},
        {"--gpu-map-memory", {"0", "nan", "70000", "all"}},
    };
    for (const auto& [option, values] : absurd)
        for (const std::string& value : values) {
            const std::string argument = std::string(option).append("=").append(value);
            const auto [code, said] = refused(tour(), {argument});
            EXPECT_EQ(code, exitUsage) << argument;
            EXPECT_NE(said.find(option), std::string::npos) << said;
        }
}

TEST(OptionsTest, raysAndBouncesAreWholeNumbersWithinTheirRange) {
    const ParseOutcome none = parse(truth(), {});
    EXPECT_EQ(std::get<Options>(none).samples, 64u);
    EXPECT_EQ(std::get<Options>(none).bounces, 3u);
    for (const auto& [samples, bounces] : {std::pair("1", "1"), std::pair("65536", "16")}) {
        const ParseOutcome outcome = parse(truth(), {"--samples", samples, "--bounces", bounces});
        ASSERT_TRUE(std::holds_alternative<Options>(outcome)) << samples;
        EXPECT_EQ(std::to_string(std::get<Options>(outcome).samples), samples);
        EXPECT_EQ(std::to_string(std::get<Options>(outcome).bounces), bounces);
    }
    const std::vector<std::pair<std::string, std::vector<std::string>>> absurd{
        {"--samples", {"0", "-1", "65537", "1.5", "many", "", "4294967297"}},
        {"--bounces", {"0", "-1", "17", "2.5", "x", "", "4294967297"}},
    };
    for (const auto& [option, values] : absurd)
        for (const std::string& value : values) {
            const std::string argument = std::string(option).append("=").append(value);
            const auto [code, said] = refused(truth(), {argument});
            EXPECT_EQ(code, exitUsage) << argument;
            EXPECT_NE(said.find(option), std::string::npos) << said;
        }
    EXPECT_EQ(refused(tour(), {"--samples", "4"}).first, exitUsage);
}

TEST(OptionsTest, aBudgetIsATimeAndExcludesAnError) {
    for (const char* text : {"16ms", "16 ms", "16"})
        EXPECT_EQ(std::get<Options>(parse(tour(), {"--budget", text})).budgetMs, 16) << text;
    EXPECT_EQ(std::get<Options>(parse(tour(), {"--budget", "8.5ms", "--fixed-quality"})).budgetMs, 8.5);
    EXPECT_EQ(std::get<Options>(parse(tour(), {"--error", "0.03"})).error, 0.03);
    for (const char* text : {"16s", "ms", "", "0", "-3ms", "nan", "inf", "1e9", "16msx"}) {
        const auto [code, said] = refused(tour(), {"--budget", text});
        EXPECT_EQ(code, exitUsage) << text;
        EXPECT_NE(said.find("--budget"), std::string::npos) << said;
    }
    EXPECT_EQ(refused(tour(), {"--budget", "16ms", "--error", "0.03"}).first, exitUsage);
    EXPECT_EQ(refused(tour(), {"--error", "2"}).first, exitUsage);
}

TEST(OptionsTest, misspeltWordsAreNamedWithTheOneThatWasMeant) {
    EXPECT_NE(refused(tour(), {"--resolutoin", "3x3"}).second.find("did you mean '--resolution'"),
              std::string::npos);
    EXPECT_NE(refused(tour(), {"--metod=mem"}).second.find("did you mean '--method'"), std::string::npos);
    EXPECT_NE(refused(tour(), {"--method", "rerendr"}).second.find("did you mean 'rerender'"),
              std::string::npos);
    EXPECT_NE(refused(tour(), {"boulevrad"}).second.find("did you mean 'boulevard'"), std::string::npos);
    const auto [code, said] = refused(tour(), {"--zzzzzzz"});
    EXPECT_EQ(code, exitUsage);
    EXPECT_EQ(said.find("did you mean"), std::string::npos) << said;
}

TEST(OptionsTest, aCityThatDoesNotExistIsBadUsage) {
    const auto [code, said] = refused(tour(), {"/nowhere/city.osm"});
    EXPECT_EQ(code, exitUsage);
    EXPECT_NE(said.find("/nowhere/city.osm"), std::string::npos);
}

TEST(OptionsTest, secondsAndFramesExcludeEachOther) {
    EXPECT_EQ(refused(tour(), {"--seconds", "2", "--frames", "3"}).first, exitUsage);
}

TEST(OptionsTest, aBenchNeedsAKnownNameAndTakesSeveralNumbersOfCars) {
    EXPECT_EQ(refused(bench(), {}).first, exitUsage);
    EXPECT_NE(refused(bench(), {"trace"}).second.find("did you mean 'tracer'"), std::string::npos);
    const ParseOutcome outcome = parse(bench(), {"cars", "paper", "--cars", "10,30,100"});
    const auto& o = std::get<Options>(outcome);
    EXPECT_EQ(o.bench, "cars");
    EXPECT_EQ(o.city, "paper");
    EXPECT_EQ(o.cars, (std::vector<std::uint32_t>{10, 30, 100}));
    EXPECT_EQ(refused(tour(), {"--cars", "10,30"}).first, exitUsage);
}

TEST(OptionsTest, theCityMayBeSpeltAsAnOptionAnywhere) {
    const auto cityOf = [](const Command& command, std::vector<std::string> arguments) {
        const ParseOutcome outcome = parse(command, std::move(arguments));
        const auto* options = std::get_if<Options>(&outcome);
        return options ? options->city : "refused";
    };
    EXPECT_EQ(cityOf(bench(), {"cars", "--city", "paper", "--cars", "10,30,100"}), "paper");
    EXPECT_EQ(cityOf(bench(), {"--city=paper", "cars"}), "paper");
    EXPECT_EQ(cityOf(tour(), {"--city", "paper"}), "paper");
    EXPECT_EQ(cityOf(tour(), {"paper", "--city", "paper"}), "paper");
    EXPECT_EQ(cityOf(bench(), {"cars"}), "boulevard");

    const auto [code, said] = refused(bench(), {"cars", "boulevard", "--city", "paper"});
    EXPECT_EQ(code, exitUsage);
    EXPECT_NE(said.find("'boulevard'"), std::string::npos) << said;
    EXPECT_NE(said.find("'paper'"), std::string::npos) << said;
    EXPECT_EQ(refused(tour(), {"--city", "/nowhere/city.osm"}).first, exitUsage);
    EXPECT_NE(refused(tour(), {"--city", "papper"}).second.find("did you mean 'paper'"), std::string::npos);
}

TEST(OptionsTest, exportWritesToItsCityAndNeverOverAnythingButAGlb) {
    const ParseOutcome outcome = parse(exporting(), {"paper", "--city", "F.glb", "--car", "C.GLB"});
    const auto& o = std::get<Options>(outcome);
    EXPECT_EQ(o.city, "paper");
    EXPECT_EQ(o.exportCity, std::filesystem::path("F.glb"));
    EXPECT_EQ(o.exportCar, std::filesystem::path("C.GLB"));
    EXPECT_FALSE(o.car);
    for (const char* city : {"paper", "helsinki.osm.pbf", ""}) {
        const auto [code, said] = refused(exporting(), {std::string("--city=") + city});
        EXPECT_EQ(code, exitUsage) << city;
        EXPECT_NE(said.find("--city"), std::string::npos) << said;
    }
    EXPECT_NE(refused(exporting(), {"--car", "taxi.obj"}).second.find("--body"), std::string::npos);
}

TEST(OptionsTest, aMeasurementRefusesWhatItDoesNotDependOn) {
    const auto [code, said] = refused(bench(), {"tracer", "--cars", "3"});
    EXPECT_EQ(code, exitUsage);
    EXPECT_NE(said.find("'tracer' does not depend on --cars"), std::string::npos) << said;
    EXPECT_EQ(refused(bench(), {"--out=x", "cars"}).first, exitUsage);
    EXPECT_EQ(refused(bench(), {"stills", "--cars", "3,4"}).first, exitUsage);
    EXPECT_NE(refused(bench(), {"tracer", "--zzzz"}).second.find("unknown option"), std::string::npos);
    const ParseOutcome stills = parse(bench(), {"stills"}), cars = parse(bench(), {"cars"});
    EXPECT_EQ(std::get<Options>(stills).cars, std::vector<std::uint32_t>{60});
    EXPECT_TRUE(std::get<Options>(cars).cars.empty()) << "the measurement has a default of its own";

    testing::internal::CaptureStdout();
    EXPECT_EQ(std::get<int>(parse(bench(), {"stills", "--help"})), exitOk);
    const std::string help = testing::internal::GetCapturedStdout();
    EXPECT_NE(help.find("--out"), std::string::npos);
    EXPECT_NE(help.find("--city"), std::string::npos);
    EXPECT_EQ(help.find("--cell"), std::string::npos);
}

TEST(OptionsTest, namesThatAreEmptyOrTheNextOptionAreRefused) {
    for (const char* option : {"--out", "--json", "--car"}) {
        EXPECT_EQ(refused(tour(), {option, ""}).first, exitUsage) << option;
        EXPECT_EQ(refused(tour(), {std::string(option) + "=", "--offscreen"}).first, exitUsage) << option;
        const auto [code, said] = refused(tour(), {option, "--offscreen"});
        EXPECT_EQ(code, exitUsage) << option;
        EXPECT_NE(said.find(option), std::string::npos) << said;
    }
    EXPECT_EQ(refused(tour(), {""}).first, exitUsage);
    const ParseOutcome outcome = parse(tour(), {"--out", "./-x"});
    EXPECT_EQ(std::get<Options>(outcome).out, "./-x");
}

TEST(OptionsTest, sizesHaveTheBoundsOfTheirCity) {
    for (const char* size : {"199", "2001"}) {
        const auto [code, said] = refused(tour(), {"--size", size});
        EXPECT_EQ(code, exitUsage) << size;
        EXPECT_NE(said.find("200 to 2000"), std::string::npos) << said;
    }
    for (const char* size : {"200", "2000"})
        EXPECT_TRUE(std::holds_alternative<Options>(parse(tour(), {"--size", size}))) << size;
    // A file may be cut smaller or larger; this source stands for one (__FILE__ may be relative).
    const std::string thisFile = MIRRORSTREET_SOURCE_DIR "/tests/app/commands/OptionsTest.cpp";
    for (const char* size : {"100", "20000"})
        EXPECT_TRUE(std::holds_alternative<Options>(parse(tour(), {thisFile, "--size", size}))) << size;
    EXPECT_NE(refused(tour(), {thisFile, "--size", "99"}).second.find("100 to 20000"), std::string::npos);
}

TEST(ProgramTest, exitCodesTellUsageFromSuccess) {
    int ran = 0;
    Command command = tour();
    command.run = [&ran](const Options& o) {
        ++ran;
        return o.quiet ? 7 : exitOk;
    };
    const std::vector<Command> commands{command};
    const auto run = [&](std::vector<std::string> arguments) {
        testing::internal::CaptureStderr();
        testing::internal::CaptureStdout();
        const int code = runProgram(commands, arguments);
        return std::tuple(code, testing::internal::GetCapturedStdout(),
                          testing::internal::GetCapturedStderr());
    };
    EXPECT_EQ(run({"tour"}), std::tuple(exitOk, std::string(), std::string()));
    EXPECT_EQ(std::get<0>(run({"tour", "-q"})), 7);
    EXPECT_EQ(ran, 2);
    const auto [help, helpOut, helpErr] = run({"tour", "--help"});
    EXPECT_EQ(help, exitOk);
    EXPECT_NE(helpOut.find("--resolution"), std::string::npos);
    EXPECT_TRUE(helpErr.empty());
    EXPECT_EQ(std::get<0>(run({"--help"})), exitOk);
    EXPECT_EQ(std::get<0>(run({})), exitUsage);
    const auto [unknown, unknownOut, unknownErr] = run({"toru"});
    EXPECT_EQ(unknown, exitUsage);
    EXPECT_NE(unknownErr.find("did you mean 'tour'"), std::string::npos);
    EXPECT_TRUE(unknownOut.empty());
    EXPECT_EQ(ran, 2);
}

}  // namespace
}  // namespace app
