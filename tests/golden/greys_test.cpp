// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// A colour space has its own red, green and blue, but grey is grey in all of them: a scene without
// colour is the same picture in linear Rec.709 and in ACEScg.
#include <fmt/format.h>

#include <cmath>

#include "tests/scene/host_test.h"
#include "tests/scene/picture_measures.h"

namespace pm::host::test {
namespace {

class Greys : public HostTest {
  protected:
    Picture renderIn(const std::string& space) {
        write("grey.mtl",
              "newmtl light\nKd 0 0 0\nKe 5 5 5\nnewmtl wall\nKd 0.5 0.5 0.5\n"
              "newmtl gloss\nKd 0.2 0.2 0.2\nKs 0.4 0.4 0.4\nNs 30\nillum 2\n");
        write("grey.obj",
              "mtllib grey.mtl\nv -1 0 0\nv 1 0 0\nv 1 2 0\nv -1 2 0\nv -1 0 2\nv 1 0 2\n"
              "v -0.5 2 0.5\nv 0.5 2 0.5\nv 0.5 2 1.5\nv -0.5 2 1.5\nv -1 2 2\n"
              "usemtl wall\nf 1 2 3 4\nf 1 4 11 5\nusemtl gloss\nf 5 6 2 1\n"
              "usemtl light\nf 7 8 9 10\n");
        return renderExr(space, {"grey.obj", "--size", "48x36", "--eye", "0,1,5", "--look-at",
                                 "0,1,0", "--photons", "20000", "--passes", "2",
                                 "--rendering-space", space, "--aov", "albedo"});
    }
};

TEST_F(Greys, AreTheSameInRec709AndAcescg) {
    const Picture rec709 = renderIn("Linear Rec.709"), acescg = renderIn("ACEScg");
    ASSERT_TRUE(allFinite(rec709));
    ASSERT_TRUE(allFinite(acescg));
    ASSERT_TRUE(isLit(rec709, 0.9));
    // Rounding of the matrices (1e-6) may now and then turn a random decision in a sample.
    const auto count = static_cast<double>(rec709.channels[0].values.size());
    for (const char* name : {"R", "G", "B", "albedo.R", "albedo.G", "albedo.B"}) {
        const auto &a = rec709.find(name)->values, &b = acescg.find(name)->values;
        const auto& green = acescg.find(*name == 'a' ? "albedo.G" : "G")->values;
        double different = 0.0, sumA = 0.0, sumB = 0.0, worstTint = 0.0;
        for (std::size_t i = 0; i < a.size(); ++i) {
            const auto x = static_cast<double>(a[i]), y = static_cast<double>(b[i]);
            different += std::fabs(x - y) > 1e-4 * std::fabs(x) + 1e-6 ? 1.0 : 0.0;
            worstTint =
                std::max(worstTint, std::fabs(y - static_cast<double>(green[i])) / (y + 0.01));
            sumA += x;
            sumB += y;
        }
        std::cout << fmt::format("{}: {:.6f} and {:.6f}, {} pixels differ, tint {:.1e}\n", name,
                                 sumA / count, sumB / count, different, worstTint);
        EXPECT_LT(different, 0.02 * count) << name;
        EXPECT_NEAR(sumB / sumA, 1.0, 1e-3) << name;
        EXPECT_LT(worstTint, 1e-3) << name;
    }
}

// The measure sees colour where there is colour.
TEST_F(Greys, ColoursAreNot) {
    const Arguments small{
        ownScene("cornell_box"), "--size", "32x24", "--passes", "1", "--photons", "5000"};
    const Means rec709 =
        meansOf(renderExr("a", small + Arguments{"--rendering-space", "Linear Rec.709"}));
    const Means acescg = meansOf(renderExr("b", small + Arguments{"--rendering-space", "ACEScg"}));
    EXPECT_GT(std::fabs(acescg[0] / rec709[0] - 1.0), 0.02);
}

}  // namespace
}  // namespace pm::host::test
