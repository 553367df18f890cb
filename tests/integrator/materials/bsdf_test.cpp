// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The BSDF point by point: weights, reciprocity, energy, Fresnel and Snell, and the photons' side
// of it as the adjoint of the camera's.
#include "integrator/materials/bsdf.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/support/scene_maker.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

constexpr double kPiD = std::numbers::pi;

MaterialDescription diffuseAndGlossy(float diffuse, float glossy, float exponent) {
    MaterialDescription m;
    m.diffuse = Rgb(diffuse, 0.5f * diffuse, 0.25f * diffuse);
    m.glossy = Rgb(0.5f * glossy, glossy, glossy);
    m.glossyExponent = exponent;
    return m;
}

MaterialDescription glassOf(float ior) {
    MaterialDescription m;
    m.kind = MaterialKind::kDielectric;
    m.ior = ior;
    return m;
}

// A surface in the plane z = 0 and its BSDF for any direction.
struct Bench {
    std::shared_ptr<const Scene> scene;
    Surface surface;

    explicit Bench(const MaterialDescription& material, Vec3f shadingNormal = {0, 0, 1}) {
        SceneMaker maker;
        maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.material(material));
        scene = maker.build();
        surface.geometricNormal = {0, 0, 1};
        surface.shadingNormal = normalize(shadingNormal);
    }
    Bsdf bsdf(const Vec3f& out, Transport transport = Transport::kRadiance) const {
        return {scene->materials(), surface, out, transport, Rgb(1.0f)};
    }
};

Vec3f above(Random& random) {
    Vec3f d = sampleUniformSphere(random.next2D());
    d.z = std::abs(d.z) + 1e-3f;
    return normalize(d);
}

Vec3f atAngle(double degrees) {
    const double a = degrees * kPiD / 180;
    return Vec3f(Vec3d{std::sin(a), 0, std::cos(a)});
}

TEST(Bsdf, WeightIsValueOverDensity) {
    Random random(1);
    for (const Vec3f normal : {Vec3f{0, 0, 1}, Vec3f{0.3f, -0.2f, 1}})
        for (const Transport transport : {Transport::kRadiance, Transport::kPhotons}) {
            const Bench bench(diffuseAndGlossy(0.5f, 0.4f, 20), normal);
            int checked = 0;
            for (int i = 0; i < 5000; ++i) {
                const Bsdf bsdf = bench.bsdf(above(random), transport);
                BsdfSample s;
                const float uLobe = random.next();
                if (!bsdf.sample(uLobe, random.next2D(), s)) continue;
                const Rgb value = bsdf.evaluate(s.lobe, s.direction);
                EXPECT_NEAR(bsdf.pdfSolidAngle(s.lobe, s.direction) / s.pdfSolidAngle, 1, 1e-5);
                for (int c = 0; c < 3; ++c)
                    EXPECT_NEAR(value[c] / s.pdfSolidAngle, s.weight[c], 2e-4f * s.weight[c]);
                ++checked;
            }
            EXPECT_GT(checked, 2000);
        }
}

TEST(Bsdf, IsReciprocal) {
    Random random(2);
    const Bench bench(diffuseAndGlossy(0.5f, 0.4f, 20));
    for (int i = 0; i < 5000; ++i) {
        const Vec3f a = above(random), b = above(random);
        for (const Lobe lobe : {Lobe::kDiffuse, Lobe::kBroad}) {
            const float ab = bench.bsdf(a).evaluate(lobe, b).r / b.z;
            const float ba = bench.bsdf(b).evaluate(lobe, a).r / a.z;
            EXPECT_NEAR(ab, ba, 2e-4f * std::abs(ab) + 1e-6f);
        }
    }
}

// Of every material whose lobes are in one plane with its surface: coats, what lies below them, and
// both sides of a leaf.
TEST(Bsdf, EveryRoughLobeIsReciprocal) {
    std::vector<MaterialDescription> materials(5);
    materials[0].diffuse = Rgb(0.5f);
    materials[0].glossy = Rgb(0.2f);
    materials[0].roughness = 0.35f;
    materials[1] = materials[0];
    materials[1].roughness = 0.7f;
    materials[2].diffuse = Rgb(0.2f);
    materials[2].diffuseTransmission = Rgb(0.5f);
    materials[3].kind = materials[4].kind = MaterialKind::kMirror;
    materials[3].glossy = materials[4].glossy = Rgb(0.8f);
    materials[3].roughness = 0.3f;
    materials[4].roughness = 0.9f;
    materials[4].conductorN = Rgb(0.2f);
    materials[4].conductorK = Rgb(3.0f);
    Random random(3);
    for (const MaterialDescription& material : materials) {
        const Bench bench(material);
        int found = 0;
        for (int i = 0; i < 2000; ++i) {
            const Vec3f a = above(random);
            Vec3f b = above(random);
            for (const float side : {1.0f, -1.0f}) {
                b.z = std::abs(b.z) * side;
                for (const Lobe lobe : {Lobe::kDiffuse, Lobe::kGlossy, Lobe::kWide, Lobe::kBroad}) {
                    if (!bench.bsdf(a).has(lobe) || !bench.bsdf(b).has(lobe)) continue;
                    const float ab = bench.bsdf(a).evaluate(lobe, b).g / std::abs(b.z);
                    const float ba = bench.bsdf(b).evaluate(lobe, a).g / std::abs(a.z);
                    ASSERT_NEAR(ab, ba, 3e-3f * std::abs(ab) + 1e-6f);
                    found += ab > 0.0f;
                }
            }
        }
        EXPECT_GT(found, 1000);
    }
}

// K(light -> eye) of the photons over |eye . ng| is the camera's over |light . ng| (Veach 1997, eq.
// 5.19), wherever the shading normal points; only where the correction is cut may it be less.
TEST(Bsdf, PhotonsAreTheAdjointOfTheCamera) {
    Random random(3);
    const Bench bench(diffuseAndGlossy(0.5f, 0.4f, 5), {0.4f, 0.1f, 1});
    const Vec3f ns = bench.surface.shadingNormal;
    int lit = 0, fringe = 0;
    for (int i = 0; i < 20'000; ++i) {
        const Vec3f light = above(random), eye = above(random);
        for (const Lobe lobe : {Lobe::kDiffuse, Lobe::kBroad}) {
            if (lobe == Lobe::kBroad) {
                // Seen from below its shading normal a surface is glossy by the geometric one;
                // photons can't know who will look, and lose that fringe.
                if (dot(eye, ns) <= 0.0f) continue;
                if (std::abs(dot(light, ns) * eye.z) > 19 * light.z * dot(eye, ns))
                    continue;  // cut
            }
            if (dot(light, ns) > 19 * light.z) continue;  // cut
            fringe += dot(eye, ns) <= 0.0f;
            const float camera = bench.bsdf(eye).evaluate(lobe, light).g / light.z;
            const float photon =
                bench.bsdf(light, Transport::kPhotons).evaluate(lobe, eye).g / eye.z;
            EXPECT_NEAR(photon, camera, 1e-4f * camera + 1e-6f) << "light.ns " << dot(light, ns);
            lit += camera > 0;
        }
    }
    EXPECT_GT(lit, 5000);
    EXPECT_GT(fringe, 500);
}

// What a delta lobe brings to parts of the hemisphere, of light from a part of one.
struct Brought {
    static constexpr std::size_t kParts = 12;
    std::array<double, kParts> sums{}, squares{};
};

// eyesAbove: the camera is on the side of the normals.
Brought broughtBy(const Bench& bench, Lobe lobe, bool eyesAbove, Transport transport) {
    constexpr std::uint32_t kCount = 400'000;
    const bool isPhoton = transport == Transport::kPhotons;
    const bool startsAbove = eyesAbove != (isPhoton && lobe == Lobe::kRefraction);
    const auto partOf = [](const Vec3f& d) {
        const double turn = std::atan2(static_cast<double>(d.y), static_cast<double>(d.x));
        const auto sector = std::min(5u, static_cast<std::uint32_t>((turn / kPiD + 1) * 3));
        return 2 * sector + (std::abs(d.z) < 0.4f ? 1 : 0);
    };
    // Not from where the correction is cut.
    const auto isLit = [](const Vec3f& from) { return from.x > -0.2f && std::abs(from.z) > 0.05f; };
    Random random(6);
    Brought found;
    for (std::uint32_t i = 0; i < kCount; ++i) {
        Vec3f from = above(random);  // even over the hemisphere
        if (!startsAbove) from.z = -from.z;
        const Bsdf bsdf = bench.bsdf(from, transport);
        BsdfSample s;
        if (!bsdf.follow(lobe, s, {random.next2D(), random.next()})) continue;
        if (!isLit(isPhoton ? from : s.direction)) continue;
        const auto part = partOf(isPhoton ? s.direction : from);
        const double flux = static_cast<double>(s.weight.r * std::abs(from.z));
        found.sums[part] += flux / kCount;
        found.squares[part] += flux * flux / kCount;
    }
    for (std::size_t part = 0; part < Brought::kParts; ++part)
        found.squares[part] = (found.squares[part] - found.sums[part] * found.sums[part]) / kCount;
    return found;
}

// By photons as the camera finds it, whose own way on may go by either normal.
void expectPhotonsWhereTheCameraLooks(const Bench& bench, Lobe lobe, bool eyesAbove) {
    const Brought camera = broughtBy(bench, lobe, eyesAbove, Transport::kRadiance);
    const Brought photons = broughtBy(bench, lobe, eyesAbove, Transport::kPhotons);
    double all = 0;
    for (std::size_t part = 0; part < Brought::kParts; ++part) {
        const double error = std::sqrt(camera.squares[part] + photons.squares[part]);
        EXPECT_NEAR(photons.sums[part], camera.sums[part], 4 * error + 1e-9) << part;
        all += camera.sums[part];
    }
    EXPECT_GT(all, 0.01);
}

TEST(Bsdf, PhotonsLeaveAMirrorWhereTheCameraLooks) {
    MaterialDescription mirror;
    mirror.kind = MaterialKind::kMirror;
    mirror.glossy = Rgb(1.0f);
    expectPhotonsWhereTheCameraLooks(Bench(mirror, {0.7f, 0.2f, 1}), Lobe::kReflection, true);
    mirror.fresnelMirror = true;
    mirror.glossy = Rgb(0.2f);
    expectPhotonsWhereTheCameraLooks(Bench(mirror, {0.7f, 0.2f, 1}), Lobe::kReflection, true);
}

TEST(Bsdf, PhotonsLeaveGlassWhereTheCameraLooks) {
    const Bench bench(glassOf(1.5f), {0.7f, 0.2f, 1});
    for (const Lobe lobe : {Lobe::kReflection, Lobe::kRefraction})
        for (const bool eyesAbove : {true, false}) {
            SCOPED_TRACE(fmt::format("{} {}", lobe == Lobe::kReflection, eyesAbove));
            expectPhotonsWhereTheCameraLooks(bench, lobe, eyesAbove);
        }
}

TEST(Bsdf, MakesNoEnergy) {
    Random random(4);
    for (const float exponent : {0.0f, 1.0f, 10.0f, 1000.0f})
        for (const double degrees : {0.0, 30.0, 60.0, 85.0}) {
            const Bench bench(diffuseAndGlossy(0.5f, 0.5f, exponent));
            const Bsdf bsdf = bench.bsdf(atAngle(degrees));
            double mean = 0, square = 0;
            const int n = 20'000;
            for (int i = 0; i < n; ++i) {
                BsdfSample s;
                const float uLobe = random.next();
                if (!bsdf.sample(uLobe, random.next2D(), s)) continue;
                mean += static_cast<double>(s.weight.r) / n;
                square += static_cast<double>(s.weight.r) * static_cast<double>(s.weight.r) / n;
            }
            const double error = std::sqrt((square - mean * mean) / n);
            EXPECT_LE(mean, 0.75 + 4 * error + 1e-6) << exponent << " at " << degrees;
            if (degrees == 0.0) {
                EXPECT_NEAR(mean, 0.75, 4 * error + 1e-5);
            }
            EXPECT_GT(mean, 0.4);
        }
}

TEST(Bsdf, TooMuchReflectanceIsScaledDown) {
    MaterialDescription m = diffuseAndGlossy(0.9f, 0.9f, 10);
    m.transparency = 0.5f;
    const Rgb albedo = Bench(m).bsdf({0, 0, 1}).albedo();
    EXPECT_LE(maxChannel(albedo), 1.0f + 1e-6f);
    EXPECT_GT(maxChannel(albedo), 0.99f);
    m = diffuseAndGlossy(5.0f, -1.0f, 10);
    EXPECT_EQ(Bench(m).bsdf({0, 0, 1}).albedo(), Rgb(1.0f, 1.0f, 1.0f));
}

// Photons are absorbed with what the surface does not reflect, and keep their mean flux.
TEST(Bsdf, PhotonsSurviveByTheAlbedo) {
    Random random(5);
    const Bench bench(diffuseAndGlossy(0.75f, 0.0f, 0));
    const Bsdf bsdf(bench.scene->materials(), bench.surface, atAngle(40), Transport::kPhotons,
                    Rgb(2.0f));
    int survived = 0;
    double mean = 0;
    const int n = 50'000;
    for (int i = 0; i < n; ++i) {
        BsdfSample s;
        const float uLobe = random.next();
        if (!bsdf.sample(uLobe, random.next2D(), s)) continue;
        ++survived;
        mean += static_cast<double>(s.weight.r) / n;
    }
    const double p = 0.75 * (1 + 0.5 + 0.25) / 3;
    EXPECT_NEAR(static_cast<double>(survived) / n, p, 4 * std::sqrt(p * (1 - p) / n));
    EXPECT_NEAR(mean, 0.75, 4 * 0.75 / p * std::sqrt(p * (1 - p) / n));
}

TEST(Fresnel, NormalIncidence) {  // analytic D1
    EXPECT_NEAR(fresnelDielectric(1, 1.33f), 0.0200593, 1e-6);
    EXPECT_NEAR(fresnelDielectric(1, 1.5f), 0.04, 1e-6);
    EXPECT_NEAR(fresnelDielectric(1, 1.8f), 0.0816327, 1e-6);
    EXPECT_NEAR(fresnelDielectric(1, 2.4f), 0.1695502, 1e-6);
    EXPECT_NEAR(fresnelDielectric(1, 1 / 1.5f), 0.04, 1e-6);
    EXPECT_NEAR(fresnelDielectric(0, 1.5f), 1, 1e-6);
    EXPECT_EQ(fresnelDielectric(0.5f, 1.0f), 0.0f);
}

TEST(Fresnel, HemisphericalMean) {  // analytic D4
    const auto mean = [](float eta) {
        const int n = 200'000;
        double sum = 0;
        for (int i = 0; i < n; ++i) {
            const double mu = (i + 0.5) / n;
            sum += 2 * mu * static_cast<double>(fresnelDielectric(static_cast<float>(mu), eta)) / n;
        }
        return sum;
    };
    EXPECT_NEAR(mean(1.33f), 0.065931, 2e-6);
    EXPECT_NEAR(mean(1 / 1.33f), 0.471949, 2e-6);
    EXPECT_NEAR(mean(1.5f), 0.091778, 2e-6);
    EXPECT_NEAR(mean(1 / 1.5f), 0.596346, 2e-6);
    EXPECT_NEAR(mean(1.8f), 0.134054, 2e-6);
    EXPECT_NEAR(mean(1 / 1.8f), 0.732733, 2e-6);
}

// Slab of n = 1.5 at an angle, polarisations averaged at each surface: T = (1-R)/(1+R). D2, D3.
TEST(Fresnel, SlabTransmittance) {
    const auto transmittance = [](double degrees) {
        const float r = fresnelDielectric(static_cast<float>(std::cos(degrees * kPiD / 180)), 1.5f);
        return static_cast<double>((1 - r) / (1 + r));
    };
    EXPECT_NEAR(transmittance(0), 0.9230769, 1e-6);
    // At Brewster's angle only the perpendicular part is reflected: R = ((n^2-1)/(n^2+1))^2 / 2.
    const double r = 0.5 * std::pow(1.25 / 3.25, 2);
    EXPECT_NEAR(transmittance(56.3099), (1 - r) / (1 + r), 1e-5);
}

TEST(Bsdf, TotalReflectionBeginsAtTheCriticalAngle) {  // analytic D5
    for (const auto& [ior, critical] : {std::pair{1.5f, 41.8103}, {1.33f, 48.7535}}) {
        const Bench bench(glassOf(ior));
        const auto inside = [&](double degrees) { return -atAngle(degrees); };
        EXPECT_TRUE(bench.bsdf(inside(critical - 0.01)).has(Lobe::kRefraction));
        const Bsdf beyond = bench.bsdf(inside(critical + 0.01));
        EXPECT_FALSE(beyond.has(Lobe::kRefraction));
        BsdfSample s;
        ASSERT_TRUE(beyond.sample(0.999f, {0.5f, 0.5f}, s));
        EXPECT_EQ(s.lobe, Lobe::kReflection);
        EXPECT_NEAR(s.weight.r, 1.0f, 1e-6f);
        EXPECT_LT(s.direction.z, 0.0f);
    }
}

// Snell's law both ways, weights (1-R) over its probability, eta^2 for radiance only.
TEST(Bsdf, RefractionObeysSnell) {
    Random random(6);
    const Bench bench(glassOf(1.5f));
    for (int i = 0; i < 2000; ++i) {
        Vec3f out = above(random);
        const bool fromInside = i % 2;
        if (fromInside) out.z = -out.z;
        const float eta = fromInside ? 1 / 1.5f : 1.5f;
        for (const Transport transport : {Transport::kRadiance, Transport::kPhotons}) {
            const Bsdf bsdf = bench.bsdf(out, transport);
            BsdfSample s;
            if (!bsdf.has(Lobe::kRefraction)) continue;
            ASSERT_TRUE(bsdf.sample(0.9999f, {0.5f, 0.5f}, s));
            if (s.lobe != Lobe::kRefraction) continue;  // almost all is reflected
            EXPECT_LT(s.direction.z * out.z, 0.0f);
            // In the plane of incidence, sines in the ratio of the indices.
            EXPECT_NEAR(s.direction.x, -out.x / eta, 2e-6f);
            EXPECT_NEAR(s.direction.y, -out.y / eta, 2e-6f);
            const float expected = transport == Transport::kRadiance ? 1 / (eta * eta) : 1.0f;
            EXPECT_NEAR(s.weight.r, expected, 1e-4f * expected);
        }
    }
}

TEST(Bsdf, MirrorAndTransparency) {
    MaterialDescription mirror;
    mirror.kind = MaterialKind::kMirror;
    mirror.glossy = Rgb(0.9f, 0.8f, 0.7f);
    BsdfSample s;
    ASSERT_TRUE(Bench(mirror).bsdf(atAngle(30)).sample(0.5f, {}, s));
    EXPECT_NEAR(s.direction.x, -0.5f, 1e-6f);
    EXPECT_NEAR(s.direction.z, std::sqrt(0.75f), 1e-6f);
    EXPECT_NEAR(s.weight.r, 0.9f, 1e-6f);
    EXPECT_NEAR(s.weight.b, 0.7f, 1e-6f);
    mirror.fresnelMirror = true;
    EXPECT_NEAR(Bench(mirror).bsdf(atAngle(0)).albedo().g, 0.8f, 1e-6f);
    EXPECT_NEAR(Bench(mirror).bsdf(atAngle(89.99)).albedo().g, 1.0f, 1e-3f);
    mirror.transparency = 1.0f;
    ASSERT_TRUE(Bench(mirror).bsdf(atAngle(30)).sample(0.5f, {}, s));
    EXPECT_EQ(s.lobe, Lobe::kStraight);
    EXPECT_EQ(s.direction, -atAngle(30));
}

}  // namespace
}  // namespace pm::test
