// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The scale of told errors, by the real pm_host: found, told, stored, and the same in any unit.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "host_shim/pictures/picture_io.h"
#include "tests/robust/host_process.h"

namespace pm::host::test {
namespace {

// The lamp's radiance at which the box's pilot says 0 stops.
constexpr double kNeutral = 8;

class ErrorScale : public HostProcess {
  protected:
    void light(int stops, const std::string& file = "box.mtl") const {
        write(file, fmt::format("newmtl light\nKd 0 0 0\nKe {0} {0} {0}\nnewmtl wall\n"
                                "Kd 0.5 0.5 0.5\n",
                                kNeutral * std::exp2(stops)));
    }
    nlohmann::json render(const std::string& name, std::vector<std::string> more) {
        std::vector<std::string> arguments{
            "box.obj",        "--size", "32x24",   "--photons",    "2000", "--passes",   "4",
            "--camera-light", "off",    "--stats", name + ".json", "-o",   name + ".exr"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        m_outcome = run(arguments);
        EXPECT_EQ(m_outcome.exitCode, 0) << m_outcome.err;
        return nlohmann::json::parse(readText(path(name + ".json")));
    }
    Picture picture(const std::string& name) const { return readExr(path(name + ".exr")); }
    std::int32_t attribute(const std::string& name) const {
        return std::get<std::int32_t>(picture(name).attributes.at("pm:errorScale"));
    }
    Outcome m_outcome;
    std::optional<int> m_passes;
};

// Told error and samples, whatever the unit; without a scale they are far off.
TEST_F(ErrorScale, MakesErrorsAndSamplesOfAnyUnitTheSame) {
    light(0);
    const auto plain = render("plain", {"--error-scale", "0"});
    EXPECT_EQ(render("auto", {}).at("errorScaleStops"), 0);
    EXPECT_EQ(readText(path("auto.exr")), readText(path("plain.exr")));
    for (const int stops : {-20, -8, -4, 4, 8, 20}) {
        light(stops);
        const auto found = render("found", {});
        EXPECT_EQ(found.at("errorScaleStops"), -stops);
        EXPECT_EQ(attribute("found"), -stops);
        EXPECT_NE(m_outcome.err.find(fmt::format("at an error scale of {} stops", -stops)),
                  std::string::npos)
            << m_outcome.err;
        for (const char* key : {"relMseEstimate", "relMseEstimateTrimmed", "relMseEstimateBias"})
            EXPECT_EQ(found.at(key), plain.at(key)) << key << " " << stops;
        EXPECT_EQ(found.at("counters").at("cameraSamples"),
                  plain.at("counters").at("cameraSamples"));
        EXPECT_EQ(found.at("plan").at("gatherRaysPerPoint"),
                  plain.at("plan").at("gatherRaysPerPoint"));
        if (stops != -20 && stops != 8) continue;
        const auto without = render("without", {"--error-scale", "0"});
        EXPECT_GT(std::abs(std::log(without.at("relMseEstimate").get<double>() /
                                    plain.at("relMseEstimate").get<double>())),
                  0.1);
        // By a target as many passes.
        const double target = 0.5 * plain.at("relMseEstimate").get<double>();
        const auto aimed = render(
            "aimed", {"--passes", "64", "--error-target", fmt::format("{}", target), "--aa", "2"});
        EXPECT_LE(aimed.at("relMseEstimate").get<double>(), target);
        if (!m_passes) m_passes = aimed.at("passesDone").get<int>();
        EXPECT_EQ(aimed.at("passesDone"), *m_passes);
    }
}

// It is a setting of the library's: explained, in hash and picture, refused in one line.
TEST_F(ErrorScale, IsASetting) {
    light(-10);
    EXPECT_NE(run({"box.obj", "--size", "32x24", "--explain"}).out.find("error scale: 10 stops"),
              std::string::npos);
    EXPECT_NE(run({"box.obj", "--size", "32x24", "--explain", "--error-scale", "-7"})
                  .out.find("error scale: -7 stops, as asked for"),
              std::string::npos);
    const auto found = render("found", {}), told = render("told", {"--error-scale", "10"});
    const auto other = render("other", {"--error-scale", "2"});
    EXPECT_EQ(found.at("hashes"), told.at("hashes"));
    EXPECT_NE(found.at("hashes").at("settings"), other.at("hashes").at("settings"));
    EXPECT_EQ(readText(path("found.exr")), readText(path("told.exr")));
    EXPECT_EQ(attribute("other"), 2);
    for (const char* wrong : {"41", "-41", "1.5", "bright"})
        expectRefusal(run({"box.obj", "--error-scale", wrong}), 2,
                      {"--error-scale", wrong, "auto", "-40", "40"});
}

// Exposure is of what is shown: it changes no bit of what is rendered.
TEST_F(ErrorScale, ExposureChangesNoLinearBit) {
    light(-12);
    render("plain", {"--exposure", "0", "-o", "a.png"});
    for (const char* exposure : {"-6", "auto", "14"}) {
        render("exposed", {"--exposure", exposure, "-o", "a.png"});
        EXPECT_EQ(readText(path("exposed.exr")), readText(path("plain.exr"))) << exposure;
    }
}

// A reference says what its error is of.
TEST_F(ErrorScale, OfAReferenceIsTakenForIt) {
    light(-10);
    render("reference", {"--seed", "9"});
    const auto found = render("found", {"--reference", "reference.exr", "--report", "r.html"});
    EXPECT_NE(m_outcome.out.find(" at an error scale of 10 stops\n"), std::string::npos)
        << m_outcome.out;
    EXPECT_NE(readText(path("r.html")).find("of values times 2^10"), std::string::npos);
    const double relMse = found.at("relMseReference");
    EXPECT_EQ(found.at("relMseReferenceErrorScaleStops"), 10);
    light(0);
    render("bright", {"--seed", "9"});
    const auto plain = render("plain", {"--reference", "bright.exr"});
    EXPECT_EQ(m_outcome.out.find("scale"), std::string::npos) << m_outcome.out;
    EXPECT_NEAR(plain.at("relMseReference").get<double>() / relMse, 1, 1e-6);
    light(-10);
    // The same picture, another scale of its own.
    const auto other =
        render("other", {"--error-scale", "0", "--aa", "3:3", "--reference", "reference.exr"});
    EXPECT_EQ(other.at("relMseReferenceErrorScaleStops"), 10);
    EXPECT_EQ(other.at("errorScaleStops"), 0);
    // One that says nothing is of the render's own.
    Picture silent = picture("reference");
    silent.attributes.erase("pm:errorScale");
    writeLinearPicture(path("reference.exr"), silent);
    EXPECT_EQ(render("own", {"--error-scale", "6", "--reference", "reference.exr"})
                  .at("relMseReferenceErrorScaleStops"),
              6);
}

// A part keeps what was found, and another doesn't fit to it.
TEST_F(ErrorScale, OfPartsIsOne) {
    light(-10);
    const auto part = [&](const char* buckets, std::vector<std::string> more) {
        std::vector<std::string> words{"box.obj",        "--size", "32x24", "--photons", "2000",
                                       "--bucket-size",  "16",     "-q",    "--buckets", buckets,
                                       "--camera-light", "off"};
        words.insert(words.end(), more.begin(), more.end());
        const Outcome outcome = run(words);
        EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    };
    part("1/2", {"-o", "1.pmpart"});
    part("2/2", {"-o", "2.pmpart"});
    part("2/2", {"-o", "told.pmpart", "--error-scale", "10"});
    part("2/2", {"-o", "other.pmpart", "--error-scale", "0"});
    const auto whole = render("whole", {});
    const Outcome merged =
        run({"merge", "1.pmpart", "2.pmpart", "-o", "m.exr", "--stats", "m.json", "-q"});
    ASSERT_EQ(merged.exitCode, 0) << merged.err;
    EXPECT_EQ(readText(path("m.exr")), readText(path("whole.exr")));
    const auto json = nlohmann::json::parse(readText(path("m.json")));
    EXPECT_EQ(json.at("errorScaleStops"), 10);
    EXPECT_EQ(json.at("relMseEstimate"), whole.at("relMseEstimate"));
    EXPECT_EQ(run({"merge", "1.pmpart", "told.pmpart", "-o", "t.exr", "-q"}).exitCode, 0);
    EXPECT_EQ(readText(path("t.exr")), readText(path("m.exr")));
    const Outcome refused = run({"merge", "1.pmpart", "other.pmpart", "-o", "o.exr", "-q"});
    EXPECT_EQ(refused.exitCode, 3) << refused.err;
    EXPECT_NE(refused.err.find("errorScale"), std::string::npos) << refused.err;
}

// A shot is of one scale: that of its first frame, unless one is told.
TEST_F(ErrorScale, OfAShotIsThatOfItsFirstFrame) {
    const std::string box = readText(path("box.obj"));
    for (const auto& [frame, stops] : {std::pair{1, -10}, {2, -5}, {3, 0}}) {
        light(stops, fmt::format("s.{}.mtl", frame));
        write(fmt::format("s.000{}.obj", frame),
              fmt::format("mtllib s.{}.mtl\n", frame) + box.substr(box.find('\n') + 1));
    }
    const auto shot = [&](std::vector<std::string> more) {
        std::vector<std::string> words{"s.####.obj", "--size",   "16x16",       "--photons",
                                       "1000",       "--frames", "1-3",         "-o",
                                       "s.####.exr", "--stats",  "s.####.json", "--camera-light",
                                       "off"};
        words.insert(words.end(), more.begin(), more.end());
        const Outcome outcome = run(words);
        EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    };
    shot({});
    for (const int frame : {1, 2, 3}) EXPECT_EQ(attribute(fmt::format("s.000{}", frame)), 10);
    // The command line that it tells repeats a frame.
    const auto json = nlohmann::json::parse(readText(path("s.0003.json")));
    auto words = json.at("commandLine").get<std::vector<std::string>>();
    words.erase(words.begin());
    const std::string third = readText(path("s.0003.exr"));
    ASSERT_EQ(run(words).exitCode, 0);
    EXPECT_EQ(readText(path("s.0003.exr")), third);
    shot({"--error-scale", "3"});
    for (const int frame : {1, 2, 3}) EXPECT_EQ(attribute(fmt::format("s.000{}", frame)), 3);
}

}  // namespace
}  // namespace pm::host::test
