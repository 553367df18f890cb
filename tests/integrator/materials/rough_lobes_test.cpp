// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Rough metal and rough glass: neither makes nor loses energy where nothing absorbs (the white
// furnace), and what goes one way goes the other.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "integrator/materials/lobe_kinds.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

constexpr float kRoughness[] = {0.01f, 0.05f, 0.1f, 0.2f, 0.35f, 0.5f, 0.7f, 0.85f, 1.0f};
constexpr float kCosines[] = {0.01f, 0.05f, 0.1f, 0.2f, 0.4f, 0.7f, 1.0f};

LobePoint seenAt(float cosine, Transport transport = Transport::kPhotons) {
    return {{std::sqrt(1 - cosine * cosine), 0, cosine}, {0, 0, 1}, {0, 0, 1}, transport};
}

struct Kept {
    double share, error;  // of flux that goes on, and its standard error
};

template <typename Model>
Kept keptBy(const Model& model, const LobePoint& at, int count = 30'000) {
    Random random(1);
    double sum = 0, squares = 0;
    for (int i = 0; i < count; ++i) {
        BsdfSample s;
        s.pdfSolidAngle = 1.0f;
        s.weight = model.albedo(model.cosine(at));
        if (!model.sample(at, LobeNumbers{random.next2D(), random.next()}, s)) continue;
        EXPECT_NEAR(length(s.direction), 1.0f, 1e-5f);
        const double w = static_cast<double>(s.weight.g);
        sum += w;
        squares += w * w;
    }
    const double mean = sum / count;
    return {mean, std::sqrt(std::max(0.0, squares / count - mean * mean) / count)};
}

// .5 % for cosines from .05, 2 % below.
void expectWhite(const Kept& kept, float cosine) {
    EXPECT_NEAR(kept.share, 1.0, (cosine < 0.05f ? 0.02 : 0.005) + 4 * kept.error)
        << "standard error " << kept.error;
}

TEST(RoughLobes, WhiteMetalReflectsAll) {
    for (const float roughness : kRoughness)
        for (const float cosine : kCosines) {
            SCOPED_TRACE(testing::Message() << "roughness " << roughness << " cosine " << cosine);
            expectWhite(keptBy(GgxReflection{{roughness * roughness}, {}}, seenAt(cosine)), cosine);
        }
}

TEST(RoughLobes, ClearGlassKeepsAll) {
    for (const float ior : {1.1f, 1.33f, 1.5f, 2.4f}) {
        const GlassAlbedo table(ior);
        for (const bool isInside : {false, true})
            for (const float roughness : kRoughness)
                for (const float cosine : kCosines) {
                    SCOPED_TRACE(testing::Message()
                                 << "ior " << ior << (isInside ? " inside" : "") << " roughness "
                                 << roughness << " cosine " << cosine);
                    const RoughGlass glass{{roughness * roughness}, Rgb(1.0f), &table, isInside};
                    expectWhite(keptBy(glass, seenAt(cosine)), cosine);
                }
    }
}

// One scattering alone, by an even grid of directions and the textbook's formula.
double integratedOnce(double cosine, double alpha) {
    constexpr int kSteps = 1000;
    const auto lambda = [&](double c2) {
        return 0.5 * (std::sqrt(1 + alpha * alpha * (1 - c2) / c2) - 1);
    };
    const Vec3d out{std::sqrt(1 - cosine * cosine), 0, cosine};
    double sum = 0;
    for (int i = 0; i < kSteps; ++i)
        for (int k = 0; k < kSteps; ++k) {
            const double c2 = (i + 0.5) / kSteps, phi = 2 * std::numbers::pi * (k + 0.5) / kSteps;
            const double c = std::sqrt(c2), s = std::sqrt(1 - c2);
            const Vec3d in{s * std::cos(phi), s * std::sin(phi), c}, h = normalize(in + out);
            const double slope = (h.x * h.x + h.y * h.y) / (alpha * alpha) + h.z * h.z;
            const double d = 1 / (std::numbers::pi * alpha * alpha * slope * slope);
            sum += d / (4 * cosine * c) / (1 + lambda(c2) + lambda(cosine * cosine));
        }
    return sum * std::numbers::pi / (kSteps * kSteps);
}

TEST(RoughLobes, OneScatteringReflectsWhatTheTableSays) {
    for (const auto& [cosine, alpha] :
         {std::pair{0.7, 1.0}, {1.0, 1.0}, {0.3, 0.5}, {0.15, 0.25}, {0.9, 0.2}}) {
        const GgxShares found =
            GgxAlbedo::table().at(static_cast<float>(cosine), static_cast<float>(alpha));
        EXPECT_NEAR(static_cast<double>(found.normal), integratedOnce(cosine, alpha), 2e-3)
            << "cosine " << cosine << " alpha " << alpha;
    }
    EXPECT_NEAR(GgxAlbedo::table().at(1.0f, 1e-4f).normal, 1.0f, 1e-3f);
}

// Facets seen from a direction are all that there is to see: the densities of their normals add to
// 1, and D's to the area.
TEST(RoughLobes, DensitiesOfFacetsAddToOne) {
    for (const float alpha : {0.1f, 0.5f, 1.0f})
        for (const float cosine : {0.1f, 0.5f, 1.0f}) {
            const Ggx ggx{alpha};
            const Vec3f out{std::sqrt(1 - cosine * cosine), 0, cosine};
            Random random(3);
            constexpr int kCount = 400'000;
            double area = 0, visible = 0;
            for (int i = 0; i < kCount; ++i) {
                const Vec3f h = sampleCosineHemisphere(random.next2D());
                area += static_cast<double>(ggx.density(h)) * std::numbers::pi / kCount;
                if (h.z > 0)
                    visible += static_cast<double>(ggx.visibleDensity(out, h) / h.z) *
                               std::numbers::pi / kCount;
            }
            EXPECT_NEAR(area, 1.0, 0.02) << alpha;
            EXPECT_NEAR(visible, 1.0, 0.05) << alpha << " " << cosine;
        }
}

// A coat and white below it reflect all together.
TEST(RoughLobes, WhiteUnderACoatReflectsAll) {
    for (const float f0 : {0.04f, 0.3f})
        for (const float roughness : {0.0f, 0.1f, 0.3f, 0.6f, 1.0f})
            for (const float cosine : kCosines) {
                SCOPED_TRACE(testing::Message()
                             << "f0 " << f0 << " roughness " << roughness << " cosine " << cosine);
                Cover under;
                under.boundary = {f0, roughness * roughness};
                const LobePoint at = seenAt(cosine);
                Random random(6);
                double below = 0, squares = 0;
                constexpr int kCount = 20'000;
                for (int i = 0; i < kCount; ++i) {
                    BsdfSample s;
                    s.weight = Rgb(Undercoat(under).passesOut(at));
                    if (!Undercoat(under).sample(at, LobeNumbers{random.next2D(), random.next()},
                                                 s))
                        continue;
                    below += static_cast<double>(s.weight.g) / kCount;
                    squares += static_cast<double>(s.weight.g * s.weight.g) / kCount;
                }
                const double error = std::sqrt(std::max(0.0, squares - below * below) / kCount);
                expectWhite({below + static_cast<double>(under.boundary.at(cosine)), error},
                            cosine);
            }
}

// White plaster sends all of it back.
TEST(RoughLobes, WhitePlasterReflectsAll) {
    for (const float roughness : {0.1f, 0.5f, 1.0f})
        for (const float cosine : kCosines) {
            SCOPED_TRACE(testing::Message() << "roughness " << roughness << " cosine " << cosine);
            const RoughDiffuse plaster{roughness, Rgb(1.0f)};
            const LobePoint at = seenAt(cosine);
            Random random(7);
            constexpr int kCount = 50'000;
            double sum = 0, squares = 0;
            for (int i = 0; i < kCount; ++i) {
                BsdfSample s;
                s.weight = Rgb(1.0f);
                if (!plaster.sample(at, LobeNumbers{random.next2D(), random.next()}, s)) continue;
                const double w = static_cast<double>(s.weight.g);
                sum += w / kCount;
                squares += w * w / kCount;
            }
            expectWhite({sum, std::sqrt(std::max(0.0, squares - sum * sum) / kCount)}, cosine);
            EXPECT_NEAR(plaster.albedo(at, Rgb(1.0f)).g, 1.0f, 1e-5f);
        }
}

TEST(RoughLobes, ReflectionIsReciprocal) {
    Random random(4);
    for (int i = 0; i < 1000; ++i) {
        Vec3f a = sampleUniformSphere(random.next2D()), b = sampleUniformSphere(random.next2D());
        a.z = std::abs(a.z) + 0.01f;
        b.z = std::abs(b.z) + 0.01f;
        a = normalize(a);
        b = normalize(b);
        const float roughness = 0.1f + 0.9f * random.next2D().x;
        const auto f = [&](const auto& model, const Vec3f& out, const Vec3f& in) {
            const LobePoint at(out, {0, 0, 1}, {0, 0, 1}, Transport::kRadiance);
            return model.evaluate(at, model.albedo(model.cosine(at)), in).g / in.z;
        };
        const GgxReflection metal{{roughness * roughness}, {Fresnel::Curve::kSchlick, Rgb(0.5f)}};
        const RoughGlass glass{{roughness * roughness}};
        EXPECT_NEAR(f(metal, a, b), f(metal, b, a), 2e-3f * f(metal, a, b) + 1e-6f);
        EXPECT_NEAR(f(glass, a, b), f(glass, b, a), 2e-3f * f(glass, a, b) + 1e-6f);
        const RoughDiffuse plaster{roughness, Rgb(0.5f)};
        const auto of = [&](const Vec3f& out, const Vec3f& in) {
            const LobePoint at(out, {0, 0, 1}, {0, 0, 1}, Transport::kRadiance);
            return plaster.evaluate(at, Rgb(0.5f), in).g / in.z;
        };
        EXPECT_NEAR(of(a, b), of(b, a), 1e-4f * of(a, b));
    }
}

// Through glass as well, but for the squares of the indices: f(a from b) n^2 = f(b from a), b
// inside.
TEST(RoughLobes, GlassIsReciprocalFromSideToSide) {
    const GlassAlbedo table(1.5f);
    Random random(8);
    for (int i = 0; i < 1000; ++i) {
        Vec3f a = sampleUniformSphere(random.next2D()), b = sampleUniformSphere(random.next2D());
        a.z = std::abs(a.z) + 0.05f;
        b.z = -std::abs(b.z) - 0.05f;
        a = normalize(a);
        b = normalize(b);
        const float roughness = 0.3f + 0.7f * random.next2D().x;
        const auto f = [&](bool isInside, Vec3f out, Vec3f in) {
            if (isInside) {
                out.z = -out.z;
                in.z = -in.z;
            }
            const RoughGlass glass{{roughness * roughness}, Rgb(1.0f), &table, isInside};
            const LobePoint at(out, {0, 0, 1}, {0, 0, 1}, Transport::kRadiance);
            return glass.evaluate(at, glass.albedo(glass.cosine(at)), in).g / std::abs(in.z);
        };
        const float fromInside = f(false, a, b) * 1.5f * 1.5f, fromOutside = f(true, b, a);
        EXPECT_NEAR(fromInside, fromOutside, 5e-3f * fromOutside + 1e-6f);
    }
}

// What radiance goes out by when it comes from behind is what photons go in by, but for the square
// of the index.
TEST(RoughLobes, PhotonsGoThroughGlassAsRadianceDoes) {
    const GlassAlbedo table(1.5f);
    for (const float roughness : {0.2f, 0.6f, 1.0f})
        for (const float cosine : {0.2f, 0.9f}) {
            const RoughGlass glass{{roughness * roughness}, Rgb(1.0f), &table, false};
            Random random(5);
            for (int i = 0; i < 2000; ++i) {
                BsdfSample radiance, photon;
                const LobeNumbers u{random.next2D(), random.next()};
                radiance.weight = photon.weight = glass.albedo(cosine);
                radiance.pdfSolidAngle = photon.pdfSolidAngle = 1.0f;
                if (!glass.sample(seenAt(cosine, Transport::kRadiance), u, radiance)) continue;
                ASSERT_TRUE(glass.sample(seenAt(cosine), u, photon));
                const float factor = radiance.direction.z < 0 ? 1.5f * 1.5f : 1.0f;
                ASSERT_NEAR(radiance.weight.g * factor, photon.weight.g, 1e-4f * photon.weight.g);
            }
        }
}

TEST(RoughLobes, MetalsReflectWhatIsMeasured) {
    EXPECT_NEAR(fresnelConductor(1, 0.166f, 3.15f), 0.941145, 1e-5);  // gold
    EXPECT_NEAR(fresnelConductor(1, 0.214f, 3.67f), 0.942714, 1e-5);  // copper
    EXPECT_NEAR(fresnelConductor(1, 0.958f, 6.69f), 0.921136, 1e-5);  // aluminium
    EXPECT_NEAR(fresnelConductor(1, 0.06f, 3.59f), 0.982871, 1e-5);   // silver
    EXPECT_NEAR(fresnelConductor(0, 0.2f, 3.0f), 1.0, 1e-5);
    EXPECT_NEAR(fresnelConductor(0.4f, 1.5f, 0.0f), fresnelDielectric(0.4f, 1.5f), 1e-5);
}

}  // namespace
}  // namespace pm::test
