// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <random>

#include "tests/determinism/picture_way.h"
#include "tests/determinism/seam_detector.h"

namespace pm::test {

namespace {

constexpr int kWidth = 128, kHeight = 96;
constexpr int kSeeds = 12;
// Student's t with 11 degrees of freedom exceeds 4.44 either way once in a thousand times.
constexpr double kMostT = 4.44;

GreyPicture render(int seed, int bucketSize) {
    Way way{.threads = 2, .bucketSize = bucketSize, .order = "hilbert"};
    way.window = {0, 0, kWidth, kHeight};
    const Settings settings = {{"width", fmt::format("{}", kWidth)},
                               {"height", fmt::format("{}", kHeight)},
                               {"passes", "4"},
                               {"photons", "20000"},
                               {"aaLevel", "2"},
                               {"seed", fmt::format("{}", seed)}};
    // What the picture shows lies elsewhere for every seed, so it has no part in the mean.
    std::mt19937 random(static_cast<unsigned>(seed));
    std::uniform_real_distribution<double> shift(-0.5, 0.5);
    SceneChoice scene;
    scene.cameraX += shift(random);
    scene.cameraY += shift(random);
    scene.cameraZ += shift(random);
    Interruptions none;
    const LayeredPicture picture = makePicture(way, settings, scene, "", none);
    GreyPicture grey{kWidth, kHeight, {}};
    const std::vector<float>& beauty = picture.layers.at(0).values;
    for (std::size_t i = 0; i < beauty.size(); i += 4)
        grey.values.push_back((beauty[i] + beauty[i + 1] + beauty[i + 2]) / 3.0f + 1e-6f);
    return grey;
}

// Every bucket is by half a per cent too bright or too dark.
GreyPicture tinted(GreyPicture picture, int bucketSize) {
    for (int y = 0; y < picture.height; ++y) {
        for (int x = 0; x < picture.width; ++x) {
            const unsigned cell = static_cast<unsigned>(x / bucketSize + 64 * (y / bucketSize));
            const bool isBright = (cell * 2654435761u >> 16 & 1) != 0;
            picture.values[static_cast<std::size_t>(y * picture.width + x)] *=
                isBright ? 1.005f : 0.995f;
        }
    }
    return picture;
}

class Seams : public ::testing::TestWithParam<int> {};

// And the twin whose buckets are tinted has them.
TEST_P(Seams, AreNotInAPicture) {
    const int size = GetParam();
    std::vector<double> plain, broken;
    for (int seed = 1; seed <= kSeeds; ++seed) {
        const GreyPicture picture = render(seed, size);
        plain.push_back(seamExcess(picture, size));
        broken.push_back(seamExcess(tinted(picture, size), size));
    }
    EXPECT_LT(std::abs(studentT(plain)), kMostT) << "buckets of " << size;
    EXPECT_GT(studentT(broken), kMostT) << "buckets of " << size;
    std::cout << fmt::format("Student's t {:.2f}, of tinted buckets {:.2f}\n", studentT(plain),
                             studentT(broken));
}

INSTANTIATE_TEST_SUITE_P(Sizes, Seams, ::testing::Values(8, 32),
                         [](const auto& info) { return fmt::format("Buckets{}", info.param); });

// Neither what grows evenly nor an outline on a border is a seam; a step of 1 % is.
TEST(SeamExcess, IsTheStepAcrossBorders) {
    GreyPicture picture{64, 48, {}};
    for (int i = 0; i < 64 * 48; ++i) {
        const int x = i % 64, y = i / 64;
        const double outline = x >= 32 ? std::log(2.0) : 0.0;
        picture.values.push_back(static_cast<float>(std::exp(0.003 * x - 0.002 * y + outline)));
    }
    EXPECT_NEAR(seamExcess(picture, 16), 0.0, 1e-6);  // rounding to floats of about 1
    for (std::size_t i = 0; i < picture.values.size(); ++i) {
        const bool isBright = (i % 64 / 16 + i / 64 / 16) % 2 == 1;
        picture.values[i] *= isBright ? 1.01f : 1.0f;
    }
    EXPECT_NEAR(seamExcess(picture, 16), std::log(1.01), 1e-6);
}

}  // namespace

}  // namespace pm::test
