// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What a scene has no need of is not planned.
#include "integrator/transport/plan/plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>
#include <vector>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/photons/estimate/surface_patches.h"
#include "integrator/photons/trace/photon_tracer.h"
#include "integrator/transport/frame_renderer.h"
#include "tests/support/scene_maker.h"

namespace pm::test {
namespace {

Plan planOf(const SceneMaker& maker, RenderSettings settings = {}) {
    return makePlan(*maker.build(), settings);
}

bool hasNotice(const Plan& plan, NoticeCode code) {
    return std::ranges::any_of(plan.notices, [&](const Notice& n) { return n.code == code; });
}

// A grey floor with a wall, under a lamp that faces the floor.
SceneMaker litFloor() {
    SceneMaker maker;
    const auto grey = maker.diffuse(Rgb(0.5f));
    maker.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, grey);
    maker.quad({-1, 0, -1}, {2, 0, 0}, {0, 2, 0}, grey);
    maker.quad({-0.5, 1, -0.5}, {1, 0, 0}, {0, 0, 1}, maker.diffuse({}, Rgb(1.0f)));
    return maker;
}

SceneMaker mirrorBallOnFloor() {
    SceneMaker maker = litFloor();
    MaterialDescription mirror;
    mirror.kind = MaterialKind::kMirror;
    mirror.glossy = Rgb(1.0f);
    maker.sphere({0, 0.3, 0}, 0.2, maker.material(mirror));
    return maker;
}

TEST(Plan, ADiffuseSceneHasNoCausticMap) {
    const Plan plan = planOf(litFloor());
    EXPECT_TRUE(plan.tracePhotons);
    EXPECT_TRUE(plan.globalMap);
    EXPECT_FALSE(plan.causticMap);
    EXPECT_EQ(plan.causticPhotons, 0u);
    EXPECT_TRUE(plan.notices.empty());
}

TEST(Plan, AMirrorWantsACausticMap) {
    const SceneMaker maker = mirrorBallOnFloor();
    EXPECT_TRUE(planOf(maker).causticMap);
    RenderSettings settings;
    settings.photons = 1234;
    EXPECT_EQ(planOf(maker, settings).globalPhotons, 1234u);
    EXPECT_EQ(planOf(maker, settings).causticPhotons, 1234u);
    settings.integrator = IntegratorKind::kPath;
    EXPECT_FALSE(planOf(maker, settings).tracePhotons);
}

TEST(Plan, ManyLampsAreToldOf) {
    SceneMaker maker = litFloor();
    const auto told = [&maker] {
        return planOf(maker).explain().find("its own choice of them") != std::string::npos;
    };
    EXPECT_FALSE(told());
    for (int i = 0; i < 20; ++i)
        maker.quad({0.1 * i, 1, 0}, {0.01, 0, 0}, {0, 0, 0.01}, maker.diffuse({}, Rgb(1.0f)));
    EXPECT_TRUE(told());
}

TEST(Plan, PhotonsGoWithTheFrameNotTheCrop) {
    RenderSettings settings;
    settings.width = settings.height = 512;
    settings.window = {0, 0, 512, 512};
    const std::uint64_t whole = planOf(litFloor(), settings).globalPhotons;
    settings.window = {8, 8, 24, 24};
    EXPECT_EQ(planOf(litFloor(), settings).globalPhotons, whole);
    settings.width = 256;
    EXPECT_EQ(planOf(litFloor(), settings).globalPhotons, whole / 2);
    settings.width = settings.height = 8;
    EXPECT_GE(planOf(litFloor(), settings).globalPhotons, whole / 8);
    settings.width = settings.height = 1 << 16;
    EXPECT_LE(planOf(litFloor(), settings).globalPhotons, whole * 4);
}

// The maps of 8 passes of a huge frame fit into 0.55 GiB, whatever the number of passes asked for
// and the memory there is: a picture with more passes begins with those of one with fewer.
TEST(Plan, HugeFramesHaveMapsThatFit) {
    for (const SceneMaker& maker : {litFloor(), mirrorBallOnFloor()}) {
        RenderSettings settings;
        settings.width = settings.height = 16384;
        settings.passes = 1;
        const Plan one = planOf(maker, settings);
        settings.passes = 8;
        const Plan huge = planOf(maker, settings);
        EXPECT_EQ(huge.photonsPerPass(), one.photonsPerPass());
        EXPECT_LE(huge.heldMapBytes(8) + huge.buildingMapBytes(), std::uint64_t{560} << 20);
        EXPECT_NE(huge.explain().find("no more, so that the maps of 8 passes fit into 0.55 GiB"),
                  std::string::npos);
        EXPECT_NE(huge.explain().find(std::to_string(huge.globalPhotons) + " photons a pass"),
                  std::string::npos);
        settings.height = 16383;
        const Plan large = planOf(maker, settings);
        EXPECT_GT(large.photonsPerPass(), huge.photonsPerPass());
        EXPECT_EQ(large.explain().find("no more, so"), std::string::npos);
        settings.height = 16384;
        settings.photons = 480'000;
        EXPECT_EQ(planOf(maker, settings).globalPhotons, 480'000u);
    }
}

TEST(Plan, HowOftenPhotonsLandIsTriedFirst) {
    const auto scene = litFloor().build();
    const Plan plan = makePlan(*scene, {});
    const PhotonTraceRequest many{PhotonKind::kGlobal, 200'000};
    const PhotonBalance balance =
        tracePhotons(*scene, LightSampler(*scene), many, std::atomic<bool>{false}, {}).balance;
    const double landings =
        static_cast<double>(balance.stored) / static_cast<double>(balance.emitted);
    // Numbers up to 4 or so, of 1024 photons: four standard errors.
    EXPECT_NEAR(plan.landingsOfPhoton, landings, 4 * std::sqrt(landings / 1024));
}

TEST(Plan, NothingThatEmitsOrNothingDiffuseWantsNoPhotons) {
    SceneMaker dark;
    dark.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, dark.diffuse(Rgb(0.5f)));
    EXPECT_FALSE(planOf(dark).tracePhotons);
    SceneMaker black;
    black.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, black.diffuse({}, Rgb(1.0f)));
    EXPECT_FALSE(planOf(black).tracePhotons);
}

// Also where the plane is no coordinate plane; and a step on it, however huge the plane, is none.
TEST(Plan, OneFlatSurfaceWantsNoFinalGather) {
    for (const double size : {2.0, 1e4, 1e9}) {
        SceneMaker maker;
        const auto grey = maker.diffuse(Rgb(0.5f));
        maker.quad({-size / 2, 0.1, size / 2}, {size, 0, 0}, {0, 0, -size}, grey);
        maker.pointLight({0, 1, 0}, Rgb(1.0f));
        EXPECT_FALSE(planOf(maker).tracePhotons) << size;
        maker.box({-0.25, 0.1, -0.25}, {0.25, 0.6, 0.25}, grey, false);
        EXPECT_TRUE(planOf(maker).globalMap) << size;
    }
    SceneMaker tilted;
    const auto grey = tilted.diffuse(Rgb(0.5f));
    tilted.quad({1, 2, 3}, {1, 0.5, 0.25}, {-0.3, 0.7, 0.1}, grey, 4);
    tilted.pointLight({0, 9, 0}, Rgb(1.0f));
    EXPECT_FALSE(planOf(tilted).tracePhotons);
}

// A black lamp and black screens over a plane: whatever leaves the plane ends there. A lamp that
// reflects, glass, or a hole's picture is another matter.
TEST(Plan, BlackSurfacesPassNothingOn) {
    const auto planOver = [](const MaterialDescription& above, bool asSphere) {
        SceneMaker maker;
        const auto grey = maker.diffuse(Rgb(0.5f));
        maker.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, grey);
        maker.quad({-0.2, 1, -0.2}, {0.4, 0, 0}, {0, 0, 0.4}, maker.diffuse({}, Rgb(1.0f)));
        const auto material = maker.material(above);
        if (asSphere)
            maker.sphere({0, 0.5, 0}, 0.2, material);
        else
            maker.quad({-0.5, 0.5, 0}, {1, 0, 0}, {0, 0, 0.1}, material);
        return planOf(maker);
    };
    MaterialDescription reflecting, glossy, thin;
    reflecting.diffuse = Rgb(0.1f);
    glossy.glossy = Rgb(0.1f);
    glossy.glossyExponent = 100;
    thin.transparency = 0.5f;
    for (const bool asSphere : {false, true}) {
        EXPECT_FALSE(planOver({}, asSphere).tracePhotons) << asSphere;
        EXPECT_TRUE(planOver(reflecting, asSphere).globalMap) << asSphere;
        EXPECT_TRUE(planOver(glossy, asSphere).globalMap) << asSphere;
        EXPECT_TRUE(planOver(glossy, asSphere).causticMap) << asSphere;
        EXPECT_TRUE(planOver(thin, asSphere).tracePhotons) << asSphere;
    }
}

TEST(Plan, PathsThatNoEstimatorCoversAreNamed) {
    SceneMaker maker = litFloor();
    maker.pointLight({0, 0.5, 0}, Rgb(1.0f));
    EXPECT_FALSE(hasNotice(planOf(maker), NoticeCode::kNotCovered));
    MaterialDescription glossy;
    glossy.glossy = Rgb(0.5f);
    glossy.glossyExponent = 50;
    maker.quad({-1, 0, -1}, {2, 0, 0}, {0, 2, 0}, maker.material(glossy));
    EXPECT_FALSE(hasNotice(planOf(maker), NoticeCode::kNotCovered));
    RenderSettings paths;
    paths.integrator = IntegratorKind::kPath;
    EXPECT_TRUE(hasNotice(makePlan(*maker.build(), paths), NoticeCode::kNotCovered));
}

bool says(const Plan& plan, const std::string& text) {
    return plan.explain().find(text) != std::string::npos;
}

// Which estimator glossy surfaces have their caustics from, and why.
TEST(Plan, GlossyReceiversNameTheirEstimator) {
    const auto planOver = [](float roughness, bool withPoint, bool withGlass = true) {
        SceneMaker maker;
        MaterialDescription metal, glass;
        metal.kind = MaterialKind::kMirror;
        metal.glossy = Rgb(0.8f);
        metal.roughness = roughness;
        glass.kind = MaterialKind::kDielectric;
        maker.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, maker.material(metal));
        if (withGlass) maker.sphere({0, 0.5, 0}, 0.3, maker.material(glass));
        if (withPoint)
            maker.pointLight({0, 2, 0}, Rgb(1.0f));
        else
            maker.quad({-0.3, 2, -0.3}, {0.6, 0, 0}, {0, 0, 0.6}, maker.diffuse({}, Rgb(10.0f)));
        return planOf(maker);
    };
    const char* const wide = "roughness 0.25 or more: by photons";
    const char* const unmet = "of any roughness: by photons alone";
    const char* const narrow = "roughness below 0.25: by rays";
    for (const float roughness : {0.3f, 0.8f}) {
        EXPECT_TRUE(planOver(roughness, false).receivedMap);
        EXPECT_TRUE(says(planOver(roughness, false), wide));
        EXPECT_FALSE(says(planOver(roughness, false), unmet));
        EXPECT_TRUE(says(planOver(roughness, true), unmet));
    }
    EXPECT_FALSE(planOver(0.1f, false).receivedMap);
    EXPECT_TRUE(planOver(0.1f, true).receivedMap);
    EXPECT_TRUE(says(planOver(0.1f, true), unmet));
    EXPECT_FALSE(says(planOver(0.1f, true), narrow));
    EXPECT_FALSE(planOver(0.0f, true).receivedMap);
    EXPECT_FALSE(planOver(0.8f, true, false).receivedMap);
}

// A lobe that carries next to nothing, or spreads it widely; what light does not come to.
TEST(Plan, CausticsAreOfWhatLobesCarry) {
    const auto planWith = [](const MaterialDescription& material, double height = 0.3) {
        SceneMaker maker;
        maker.box({-1, -1, -1}, {1, 1, 1}, maker.diffuse(Rgb(0.5f)), true);
        maker.quad({-0.3, 0.99, -0.3}, {0.6, 0, 0}, {0, 0, 0.6}, maker.diffuse({}, Rgb(10.0f)));
        maker.sphere({0, height, 0}, 0.2, maker.material(material));
        return planOf(maker);
    };
    MaterialDescription mirror, glass, glossy;
    mirror.kind = MaterialKind::kMirror;
    mirror.glossy = Rgb(0.9f);
    EXPECT_TRUE(planWith(mirror).causticMap);
    const Plan outside = planWith(mirror, 3);
    EXPECT_FALSE(outside.causticMap);
    EXPECT_TRUE(outside.globalMap);
    EXPECT_TRUE(says(outside, "no caustic map: of 65536 photons aimed"));
    EXPECT_TRUE(hasNotice(outside, NoticeCode::kNoCausticPhotons));
    mirror.glossy = Rgb(1e-9f);
    EXPECT_FALSE(planWith(mirror).causticMap);
    glass.kind = MaterialKind::kDielectric;
    EXPECT_TRUE(planWith(glass).causticMap);
    glass.ior = 1;
    EXPECT_FALSE(planWith(glass).causticMap);
    glossy.diffuse = Rgb(0.4f);
    glossy.glossy = Rgb(0.2f);
    glossy.glossyExponent = 200;
    EXPECT_TRUE(planWith(glossy).causticMap);
    glossy.glossyExponent = 40;
    EXPECT_FALSE(planWith(glossy).causticMap);
    EXPECT_TRUE(says(planWith(glossy), "too broad"));
}

// One convex thing whose light from outside goes nowhere else; and what is not that.
TEST(Plan, OneConvexBodyWantsNoFinalGather) {
    enum class Body { kBall, kMesh, kBox, kLyingOpen, kLampInside, kInwardLamp, kTwo, kGlass };
    const auto planUnderSky = [](Body body) {
        SceneMaker maker;
        const auto grey = maker.diffuse(Rgb(0.5f));
        MaterialDescription glass;
        glass.kind = MaterialKind::kDielectric;
        if (body == Body::kBall || body == Body::kTwo)
            maker.sphere({1, 2, 3}, 0.7, grey);
        else if (body == Body::kMesh)
            maker.meshSphere({1, 2, 3}, 0.7, grey, false, 12);
        else if (body == Body::kGlass)
            maker.sphere({1, 2, 3}, 0.7, maker.material(glass));
        else if (body == Body::kLyingOpen)
            maker.meshSphere({1, 2, 3}, 0.7, grey, false, 12);
        else
            maker.box({-1, 0.3, 2}, {1.1, 0.7, 4.2}, grey, body == Body::kInwardLamp);
        if (body == Body::kLyingOpen) {
            auto& shape = maker.description.instances[0].shape;
            TriangleMesh mesh = *std::get<std::shared_ptr<const TriangleMesh>>(shape);
            mesh.triangles.pop_back();
            if (!mesh.materials.empty()) mesh.materials.pop_back();
            if (!mesh.normalIndices.empty()) mesh.normalIndices.pop_back();
            if (!mesh.texcoordIndices.empty()) mesh.texcoordIndices.pop_back();
            shape = std::make_shared<const TriangleMesh>(mesh);
        }
        if (body == Body::kTwo) maker.sphere({-1, 2, 3}, 0.7, grey);
        if (body == Body::kInwardLamp) maker.description.materials[grey].emission = Rgb(1.0f);
        if (body == Body::kLampInside) maker.pointLight({0, 0.5, 3}, Rgb(1.0f));
        maker.pointLight({0, 9, 0}, Rgb(1.0f));
        maker.quad({-1, 8, -1}, {2, 0, 0}, {0, 0, 2}, maker.diffuse({}, Rgb(1.0f)));
        maker.sky(Rgb(1.0f));
        return planOf(maker);
    };
    for (const Body body : {Body::kBall, Body::kMesh, Body::kBox}) {
        EXPECT_FALSE(planUnderSky(body).tracePhotons) << static_cast<int>(body);
        EXPECT_TRUE(says(planUnderSky(body), "one convex body")) << static_cast<int>(body);
    }
    for (const Body body : {Body::kLyingOpen, Body::kLampInside, Body::kInwardLamp, Body::kTwo})
        EXPECT_TRUE(planUnderSky(body).globalMap) << static_cast<int>(body);
}

// Clear glass of index 1 is met by no ray, whatever its shape.
TEST(Plan, InvisibleThingsAreMetByNoRay) {
    const auto sceneWith = [](float ior) {
        SceneMaker maker = litFloor();
        MaterialDescription glass;
        glass.kind = MaterialKind::kDielectric;
        glass.ior = ior;
        const auto index = maker.material(glass);
        maker.sphere({0, 0.5, 0}, 0.1, index);
        maker.box({-0.5, 0.2, -0.5}, {0.5, 0.3, 0.5}, index, false);
        return maker.build();
    };
    const auto hitsAt = [](const Scene& scene) {
        const Ray ray{Vec3f(Vec3d{0, 0.9, 0} - scene.centre()), {0, -1, 0}};
        Surface surface;
        EXPECT_TRUE(scene.intersect(ray, surface));
        EXPECT_EQ(scene.occluded({ray.origin, ray.direction, 0.85f}),
                  surface.position.y + scene.centre().y > 0.1);
        return static_cast<double>(surface.position.y) + scene.centre().y;
    };
    EXPECT_NEAR(hitsAt(*sceneWith(1.5f)), 0.6, 1e-6);
    EXPECT_NEAR(hitsAt(*sceneWith(1.0f)), 0, 1e-6);
}

// Patches of surfaces are made as the pixels ask for them, and are memory of the maps as well.
TEST(Plan, PatchesCountInTheMemoryOfTheMaps) {
    RenderSettings settings = smallFrame(32, 32, IntegratorKind::kPhoton, 1, 2);
    settings.photons = 2000;
    SceneMaker maker = litFloor();
    maker.camera({0, 1.5, 3}, {0, 0.3, 0}, {0, 1, 0}, 40);
    FrameRenderer renderer(maker.build(), settings);
    const std::atomic<bool> cancelled{false};
    renderer.beginPass(0, cancelled, {});
    const std::uint64_t before = renderer.counters().peakMapBytes;
    std::vector<float> weights(32 * 32);
    std::vector<float> pixels(weights.size() * static_cast<std::size_t>(renderer.layout().count));
    renderer.renderRegion(settings.window, pixels, weights, cancelled);
    const std::uint64_t after = renderer.counters().peakMapBytes;
    EXPECT_GT(after, before);
    EXPECT_LE(after, before + SurfacePatches::kMostBytes);
    renderer.beginPass(1, cancelled, {});
    EXPECT_GE(renderer.counters().peakMapBytes, after);
}

}  // namespace
}  // namespace pm::test
