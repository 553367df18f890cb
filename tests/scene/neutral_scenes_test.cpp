// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Three scenes against pictures that other renderers agree on. They lie outside the repository;
// without them the tests are skipped. The references are 256 x 256; they are compared at half of
// it, where a pixel is the mean of four of theirs, or at a quarter.
#include <fmt/format.h>

#include <cstdlib>

#include "host_shim/pictures/picture_io.h"
#include "tests/scene/host_test.h"
#include "tests/scene/picture_measures.h"

namespace pm::host::test {
namespace {

const fs::path kPeers = PM_SHARED_PEERS;

class NeutralScenes : public HostTest {
  protected:
    void SetUp() override {
        if (!fs::exists(kPeers)) GTEST_SKIP() << "no optional data at " << kPeers.string();
        HostTest::SetUp();
        const std::string maker = (kPeers / "neutral_to_obj.py").string();
        const std::string command =
            fmt::format("python3 -B '{}' '{}' '{}' 4 >/dev/null", maker,
                        (kPeers / "scenes.json").string(), m_folder.string());
        ASSERT_EQ(std::system(command.c_str()), 0) << command;
    }

    Picture render(const std::string& scene, const Arguments& more, int side = 128) {
        const Arguments shared{scene + ".obj",
                               "--size",
                               fmt::format("{0}x{0}", side),
                               "--eye",
                               "0,1,3.9",
                               "--look-at",
                               "0,1,0",
                               "--fov",
                               "37",
                               "--rendering-space",
                               "Linear Rec.709",
                               "--aov",
                               "stderr"};
        return renderExr(scene, shared + more);
    }

    // The error may be the predicted noise times factor plus the reference's own noise; the mean is
    // off by at most meanBound.
    struct Bounds {
        double factor{}, referenceNoise{}, meanBound{}, dropped{};
        bool isQuarter = false;
    };
    // Of so many seeds together: of one, of 128 x 128 pixels, error over prediction differs by
    // 0.08.
    void hold(const std::string& scene, const Arguments& more, const Bounds& bounds,
              int seeds = 1) {
        Picture reference = halved(readExr(kPeers / (scene + ".exr")));
        if (bounds.isQuarter) reference = halved(reference);
        double relMse = 0, predicted = 0, meanRatio = 0;
        for (int seed = 1; seed <= seeds; ++seed) {
            const Picture picture =
                render(scene, more + Arguments{"--seed", std::to_string(seed)}, reference.width);
            ASSERT_TRUE(allFinite(picture));
            const ReferenceError error = errorAgainst(reference, picture, bounds.dropped);
            relMse += error.relMse / seeds;
            predicted += error.predicted / seeds;
            meanRatio += error.meanRatio / seeds;
        }
        std::cout << fmt::format(
            "{}: relMSE {:.3e}, {:.2f} times the predicted noise; mean {:+.2f} %\n", scene, relMse,
            relMse / predicted, 100.0 * (meanRatio - 1.0));
        EXPECT_LT(relMse, bounds.factor * predicted + bounds.referenceNoise);
        EXPECT_NEAR(meanRatio, 1.0, bounds.meanBound);
    }
};

const Arguments kPath{"--integrator", "path", "--passes", "8"};
const Arguments kPhoton{"--integrator", "photon", "--passes", "4"};

// No bias is to be seen beside the noise. Pixels of paths share none, so a quarter's 4096 tell
// enough: of six seeds means differ by 0.03 % here, by 0.3 % where there are caustics, error over
// prediction by 0.04 and 0.05.
TEST_F(NeutralScenes, DiffuseByPath) {
    hold("cornell-diffuse", kPath,
         {.factor = 1.1, .referenceNoise = 3e-5, .meanBound = 0.005, .isQuarter = true});
}
TEST_F(NeutralScenes, DiffuseByPhotons) {
    hold("cornell-diffuse", kPhoton, {1.1, 3e-5, 0.01}, 8);
}

// Caustics are blurred at their outlines, indirect light in corners, and the balls have corners,
// which the prediction from the spread between passes knows nothing of: renders of three seeds have
// 2.2e-4 in common.
TEST_F(NeutralScenes, CausticByPath) {
    hold("cornell-caustic", kPath,
         {.factor = 1.2, .referenceNoise = 9e-5, .meanBound = 0.01, .isQuarter = true}, 2);
}
TEST_F(NeutralScenes, CausticByPhotons) {
    hold("cornell-caustic", kPhoton, {1.1, 2.2e-4, 0.01});
}

// The lamp is half a pixel wide; what shows it, straight or in the glass, is noise without bound. A
// ball of triangles throws a caustic that is not quite that of the reference's true ball: renders
// of three seeds have 7.2e-4 in common.
TEST_F(NeutralScenes, SdsByPhotons) {
    hold("sds", kPhoton, {1.1, 7.2e-4, 0.015, 0.001});
}

// A path tracer finds the tiny lamp through the glass once in a blue moon, so there is no picture
// to compare. What it can do is the direct light, which must be that of the photon integrator.
TEST_F(NeutralScenes, SdsDirectLightByPath) {
    const Picture path = render("sds", {"--integrator", "path", "--passes", "2"});
    const Picture photon = render("sds", {"--integrator", "photon", "--passes", "2"});
    ASSERT_TRUE(allFinite(path));
    ASSERT_TRUE(allFinite(photon));
    const Means byPath = meansOf(path, "direct."), byPhotons = meansOf(photon, "direct.");
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_GT(byPhotons[c], 0.01);
        EXPECT_NEAR(byPath[c] / byPhotons[c], 1.0, 0.005);
    }
}

}  // namespace
}  // namespace pm::host::test
