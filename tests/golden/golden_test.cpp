// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Our scenes rendered by photons, against path-traced pictures stored beside this file. README.md
// tells when those may change.
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "host_shim/pictures/picture_io.h"
#include "tests/golden/golden_compare.h"
#include "tests/scene/host_test.h"
#include "tests/scene/picture_measures.h"

namespace pm::host::test {
namespace {

Picture golden(const std::string& scene) {
    return readExr(fmt::format("{}/tests/golden/references/{}.exr", PM_SOURCE_DIR, scene));
}

class Golden : public HostTest {
  protected:
    // As in make_references.py, but by photons.
    std::vector<Picture> runsOf(const std::string& scene) {
        std::vector<Picture> runs;
        for (int seed = 1; seed <= kRuns; ++seed) {
            // The settings are written into the file; only the first run's are compared.
            runs.push_back(renderExr(
                scene, {ownScene(scene), "--size", "64x48", "--aov", "stderr", "--rendering-space",
                        "Linear Rec.709", "--seed", std::to_string(seed)}));
        }
        return runs;
    }

    static constexpr int kRuns = 8;
    GoldenBounds m_bounds{
        5.0, 0.01, {"pm:integrator", "pm:passes", "pm:version", "pm:sceneHash", "pm:gatherRays"}};
};

void scale(Picture& picture, float factor) {
    for (Channel& channel : picture.channels) {
        for (float& value : channel.values) value *= factor;
    }
}

void shiftByOnePixel(Picture& picture) {
    for (Channel& channel : picture.channels) {
        std::copy_backward(channel.values.begin(), channel.values.end() - 1, channel.values.end());
    }
}

// The pictures agree with the golden one; broken on purpose they don't.
void holdWithTwins(const std::string& scene, std::vector<Picture> runs,
                   const GoldenBounds& bounds) {
    const Picture truth = golden(scene);
    const auto result = agreesWithGolden(truth, runs, bounds);
    EXPECT_TRUE(result);
    std::cout << scene << ": worst " << result.message() << "\n";

    auto shifted = runs;
    for (Picture& run : shifted) shiftByOnePixel(run);
    EXPECT_FALSE(agreesWithGolden(truth, shifted, bounds));
    for (const float factor : {0.97f, 1.03f}) {
        auto scaled = runs;
        for (Picture& run : scaled) scale(run, factor);
        EXPECT_FALSE(agreesWithGolden(truth, scaled, bounds)) << factor;
    }
    auto without = runs;
    without[0].channels.erase(without[0].channels.begin() + 5);
    EXPECT_FALSE(agreesWithGolden(truth, without, bounds));
    auto otherSpace = runs;
    std::get<std::string>(otherSpace[0].attributes.at("colorInteropID")) = "lin_ap1_scene";
    EXPECT_FALSE(agreesWithGolden(truth, otherSpace, bounds));
    auto otherWindow = runs;
    otherWindow[0].dataWindow = {1, 0, 65, 48};
    EXPECT_FALSE(agreesWithGolden(truth, otherWindow, bounds));
    runs[3].channels[1].values[100] = std::numeric_limits<float>::quiet_NaN();
    const auto withNan = agreesWithGolden(truth, runs, {1e30, 1e30, bounds.freeAttributes});
    EXPECT_FALSE(withNan);
    EXPECT_NE(std::string(withNan.message()).find("nan at 36,1"), std::string::npos);
}

// What a layer's mean may be off by: a fraction of it, for the golden picture's own noise and the
// photon map's bias, plus four standard errors of the runs.
void holdLayer(const std::string& layer, const Picture& truth, const std::vector<Picture>& runs,
               double relativeBound) {
    const Means expected = meansOf(truth, layer);
    const auto count = static_cast<double>(runs.size());
    for (std::size_t c = 0; c < 3; ++c) {
        double sum = 0.0, squares = 0.0;
        for (const Picture& run : runs) {
            const double mean = meansOf(run, layer)[c];
            sum += mean / count;
            squares += mean * mean / count;
        }
        const double error = std::sqrt(std::max(squares - sum * sum, 0.0) / (count - 1.0));
        std::cout << fmt::format("{}{}: {:.6f} +- {:.6f} by photons, {:.6f} by paths, {:+.2f} %\n",
                                 layer, "RGB"[c], sum, error, expected[c],
                                 100.0 * (sum / expected[c] - 1.0));
        EXPECT_NEAR(sum, expected[c], relativeBound * expected[c] + 4.0 * error) << layer << c;
        EXPECT_LT(error, 0.01 * expected[c]) << layer << c;
    }
}

TEST_F(Golden, CornellBox) {
    const std::vector<Picture> runs = runsOf("cornell_box");
    holdWithTwins("cornell_box", runs, m_bounds);
    holdLayer("direct.", golden("cornell_box"), runs, 0.003);
    holdLayer("indirect.", golden("cornell_box"), runs, 0.01);
}

// The caustic is the flux that glass and mirror focus, as far as the camera sees it. A path tracer
// finds it by chance, so the golden one is noisy itself: 0.8 %, three times of which are allowed.
TEST_F(Golden, CausticGlass) {
    const std::vector<Picture> runs = runsOf("caustic_glass");
    holdWithTwins("caustic_glass", runs, m_bounds);
    holdLayer("direct.", golden("caustic_glass"), runs, 0.003);
    holdLayer("indirect.", golden("caustic_glass"), runs, 0.01);
    holdLayer("caustic.", golden("caustic_glass"), runs, 0.025);
}

}  // namespace
}  // namespace pm::host::test
