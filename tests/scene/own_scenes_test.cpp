// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The repository's scenes by path tracing, against the pictures of tests/golden, which hold photons
// as well: no light is lost or made by either. Standard errors come from runs with different seeds.
#include <fmt/format.h>

#include <cmath>
#include <map>

#include "host_shim/pictures/picture_io.h"
#include "tests/scene/host_test.h"
#include "tests/scene/picture_measures.h"

namespace pm::host::test {
namespace {

struct Estimate {
    double mean{}, error{};
};

Estimate estimate(const std::vector<double>& values) {
    const auto count = static_cast<double>(values.size());
    double sum = 0.0, squares = 0.0;
    for (const double value : values) sum += value;
    for (const double value : values) squares += (value - sum / count) * (value - sum / count);
    return {sum / count, std::sqrt(squares / (count * (count - 1.0)))};
}

class OwnScenes : public HostTest {
  protected:
    // R + G + B of a layer's mean, of the picture without the lamp's own light when prefix is "".
    // The lamp is left out because its outline is much noise and no test of what is lost.
    static double sumOf(const Picture& picture, const std::string& prefix) {
        const Means all = meansOf(picture, prefix);
        const Means lamp = prefix.empty() ? meansOf(picture, "emission.") : Means{};
        return all[0] + all[1] + all[2] - lamp[0] - lamp[1] - lamp[2];
    }
    Estimate measure(const std::string& scene, const std::string& passes,
                     const std::string& prefix) {
        std::vector<double> values;
        for (int seed = 1; seed <= 4; ++seed) {
            const Picture& picture = pictureOf(scene, passes, seed);
            EXPECT_TRUE(allFinite(picture));
            values.push_back(sumOf(picture, prefix));
        }
        return estimate(values);
    }

    void expectGolden(const std::string& scene, const std::string& passes,
                      const std::string& prefix, double relativeBound, double sigmas) {
        const Estimate path = measure(scene, passes, prefix);
        const double golden =
            sumOf(readExr(fmt::format("{}/tests/golden/references/{}.exr", PM_SOURCE_DIR, scene)),
                  prefix);
        const double off = path.mean - golden;
        std::cout << fmt::format("{} {}: path {:.5f} +- {:.5f}, golden {:.5f}, {:+.2f} %\n", scene,
                                 prefix, path.mean, path.error, golden, 100.0 * off / golden);
        EXPECT_LT(std::fabs(off), relativeBound * golden + sigmas * path.error) << scene << prefix;
        // A bound that noise makes wide would hold nothing.
        EXPECT_LT(path.error, 0.02 * golden) << scene << prefix;
    }

  private:
    const Picture& pictureOf(const std::string& scene, const std::string& passes, int seed) {
        const std::string name = fmt::format("{}-{}", scene, seed);
        auto found = m_pictures.find(name);
        if (found == m_pictures.end()) {
            const Arguments small{ownScene(scene),
                                  "--integrator",
                                  "path",
                                  "--passes",
                                  passes,
                                  "--size",
                                  "64x48",
                                  "--rendering-space",
                                  "Linear Rec.709",
                                  "--seed",
                                  std::to_string(seed)};
            found = m_pictures.emplace(name, renderExr(name, small)).first;
        }
        return found->second;
    }
    std::map<std::string, Picture> m_pictures;
};

TEST_F(OwnScenes, CornellBoxByPath) {
    expectGolden("cornell_box", "16", "", 0.01, 0.0);
}

// What caustics and indirect light bring is held by photons in tests/golden: a path tracer is too
// noisy for it here.
TEST_F(OwnScenes, CausticGlassByPath) {
    expectGolden("caustic_glass", "6", "", 0.01, 2.0);
    expectGolden("caustic_glass", "6", "direct.", 0.005, 0.0);
}

}  // namespace
}  // namespace pm::host::test
