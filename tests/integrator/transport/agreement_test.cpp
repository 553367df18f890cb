// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The photon integrator against the path integrator, layer by layer and region by region: the test
// against lost or doubled light. The bias of density estimates that is allowed is stated with each.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "integrator/photons/trace/photon_tracer.h"
#include "tests/support/scene_maker.h"

namespace pm::test {
namespace {

constexpr auto kPhoton = IntegratorKind::kPhoton;
constexpr auto kPath = IntegratorKind::kPath;

// A box of 2 x 2 x 2 open towards the camera, lit from its ceiling.
SceneMaker cornellBox(std::uint32_t lampDivisions = 1, Rgb lamp = Rgb(8.0f)) {
    SceneMaker maker;
    const auto white = maker.diffuse(Rgb(0.7f));
    maker.quad({-1, -1, 1}, {2, 0, 0}, {0, 0, -2}, white);                              // floor
    maker.quad({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, white);                               // ceiling
    maker.quad({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, white);                              // back
    maker.quad({-1, -1, 1}, {0, 0, -2}, {0, 2, 0}, maker.diffuse({0.6f, 0.1f, 0.1f}));  // left
    maker.quad({1, -1, -1}, {0, 0, 2}, {0, 2, 0}, maker.diffuse({0.1f, 0.5f, 0.1f}));   // right
    maker.quad({-0.5, 0.95, -0.5}, {1, 0, 0}, {0, 0, 1}, maker.diffuse({}, lamp), lampDivisions);
    maker.camera({0, 0, 4.2}, {0, 0, 0}, {0, 1, 0}, 36);
    return maker;
}

MaterialDescription glass() {
    MaterialDescription m;
    m.kind = MaterialKind::kDielectric;
    return m;
}

// With a glossy box, a mirror and a glass sphere.
SceneMaker mixedBox() {
    SceneMaker maker = cornellBox();
    MaterialDescription glossy;
    glossy.diffuse = Rgb(0.3f, 0.3f, 0.1f);
    glossy.glossy = Rgb(0.4f);
    glossy.glossyExponent = 20;
    maker.box({-0.8, -1, -0.8}, {-0.2, 0, -0.2}, maker.material(glossy), false);
    MaterialDescription mirror;
    mirror.kind = MaterialKind::kMirror;
    mirror.glossy = Rgb(0.9f);
    maker.sphere({0.5, -0.6, -0.4}, 0.4, maker.material(mirror));
    maker.sphere({0.1, -0.65, 0.4}, 0.35, maker.material(glass()));
    return maker;
}

// Difference over its standard error, beyond a bias allowed relative to `scale`; the largest of the
// channels.
double studentT(const Measured& a, const Measured& b, double relativeBias, const Measured& scale) {
    double worst = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const double error = std::hypot(a.standardError[c], b.standardError[c]);
        const double allowed = relativeBias * std::max(b.mean[c], scale.mean[c]) + 1e-6 * b.mean[c];
        const double off = std::abs(a.mean[c] - b.mean[c]) - allowed;
        if (off > 0) worst = std::max(worst, off / std::max(error, 1e-12));
    }
    return worst;
}

// Sixteen passes have fifteen degrees of freedom: |t| > 6 comes once in 40 000, and there are some
// 200 of them.
constexpr double kLargestT = 6;

void expectRegionsAgree(const std::vector<MeasuredLayers>& a, const std::vector<MeasuredLayers>& b,
                        Measured MeasuredLayers::*layer, const char* name, double bias) {
    double worst = 0, unbiased = 0;
    const Measured& frame = b.back().*layer;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const Measured &x = a[i].*layer, &y = b[i].*layer;
        const double t = studentT(x, y, bias, frame);
        worst = std::max(worst, t);
        unbiased = std::max(unbiased, studentT(x, y, 0, frame));
        EXPECT_LT(t, kLargestT) << name << " in region " << i << ": photon " << x.mean[1] << " +- "
                                << x.standardError[1] << ", path " << y.mean[1] << " +- "
                                << y.standardError[1];
    }
    fmt::print("    {}: largest |t| over regions {:.2f}; beyond a bias of {:g} %: {:.2f}\n", name,
               unbiased, 100 * bias, worst);
}

// Every class of light in every region, and over the whole frame. Biases allowed: indirect light
// 1.5 % (the estimate's disc reaches round corners), caustics 5 % (a disc as wide as its radius
// blurs them from one region into the next).
TEST(Agreement, EveryLayerOfTheMixedBox) {
    const auto scene = mixedBox().build();
    std::vector<Rect> regions;
    for (int y = 0; y < 32; y += 8)
        for (int x = 0; x < 32; x += 8) regions.push_back({x, y, x + 8, y + 8});
    regions.push_back({0, 0, 32, 32});
    const auto render = [&](IntegratorKind integrator, std::uint32_t level) {
        RenderSettings settings = smallFrame(32, 32, integrator, 16, level);
        settings.photons = 60'000;
        return measureRegions(scene, settings, {0, 0, 32, 32}, regions);
    };
    const std::vector<MeasuredLayers> photon = render(kPhoton, 4), path = render(kPath, 5);
    expectRegionsAgree(photon, path, &MeasuredLayers::emission, "emission", 0);
    expectRegionsAgree(photon, path, &MeasuredLayers::direct, "direct", 0);
    expectRegionsAgree(photon, path, &MeasuredLayers::indirect, "indirect", 0.015);
    expectRegionsAgree(photon, path, &MeasuredLayers::caustic, "caustic", 0.05);
    const MeasuredLayers &a = photon.back(), &b = path.back();
    EXPECT_TRUE(agree(a.indirect, b.indirect, 0.01));
    EXPECT_TRUE(agree(a.caustic, b.caustic, 0.02));
    EXPECT_TRUE(agree(a.beauty, b.beauty, 0.005));
    // The classes sum to beauty.
    for (const MeasuredLayers& m : {a, b})
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(
                m.beauty.mean[c],
                m.direct.mean[c] + m.indirect.mean[c] + m.caustic.mean[c] + m.emission.mean[c],
                1e-6 * m.beauty.mean[c]);
    EXPECT_GT(b.caustic.mean[1], 0.01);
}

TEST(Agreement, MeanOfTheDiffuseBox) {
    const auto scene = cornellBox().build();
    RenderSettings settings = smallFrame(32, 32, kPhoton, 8, 4);
    settings.photons = 60'000;
    const MeasuredLayers photon = measure(scene, settings);
    settings.integrator = kPath;
    const MeasuredLayers path = measure(scene, settings);
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(photon.beauty.mean[c] / path.beauty.mean[c], 1, 0.01);
    EXPECT_TRUE(agree(photon.direct, path.direct, 0));
    EXPECT_TRUE(agree(photon.indirect, path.indirect, 0.01));
}

// A floor whose shading normals lean, so far too that parts of the frame see it from below them,
// under a lamp, between walls (hard cases S2).
TEST(Agreement, BentShadingNormals) {
    for (const Vec3d normal : {Vec3d{0.3, 1, 0.2}, Vec3d{0.5, 1, -1.5}}) {
        SceneMaker maker = cornellBox();
        maker.quad({-1, -0.98, 1}, {2, 0, 0}, {0, 0, -2}, maker.diffuse(Rgb(0.7f)));
        maker.bendNormals(normal);
        const auto scene = maker.build();
        RenderSettings settings = smallFrame(24, 24, kPhoton, 8, 4);
        settings.photons = 60'000;
        const MeasuredLayers photon = measure(scene, settings);
        const MeasuredLayers path = measure(scene, smallFrame(24, 24, kPath, 8, 5));
        EXPECT_TRUE(agree(photon.direct, path.direct, 0));
        EXPECT_TRUE(agree(photon.indirect, path.indirect, 0));
        // As many gather rays as one likes.
        settings.gatherRays = 4;
        const MeasuredLayers four = measure(scene, settings);
        EXPECT_TRUE(agree(four.indirect, photon.indirect, 0));
        EXPECT_TRUE(agree(four.direct, path.direct, 0));
    }
}

struct PhotonAndPath {
    MeasuredLayers photon, path;
};

PhotonAndPath photonAndPath(const std::shared_ptr<const Scene>& scene) {
    RenderSettings settings = smallFrame(24, 24, kPhoton, 8, 4);
    settings.photons = 60'000;
    return {measure(scene, settings), measure(scene, smallFrame(24, 24, kPath, 8, 6))};
}

// Caustics of a mirror or a pane of glass whose normals lean, so far too that lamp or camera are
// behind some of them: by one normal alone 1.15 of the mirror's, 1.04 and 1.08 of the pane's.
TEST(Agreement, BentMirrorsAndGlass) {
    for (const bool isGlass : {false, true})
        for (const Vec3d normal : {Vec3d{0.3, 1, 0.2}, Vec3d{0.9, 1, -0.3}}) {
            SCOPED_TRACE(fmt::format("{} {}", isGlass ? "glass" : "mirror", normal.x));
            SceneMaker maker = cornellBox();
            MaterialDescription mirror;
            mirror.kind = MaterialKind::kMirror;
            mirror.glossy = Rgb(0.9f);
            const auto material = maker.material(isGlass ? glass() : mirror);
            maker.quad({-0.6, -0.4, 0.6}, {1.2, 0, 0}, {0, 0, -1.2}, material);
            maker.bendNormals(normal);
            if (isGlass) {
                maker.quad({-0.6, -0.5, -0.6}, {1.2, 0, 0}, {0, 0, 1.2}, material);
                maker.bendNormals({0.2, -1, 0.4});
            }
            const auto [photon, path] = photonAndPath(maker.build());
            EXPECT_TRUE(agree(photon.direct, path.direct, 0));
            EXPECT_TRUE(agree(photon.indirect, path.indirect, 0));
            EXPECT_TRUE(agree(photon.caustic, path.caustic, 0.005));
        }
}

// A block of glass that stands exactly on the floor, and a lamp in the ceiling's plane. Where
// chance told which one a ray met, path lost all of the caustic and had 1.11 of the indirect light.
TEST(Agreement, GlassOnTheFloorAndALampInTheCeiling) {
    SceneMaker maker = cornellBox();
    maker.description.instances.pop_back();  // its lamp
    maker.quad({-0.5, 1, -0.5}, {1, 0, 0}, {0, 0, 1}, maker.diffuse({}, Rgb(8.0f)));
    maker.box({-0.5, -1, -0.5}, {0.3, -0.3, 0.3}, maker.material(glass()), false);
    const auto [photon, path] = photonAndPath(maker.build());
    EXPECT_TRUE(agree(photon.direct, path.direct, 0));
    EXPECT_TRUE(agree(photon.emission, path.emission, 0));
    EXPECT_TRUE(agree(photon.indirect, path.indirect, 0.005));
    EXPECT_TRUE(agree(photon.caustic, path.caustic, 0.005));
}

// A half-transparent sheet closely above a plate: photons that came through it to the plate counted
// on its upper side as well, which had five times its caustic light.
TEST(Agreement, ASheetCloselyAboveAPlate) {
    for (const double gap : {0.0003, 0.003}) {
        SceneMaker maker;
        MaterialDescription sheet;
        sheet.diffuse = Rgb(0.6f);
        sheet.transparency = 0.2f;
        maker.quad({-0.5, 0, 0.5}, {1, 0, 0}, {0, 0, -1}, maker.material(sheet));
        // Beyond the sheet's edges as well.
        maker.quad({-1, -gap, 1}, {2, 0, 0}, {0, 0, -2}, maker.diffuse(Rgb(0.6f)));
        maker.quad({-0.3, 1, -0.3}, {0.6, 0, 0}, {0, 0, 0.6}, maker.diffuse({}, Rgb(8.0f)));
        maker.camera({0, 0.8, 0.01}, {0, 0, 0}, {0, 0, -1}, 70);
        const auto [photon, path] = photonAndPath(maker.build());
        EXPECT_TRUE(agree(photon.direct, path.direct, 0)) << gap;
        EXPECT_TRUE(agree(photon.indirect, path.indirect, 0.02)) << gap;
        EXPECT_TRUE(agree(photon.caustic, path.caustic, 0.005)) << gap;
    }
}

// Gather rays that start below the surface have no value; the others of the same sample keep
// theirs. In a furnace, where there is little noise to hide in.
TEST(Agreement, GatherRaysOverABentFloor) {
    SceneMaker maker;
    const auto warm = maker.diffuse(Rgb(0.5f), Rgb(0.5f));
    maker.box({-1, -1, -1}, {1, 1, 1}, warm, true);
    maker.quad({-1, -0.9, 1}, {2, 0, 0}, {0, 0, -2}, warm);
    maker.bendNormals({0.6, 1, 0});
    maker.camera({0, 0.5, 0}, {0, -1, 0}, {0, 0, -1}, 40);
    const auto scene = maker.build();
    RenderSettings settings = smallFrame(16, 16, kPhoton, 8, 4);
    settings.photons = 50'000;
    const MeasuredLayers one = measure(scene, settings);
    settings.gatherRays = 4;
    const MeasuredLayers four = measure(scene, settings);
    EXPECT_TRUE(agree(four.indirect, one.indirect, 0));
    EXPECT_TRUE(agree(four.direct, one.direct, 0));
    EXPECT_LT(one.indirect.standardError[0], 0.005 * one.indirect.mean[0]);
}

// Under a glass sphere, and beside a mirror sphere, in the light of a lamp: flux of the caustic
// photons in a square of the floor, caustic layer of the photon integrator and of the path
// integrator (analytic D11). A camera that looks straight down sees equal areas in equal pixels.
TEST(Agreement, CausticOfASphere) {
    struct Case {
        bool isGlass;
        Vec3d eye;  // sees a square of side 2 eye.y
        double blur;
    };
    // Where reflected light is thin the discs are wide, and reach beyond the floor's edge.
    for (const Case& c : {Case{true, {0, 0.25, 0}, 0.02}, Case{false, {-0.8, 0.3, 0}, 0.05}}) {
        SceneMaker maker;
        maker.quad({-1.5, 0, 1.5}, {3, 0, 0}, {0, 0, -3}, maker.diffuse(Rgb(0.8f)));
        maker.quad({-2, 3, -2}, {4, 0, 0}, {0, 0, 4}, maker.diffuse({}, Rgb(1.0f)));
        MaterialDescription mirror;
        mirror.kind = MaterialKind::kMirror;
        mirror.glossy = Rgb(1.0f);
        maker.sphere({0, 0.8, 0}, 0.5, maker.material(c.isGlass ? glass() : mirror));
        maker.camera(c.eye, {c.eye.x, 0, 0}, {0, 0, -1}, 90);
        const auto scene = maker.build();
        RenderSettings settings = smallFrame(16, 16, kPhoton, 8, 4);
        settings.photons = 200'000;
        const MeasuredLayers photon = measure(scene, settings);
        const MeasuredLayers path = measure(scene, smallFrame(16, 16, kPath, 8, 6));
        const LightSampler lights(*scene);
        const std::uint64_t count = 1'000'000;
        double flux = 0, squares = 0;
        for (const Photon& p : tracePhotons(*scene, lights, {PhotonKind::kCaustic, count, 1, 0},
                                            std::atomic<bool>{false}, {})
                                   .photons) {
            const Vec3d at = Vec3d(p.position) + scene->centre() - c.eye;
            if (std::abs(at.x) > c.eye.y || std::abs(at.z) > c.eye.y) continue;
            flux += static_cast<double>(p.flux.r);
            squares += static_cast<double>(p.flux.r) * static_cast<double>(p.flux.r);
        }
        const double toRadiance = 0.8 / std::numbers::pi / (4 * c.eye.y * c.eye.y);
        Measured traced;
        traced.mean.fill(flux * toRadiance);
        traced.standardError.fill(std::sqrt(squares) * toRadiance);
        fmt::print(
            "    {}: by paths {:.5f} +- {:.5f}, photons' flux {:.5f} +- {:.5f}, layer "
            "{:.5f} +- {:.5f}\n",
            c.isGlass ? "glass" : "mirror", path.caustic.mean[0], path.caustic.standardError[0],
            traced.mean[0], traced.standardError[0], photon.caustic.mean[0],
            photon.caustic.standardError[0]);
        EXPECT_TRUE(agree(traced, path.caustic, 0));
        EXPECT_TRUE(agree(photon.caustic, path.caustic, c.blur));
        EXPECT_GT(path.caustic.mean[0], 30 * path.caustic.standardError[0]);
    }
}

// Four times the light is four times the picture, bit for bit; two lamps are the sum of each (B8).
TEST(Agreement, Linearity) {
    for (const auto integrator : {kPhoton, kPath}) {
        RenderSettings settings = smallFrame(16, 16, integrator, 4, 3);
        settings.photons = 20'000;
        // Not by the pilot, which sees noise beside the 0.01 of relMSE.
        settings.gatherRays = 24;
        const auto picture = [&](const SceneMaker& maker) {
            return measure(maker.build(), settings).beauty;
        };
        const Measured one = picture(cornellBox(1, Rgb(80.0f)));
        const Measured four = picture(cornellBox(1, Rgb(320.0f)));
        for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(four.mean[c], 4 * one.mean[c]);
        const auto lamps = [&](double left, double right) {
            SceneMaker maker = cornellBox(1, Rgb(0.0f));
            maker.pointLight({-0.5, 0.5, 0.5}, Rgb(static_cast<float>(left)));
            maker.pointLight({0.6, 0.2, 0.1}, Rgb(static_cast<float>(right)));
            return picture(maker);
        };
        const Measured left = lamps(1, 0), right = lamps(0, 2), both = lamps(1, 2);
        Measured sum = left;
        for (std::size_t c = 0; c < 3; ++c) {
            sum.mean[c] += right.mean[c];
            sum.standardError[c] = std::hypot(left.standardError[c], right.standardError[c]);
        }
        EXPECT_TRUE(agree(both, sum, integrator == kPhoton ? 0.01 : 0));
    }
}

// One quad or a hundred (B9); 4 sigma with seven degrees of freedom wants some room: 6.
TEST(Agreement, LampTessellation) {
    for (const auto integrator : {kPhoton, kPath}) {
        RenderSettings settings = smallFrame(24, 24, integrator, 8, 4);
        settings.photons = 60'000;
        const MeasuredLayers one = measure(cornellBox(1).build(), settings);
        const MeasuredLayers hundred = measure(cornellBox(10).build(), settings);
        EXPECT_TRUE(agree(hundred.direct, one.direct, 0, 6));
        EXPECT_TRUE(agree(hundred.indirect, one.indirect, 0, 6));
        EXPECT_TRUE(agree(hundred.emission, one.emission, 0, 6));
    }
}

// Sample counts change the noise, not the brightness (P12).
TEST(Agreement, BrightnessDoesNotDependOnSampleCounts) {
    const auto scene = mixedBox().build();
    const auto with = [&](std::uint32_t gatherRays, std::uint32_t level, std::uint64_t photons) {
        RenderSettings settings = smallFrame(24, 24, kPhoton, 8, level);
        settings.gatherRays = gatherRays;
        settings.photons = photons;
        return measure(scene, settings);
    };
    const MeasuredLayers reference = with(1, 4, 60'000);
    const auto check = [&](const MeasuredLayers& m, double bias, const char* what) {
        EXPECT_TRUE(agree(m.direct, reference.direct, 0, 6)) << what;
        EXPECT_TRUE(agree(m.indirect, reference.indirect, bias, 6)) << what;
        EXPECT_TRUE(agree(m.caustic, reference.caustic, 2 * bias, 6)) << what;
        EXPECT_TRUE(agree(m.emission, reference.emission, 0, 6)) << what;
    };
    check(with(4, 3, 60'000), 0, "4 gather rays");
    check(with(1, 1, 60'000), 0, "level 1");
    check(with(1, 2, 60'000), 0, "level 2");
    check(with(1, 3, 60'000), 0, "level 3");
    // Fewer photons, wider discs: the bias round corners grows.
    check(with(1, 4, 15'000), 0.015, "15 000 photons");
}

}  // namespace
}  // namespace pm::test
