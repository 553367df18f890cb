// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The repository's scenes by both integrators: no light is lost or made. Standard errors come from
// runs with different seeds, because photons are shared by the pixels of a run.
#include <fmt/format.h>

#include <cmath>
#include <map>

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
    Estimate measure(const std::string& scene, const Arguments& more, const std::string& prefix) {
        std::vector<double> values;
        for (int seed = 1; seed <= 4; ++seed) {
            const std::string name = fmt::format("{}-{}-{}", scene, more[1], seed);
            const Picture& picture = pictureOf(name, scene, more, seed);
            EXPECT_TRUE(allFinite(picture));
            const Means all = meansOf(picture, prefix);
            const Means lamp = prefix.empty() ? meansOf(picture, "emission.") : Means{};
            values.push_back(all[0] + all[1] + all[2] - lamp[0] - lamp[1] - lamp[2]);
        }
        return estimate(values);
    }

    void expectEqual(const std::string& what, const Estimate& photon, const Estimate& path,
                     double relativeBound, double sigmas) {
        const double error = std::hypot(photon.error, path.error);
        const double off = photon.mean - path.mean;
        std::cout << fmt::format("{}: photon {:.5f} +- {:.5f}, path {:.5f} +- {:.5f}, {:+.2f} %\n",
                                 what, photon.mean, photon.error, path.mean, path.error,
                                 100.0 * off / path.mean);
        EXPECT_LT(std::fabs(off), relativeBound * path.mean + sigmas * error) << what;
        // A bound that noise makes wide would hold nothing.
        EXPECT_LT(error, 0.02 * path.mean) << what;
    }

  private:
    const Picture& pictureOf(const std::string& name, const std::string& scene,
                             const Arguments& more, int seed) {
        auto found = m_pictures.find(name);
        if (found == m_pictures.end()) {
            const Arguments small{ownScene(scene), "--size", "64x48", "--seed",
                                  std::to_string(seed)};
            found = m_pictures.emplace(name, renderExr(name, more + small)).first;
        }
        return found->second;
    }
    std::map<std::string, Picture> m_pictures;
};

TEST_F(OwnScenes, CornellBoxMeansAgreeWithinOnePercent) {
    const Estimate photon = measure("cornell_box", {"--integrator", "photon"}, "");
    const Estimate path = measure("cornell_box", {"--integrator", "path"}, "");
    expectEqual("cornell_box", photon, path, 0.01, 0.0);
}

// What caustics and indirect light bring is held against long runs in tests/golden: here the path
// tracer is too noisy for it.
TEST_F(OwnScenes, CausticGlassMeansAgree) {
    const Arguments byPhotons{"--integrator", "photon"};
    const Arguments byPath{"--integrator", "path", "--passes", "6"};
    expectEqual("caustic_glass", measure("caustic_glass", byPhotons, ""),
                measure("caustic_glass", byPath, ""), 0.01, 2.0);
    expectEqual("direct", measure("caustic_glass", byPhotons, "direct."),
                measure("caustic_glass", byPath, "direct."), 0.005, 0.0);
}

}  // namespace
}  // namespace pm::host::test
