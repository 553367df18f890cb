// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What every lobe of the lists in lobes.h promises, whichever model it is: a new one is tested here
// as it is made by default, without a line of its own.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <type_traits>
#include <variant>

#include "integrator/materials/lobe_kinds.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

constexpr Rgb kReflectance{0.75f, 0.5f, 0.25f};
constexpr float kChoice = 0.25f;

template <typename... Models, typename Check>
void forModels(std::type_identity<std::variant<Models...>>, const Check& check) {
    (check(Models{}), ...);
}

template <typename OneOf, typename Check>
void forEachOf(const Check& check) {
    forModels(std::type_identity<OneOf>{}, check);
}

LobePoint seenAt(double degrees, const Vec3f& shadingNormal, Transport transport) {
    const double a = degrees * std::numbers::pi / 180;
    return {
        Vec3f(Vec3d{std::sin(a), 0, std::cos(a)}), {0, 0, 1}, normalize(shadingNormal), transport};
}

// Weights are values over densities, to a per cent: by a facet that is seen at a flat angle, and
// found again from the directions, no more is left of floats. Returns the mean of what is
// reflected, over that of a colour of 1.
template <typename Model>
double reflectedBy(const Model& model, const LobePoint& at) {
    constexpr int kCount = 20'000;
    Random random(1);
    double sum = 0;
    int wrong = 0;
    for (int i = 0; i < kCount; ++i) {
        BsdfSample s;
        s.weight = kReflectance / kChoice;
        if (!model.sample(at, LobeNumbers{random.next2D(), random.next()}, s)) continue;
        const float density = model.pdfSolidAngle(at, s.direction, kChoice);
        const Rgb value = model.evaluate(at, kReflectance, s.direction);
        for (int c = 0; c < 3; ++c)
            wrong += !(std::abs(value[c] / density - s.weight[c]) <= 1e-2f * s.weight[c] + 1e-6f);
        sum += static_cast<double>(s.weight.r * kChoice / kReflectance.r) / kCount;
    }
    EXPECT_EQ(wrong, 0);
    return sum;
}

const auto kScatteringKeepsItsWord = [](const auto& model) {
    for (const Vec3f normal : {Vec3f{0, 0, 1}, Vec3f{0.3f, -0.2f, 1}})
        for (const Transport transport : {Transport::kRadiance, Transport::kPhotons})
            for (const double degrees : {0.0, 40.0, 75.0}) {
                SCOPED_TRACE(degrees);
                const double reflected = reflectedBy(model, seenAt(degrees, normal, transport));
                if (normal.x == 0.0f) {
                    EXPECT_LE(reflected, 1.02);
                }
            }
};

TEST(Lobes, WeightsAreValuesOverDensities) {
    forEachOf<DiffuseLobe>(kScatteringKeepsItsWord);
    forEachOf<GlossyLobe>(kScatteringKeepsItsWord);
    kScatteringKeepsItsWord(Phong{30});
}

// Density over all directions is the choice's probability, less what falls to directions that are
// lost: those below the surface, or that no facet lets through.
TEST(Lobes, DensitiesAddToTheChoice) {
    const auto check = [](const auto& model) {
        const LobePoint at = seenAt(20, {0, 0, 1}, Transport::kRadiance);
        Random random(2);
        constexpr int kCount = 200'000;
        double sum = 0, found = 0;
        for (int i = 0; i < kCount; ++i) {
            const Vec3f in = sampleUniformSphere(random.next2D());
            sum += static_cast<double>(model.pdfSolidAngle(at, in, kChoice));
            BsdfSample s;
            s.weight = kReflectance / kChoice;
            found += model.sample(at, LobeNumbers{random.next2D(), random.next()}, s);
        }
        const double density = sum * 4 * std::numbers::pi / kCount;
        EXPECT_LT(density, static_cast<double>(kChoice) + 0.01);
        EXPECT_GT(density, static_cast<double>(kChoice) * found / kCount - 0.01);
        EXPECT_GT(found, 0.6 * kCount);
    };
    forEachOf<DiffuseLobe>(check);
    forEachOf<GlossyLobe>(check);
    check(Phong{30});
}

// What maps ask for is what the lobe reflects of even light.
TEST(Lobes, AlbedoIsWhatEvenLightGives) {
    forEachOf<DiffuseLobe>([](const auto& model) {
        for (const double degrees : {0.0, 40.0, 75.0}) {
            const LobePoint at = seenAt(degrees, {0, 0, 1}, Transport::kRadiance);
            const double albedo = static_cast<double>(model.albedo(at, kReflectance).r);
            EXPECT_NEAR(reflectedBy(model, at) * static_cast<double>(kReflectance.r), albedo,
                        0.01 * albedo);
        }
    });
}

TEST(Lobes, SmoothOnesMakeNoEnergyAndFindUnitDirections) {
    forEachOf<SmoothLobe>([](auto model) {
        for (const double degrees : {0.0, 40.0, 75.0}) {
            const LobePoint at = seenAt(degrees, {0, 0, 1}, Transport::kRadiance);
            const SmoothShares shares = model.shares(at);
            EXPECT_LE(maxChannel(shares.reflected + shares.refracted), 1.0f + 1e-6f);
            for (const Lobe lobe : {Lobe::kReflection, Lobe::kRefraction}) {
                BsdfSample s;
                s.lobe = lobe;
                s.weight = lobe == Lobe::kReflection ? shares.reflected : shares.refracted;
                s.pdfSolidAngle = 1.0f;
                if (isBlack(s.weight) || !model.sample(at, 0.5f, s)) continue;
                EXPECT_NEAR(length(s.direction), 1.0f, 1e-5f);
                EXPECT_EQ(s.direction.z > 0.0f, lobe == Lobe::kReflection);
            }
        }
    });
}

}  // namespace
}  // namespace pm::test
