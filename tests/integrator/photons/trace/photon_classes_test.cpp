// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The classes of photons: together they are all light that arrives, each arrival in one of them;
// and of each class nothing is lost on the way.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>

#include "integrator/photons/emission/aimed_emission.h"
#include "integrator/photons/estimate/caustic_map.h"
#include "integrator/photons/trace/photon_tracer.h"
#include "integrator/sampling/sampler.h"
#include "tests/support/replicates.h"
#include "tests/support/rooms.h"

namespace pm::test {
namespace {

const std::atomic<bool> kNotCancelled{false};

// Photons of a scene, aimed where they are to be.
struct Tracing {
    std::shared_ptr<const Scene> scene;
    LightSampler lights;
    AimedEmission aim;

    explicit Tracing(std::shared_ptr<const Scene> scene_)
        : scene(std::move(scene_)), lights(*scene), aim(*scene, lights) {
        PhotonTraceRequest request{PhotonKind::kCausticPilot, 20'000, 1, 1, &aim};
        request.keepRecords = true;
        if (!aim.empty())
            aim.refine(tracePhotons(*scene, lights, request, kNotCancelled, {}).records);
    }
    PhotonTraceResult operator()(const PhotonTraceRequest& request) const {
        return tracePhotons(*scene, lights, request, kNotCancelled, {});
    }
    // Every arrival.
    PhotonTraceResult all(std::uint64_t count, std::uint64_t seed) const {
        return (*this)({PhotonKind::kGlobal, count, seed, 0});
    }
    // Arrivals but those by way of a caustic.
    PhotonTraceResult withoutCaustics(std::uint64_t count, std::uint64_t seed) const {
        PhotonTraceRequest request{PhotonKind::kGlobal, count, seed, 0};
        request.withoutCaustics = true;
        return (*this)(request);
    }
    // Caustics, and what descends from them.
    PhotonTraceResult caustics(std::uint64_t count, std::uint64_t seed, float descent,
                               bool aimed) const {
        PhotonTraceRequest request{PhotonKind::kCaustic, count, seed, 0};
        request.aim = aimed ? &aim : nullptr;
        request.descent = descent;
        return (*this)(request);
    }
};

// Flux of each channel, and its moments over places and normals.
constexpr std::size_t kMoments = 8;
using Moments = std::array<double, kMoments>;

void addTo(Moments& sum, std::span<const Photon> photons) {
    for (const Photon& photon : photons) {
        const Vec3d p(photon.position), n(photon.normal.unpack());
        const auto r = static_cast<double>(photon.flux.r), g = static_cast<double>(photon.flux.g),
                   b = static_cast<double>(photon.flux.b);
        const Moments values = {r, g, b, g * p.x, g * p.y, g * p.z * p.z, g * n.y, g * n.x};
        for (std::size_t i = 0; i < kMoments; ++i) sum[i] += values[i];
    }
}

Replicated spreadOf(const std::vector<Moments>& all, std::size_t moment) {
    std::vector<RegionMeans> renders;
    for (const Moments& m : all) {
        LayerMeans means{};
        means[kBeauty][0] = m[moment];
        renders.push_back({means});
    }
    return spread(renders, 0, kBeauty, 0);
}

class PhotonClasses : public ::testing::TestWithParam<Room> {};

INSTANTIATE_TEST_SUITE_P(Rooms, PhotonClasses, ::testing::ValuesIn(roomsOfEveryLobe()), roomName);

// Light that the three kinds of photons bring is what all photons of one kind bring, wherever it
// arrives and whatever share of the caustics is followed on.
TEST_P(PhotonClasses, AddUp) {
    const Tracing trace(GetParam().maker.build());
    constexpr int kReplicates = 20;
    struct Case {
        float descent;
        bool aimed;
    };
    std::vector<Moments> whole(kReplicates);
    for (std::uint64_t i = 0; i < kReplicates; ++i)
        addTo(whole[i], trace.all(30'000, i + 1).photons);
    for (const Case& c : {Case{1.0f, false}, Case{0.25f, false}, Case{0.25f, true}}) {
        std::vector<Moments> sum(kReplicates);
        double descended = 0;
        for (std::uint64_t i = 0; i < kReplicates; ++i) {
            addTo(sum[i], trace.withoutCaustics(20'000, i + 100).photons);
            const PhotonTraceResult caustics = trace.caustics(20'000, i + 100, c.descent, c.aimed);
            addTo(sum[i], caustics.photons);
            addTo(sum[i], caustics.descended);
            Moments ofDescended{};
            addTo(ofDescended, caustics.descended);
            descended += ofDescended[1] / kReplicates;
        }
        for (std::size_t m = 0; m < kMoments; ++m) {
            const Replicated got = spreadOf(sum, m), want = spreadOf(whole, m);
            EXPECT_LT(zScore(got, want, 0), 4) << fmt::format(
                "moment {}, descent {}: {:.5f} +- {:.5f}, all {:.5f} +- {:.5f}", m, c.descent,
                got.mean, got.standardError, want.mean, want.standardError);
        }
        const Replicated green = spreadOf(sum, 1);
        fmt::print("    {}, {:g} followed on{}: {:.4f} of all +- {:.4f}, descended {:.4f}\n",
                   GetParam().name, c.descent, c.aimed ? ", aimed" : "",
                   green.mean / spreadOf(whole, 1).mean,
                   std::hypot(green.standardError, spreadOf(whole, 1).standardError) / green.mean,
                   descended / green.mean);
    }
}

// emitted = absorbed + escaped + lost, and nothing that was stored is counted twice, for all kinds.
TEST_P(PhotonClasses, EnergyIsConserved) {
    const Tracing trace(GetParam().maker.build());
    const auto check = [&](const PhotonTraceResult& result, const char* what) {
        const PhotonBalance& b = result.balance;
        EXPECT_NEAR((b.fluxAbsorbed + b.fluxEscaped + b.fluxLost) / b.fluxEmitted, 1, 1e-6) << what;
        EXPECT_EQ(b.stored, result.photons.size() + result.descended.size()) << what;
        EXPECT_EQ(b.emitted, 20'000u) << what;
        EXPECT_EQ(b.lost, 0u) << what;
        EXPECT_GT(b.fluxEscaped, 0.0) << what;
    };
    check(trace.all(20'000, 1), "all");
    check(trace.withoutCaustics(20'000, 1), "without caustics");
    for (const float descent : {0.0f, 0.25f, 1.0f})
        for (const bool aimed : {false, true})
            check(trace.caustics(20'000, 1, descent, aimed), aimed ? "aimed" : "unaimed");
    EXPECT_TRUE(trace.caustics(20'000, 1, 0, true).descended.empty());
}

// Above a lamp that shines down on a ball of glass all light is reflected by the ball, once
TEST(PhotonClasses, WeakReflectionsHaveManyPhotons) {
    SceneMaker maker;
    maker.box({-1, -1, -1}, {1, 1, 1}, maker.diffuse(Rgb(0.5f)), true);
    maker.sphere({0, -0.3, 0}, 0.4, maker.material(glass()));
    maker.quad({-0.1, 0.5, -0.1}, {0.2, 0, 0}, {0, 0, 0.2}, maker.diffuse({}, Rgb(5.0f)));
    const Tracing trace(maker.build());
    double flux = 0, above = 0, photonsAbove = 0;
    const PhotonTraceResult caustics = trace.caustics(40'000, 1, 0, true);
    for (const Photon& photon : caustics.photons) {
        const auto carried = static_cast<double>(photon.flux.g);
        flux += carried;
        if (photon.position.y < 0.5f) continue;
        above += carried;
        ++photonsAbove;
    }
    const auto photons = static_cast<double>(caustics.photons.size());
    fmt::print("    {:.4f} of the flux, {:.4f} of the photons\n", above / flux,
               photonsAbove / photons);
    EXPECT_GT(photonsAbove / photons, 2 * above / flux);
}

// Before the first diffuse surface light is no caustic, after it it stays what it was.
TEST(PhotonClasses, NothingWithoutOtherLobes) {
    const Tracing trace(roomsOfEveryLobe().front().maker.build());
    const PhotonTraceResult caustics = trace.caustics(20'000, 1, 1, false);
    EXPECT_TRUE(caustics.photons.empty());
    EXPECT_TRUE(caustics.descended.empty());
    EXPECT_EQ(trace.all(20'000, 1).photons.size(), trace.withoutCaustics(20'000, 1).photons.size());
}

// A sheet that light reaches by way of glass that bends next to none, and of a mirror behind it:
// each side shows its own light only.
TEST(PhotonClasses, NoCausticFromBehind) {
    SceneMaker maker;
    maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.diffuse(Rgb(0.5f)));
    const MaterialDescription clear = glass(1.00001f);
    maker.quad({-3, -3, 1}, {6, 0, 0}, {0, 6, 0}, maker.material(clear));
    maker.pointLight({0, 0, 2}, Rgb(1.0f));
    const auto scene = maker.build();
    const Tracing trace(scene);
    constexpr std::uint64_t kCount = 400'000;
    const auto photons = [&](PhotonKind kind, std::uint64_t count) {
        return trace({kind, count, 1, 0}).photons;
    };
    const PilotRadius radius(photons(PhotonKind::kCausticPilot, kCount / PilotRadius::kPilotShare),
                             800, 0.1f);
    const CausticMap map(photons(PhotonKind::kCaustic, kCount), radius, 1);
    NearestPhotons scratch;
    for (const double x : {-0.7, 0.0, 0.3}) {
        const Vec3f p(Vec3d{x, 0.2, 0} - scene->centre());
        EXPECT_EQ(map.irradiance(p, {0, 0, -1}, scratch).wide, Rgb());
        const double d2 = x * x + 0.04 + 4;
        EXPECT_NEAR(static_cast<double>(map.irradiance(p, {0, 0, 1}, scratch).wide.r),
                    2 / (d2 * std::sqrt(d2)), 0.1 * 2 / (d2 * std::sqrt(d2)));
    }
}

}  // namespace
}  // namespace pm::test
