// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Photons on their own: what is emitted arrives, dies or escapes and nothing is lost; form factors;
// the same bits for any number of threads; the flux of a caustic.
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <array>
#include <cmath>
#include <cstring>
#include <set>

#include "integrator/photons/trace/photon_tracer.h"
#include "tests/support/scene_maker.h"

namespace pm::test {
namespace {

constexpr double kPiD = std::numbers::pi;

PhotonTraceResult trace(const std::shared_ptr<const Scene>& scene, std::uint64_t count,
                        PhotonKind kind = PhotonKind::kGlobal, std::uint64_t seed = 1) {
    const LightSampler lights(*scene);
    return tracePhotons(*scene, lights, {kind, count, seed, 0}, std::atomic<bool>{false}, {});
}

// Flux (red, W) of the photons for which inside(world position) holds.
template <typename Inside>
double fluxOf(const PhotonTraceResult& result, const Scene& scene, const Inside& inside) {
    double flux = 0;
    for (const Photon& photon : result.photons)
        if (inside(Vec3d(photon.position) + scene.centre()))
            flux += static_cast<double>(photon.flux.r);
    return flux;
}

MaterialDescription glass() {
    MaterialDescription m;
    m.kind = MaterialKind::kDielectric;
    m.ior = 1.5f;
    return m;
}

MaterialDescription mirror() {
    MaterialDescription m;
    m.kind = MaterialKind::kMirror;
    m.glossy = Rgb(0.9f);
    return m;
}

// In the order of their numbers, whatever batches they were traced in.
TEST(Photons, FewerAreTheFirstOfMore) {
    SceneMaker maker;
    maker.quad({-5, 0, 5}, {10, 0, 0}, {0, 0, -10}, maker.diffuse(Rgb(0.7f)));
    maker.pointLight({2, 3, 2}, Rgb(1.0f));
    const auto scene = maker.build();
    const auto more = trace(scene, 4 * 4096).photons, fewer = trace(scene, 4096).photons;
    ASSERT_GT(fewer.size(), 900u);
    for (std::size_t i = 0; i < fewer.size(); ++i)
        ASSERT_EQ(fewer[i].position, more[i].position) << i;
}

TEST(Photons, EnergyIsConserved) {
    SceneMaker maker;
    maker.quad({-5, 0, 5}, {10, 0, 0}, {0, 0, -10}, maker.diffuse({0.7f, 0.5f, 0.3f}));
    maker.quad({-5, 0, -5}, {10, 0, 0}, {0, 10, 0}, maker.diffuse({0.2f, 0.5f, 0.7f}));
    maker.quad({-1, 5, -1}, {2, 0, 0}, {0, 0, 2}, maker.diffuse({}, {3, 2, 1}));
    maker.sphere({-1.5, 1, 0}, 1, maker.material(glass()));
    maker.sphere({1.5, 1, 0}, 1, maker.material(mirror()));
    maker.pointLight({2, 3, 2}, {1, 2, 3});
    for (const PhotonKind kind : {PhotonKind::kGlobal, PhotonKind::kCaustic}) {
        const PhotonBalance b = trace(maker.build(), 100'000, kind).balance;
        EXPECT_EQ(b.emitted, 100'000u);
        EXPECT_NEAR((b.fluxAbsorbed + b.fluxEscaped + b.fluxLost) / b.fluxEmitted, 1, 1e-6);
        EXPECT_GT(b.fluxEscaped, 0.05 * b.fluxEmitted);
        EXPECT_NEAR(b.fluxEmitted, kPiD * 4 * 6 + 4 * kPiD * 6, 0.002 * b.fluxEmitted);
        EXPECT_EQ(b.lost, 0u);
    }
}

// A closed white-ish box: 1/(1 - rho) arrivals a photon; the flux that arrives is that much more
// than what was emitted, and all of it is absorbed (analytic C7).
TEST(Photons, MeanNumberOfHits) {
    SceneMaker maker;
    maker.box({-1, -1, -1}, {1, 1, 1}, maker.diffuse(Rgb(0.75f)), true);
    maker.pointLight({0.2, 0.1, -0.3}, Rgb(1.0f));
    const auto scene = maker.build();
    const std::uint64_t n = 100'000;
    const PhotonTraceResult result = trace(scene, n);
    // Geometric distribution: variance rho/(1-rho)^2 = 12.
    EXPECT_NEAR(static_cast<double>(result.balance.stored) / static_cast<double>(n), 4,
                4 * std::sqrt(12.0 / static_cast<double>(n)));
    const double arriving = fluxOf(result, *scene, [](const Vec3d&) { return true; });
    EXPECT_NEAR(arriving, 4 * kPiD * 4, 4 * kPiD * 4 * std::sqrt(12.0 / static_cast<double>(n)));
    EXPECT_EQ(result.balance.fluxEscaped, 0.0);
    EXPECT_NEAR(result.balance.fluxAbsorbed / result.balance.fluxEmitted, 1, 1e-9);
}

TEST(Photons, TheSameBitsForAnyThreads) {
    SceneMaker maker;
    maker.box({-1, -1, -1}, {1, 1, 1}, maker.diffuse(Rgb(0.75f, 0.5f, 0.2f)), true);
    maker.sphere({0.3, 0.2, 0}, 0.3, maker.material(glass()));
    maker.pointLight({0.2, 0.1, -0.9}, Rgb(1.0f));
    const auto scene = maker.build();
    const auto run = [&](int threads) {
        PhotonTraceResult result;
        tbb::task_arena(threads).execute([&] { result = trace(scene, 50'001); });
        return result;
    };
    const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 5);
    const PhotonTraceResult one = run(1);
    for (const int threads : {2, 5}) {
        const PhotonTraceResult many = run(threads);
        ASSERT_EQ(one.photons.size(), many.photons.size());
        EXPECT_EQ(std::memcmp(one.photons.data(), many.photons.data(),
                              one.photons.size() * sizeof(Photon)),
                  0);
        EXPECT_EQ(one.balance.fluxAbsorbed, many.balance.fluxAbsorbed);
    }
    EXPECT_NE(trace(scene, 1000, PhotonKind::kGlobal, 2).photons[0].position,
              trace(scene, 1000, PhotonKind::kGlobal, 1).photons[0].position);
}

// Pilots find the radii of estimates, so a photon of theirs that were one of a map's would count
// for its own disc (analytic F2); and passes are told apart to see the noise.
TEST(Photons, KindsAndPassesShareNone) {
    SceneMaker maker;
    maker.box({-1, -1, -1}, {1, 1, 1}, maker.diffuse(Rgb(0.5f)), true);
    maker.sphere({0.3, 0.2, 0}, 0.3, maker.material(glass()));
    maker.pointLight({0.2, 0.1, -0.9}, Rgb(1.0f));
    const auto scene = maker.build();
    const LightSampler lights(*scene);
    std::set<std::array<float, 3>> places;
    std::size_t count = 0;
    for (const PhotonKind kind : {PhotonKind::kGlobal, PhotonKind::kGlobalPilot,
                                  PhotonKind::kCaustic, PhotonKind::kCausticPilot})
        for (const std::uint32_t pass : {0u, 1u, 2u}) {
            const PhotonTraceRequest request{kind, 2000, 1, pass};
            for (const Photon& photon :
                 tracePhotons(*scene, lights, request, std::atomic<bool>{false}, {}).photons) {
                places.insert({photon.position.x, photon.position.y, photon.position.z});
                ++count;
            }
        }
    EXPECT_GT(count, 10'000u);
    EXPECT_GT(places.size(), count - 3);  // by chance two may meet in one point
}

// Share of a black emitting rectangle's flux that reaches the other surface.
double formFactor(const SceneMaker& maker, double emitted) {
    const auto scene = maker.build();
    const PhotonTraceResult result = trace(scene, 200'000);
    // The receiver is flat and alone: nothing arrives at it twice.
    return fluxOf(result, *scene, [](const Vec3d&) { return true; }) / emitted;
}

// Owen-scrambled points: the error is far below that of independent ones, 4 sqrt(F(1-F)/n).
double tolerance(double f) {
    return 4 * std::sqrt(f * (1 - f) / 200'000);
}

TEST(Photons, ParallelRectangles) {  // analytic A1
    for (const auto& [size, expected] :
         {std::pair{1.0, 0.19982490}, {2.0, 0.41525328}, {0.5, 0.06858959}, {10.0, 0.82699452}}) {
        SceneMaker maker;
        maker.quad({0, 0, 0}, {size, 0, 0}, {0, size, 0}, maker.diffuse({}, Rgb(1.0f)));
        maker.quad({0, 0, 1}, {0, size, 0}, {size, 0, 0}, maker.diffuse(Rgb(0.5f)));
        EXPECT_NEAR(formFactor(maker, kPiD * size * size), expected, tolerance(expected)) << size;
    }
}

TEST(Photons, PerpendicularRectangles) {  // analytic A2: W of the emitter, H of the receiver
    for (const auto& [w, h, expected] :
         {std::tuple{1.0, 1.0, 0.20004378}, {1.0, 2.0, 0.23285260}, {2.0, 1.0, 0.11642630}}) {
        SceneMaker maker;
        maker.quad({0, 0, 0}, {w, 0, 0}, {0, 1, 0}, maker.diffuse({}, Rgb(1.0f)));
        maker.quad({0, 0, 0}, {0, 1, 0}, {0, 0, h}, maker.diffuse(Rgb(0.5f)));
        EXPECT_NEAR(formFactor(maker, kPiD * w), expected, tolerance(expected)) << w << " " << h;
    }
}

// Irradiance under a light: flux on a small square over its area, against a closed form.
double irradianceAt(SceneMaker maker, Vec3d at, double half, std::uint64_t count) {
    maker.quad(at - Vec3d{half, half, 0}, {2 * half, 0, 0}, {0, 2 * half, 0},
               maker.diffuse(Rgb(0.5f)));
    const auto scene = maker.build();
    return fluxOf(trace(scene, count), *scene, [](const Vec3d&) { return true; }) /
           (4 * half * half);
}

TEST(Photons, SphereLight) {  // analytic B2: E = pi L (R/d)^2 cos(theta)
    SceneMaker maker;
    maker.sphere({0, 0, 2}, 1, maker.diffuse({}, Rgb(1.0f)));
    const double e = irradianceAt(maker, {0, 0, 0}, 0.05, 1'000'000);
    const double hits = e * 0.01 / (4 * kPiD * kPiD) * 1e6;
    EXPECT_NEAR(e / (kPiD * 0.25), 1, 4 / std::sqrt(hits) + 0.002);  // .002: not a point
}

TEST(Photons, PointLight) {  // analytic B3: I cos / d^2
    SceneMaker maker;
    maker.pointLight({std::sqrt(3.0), 0, 1}, Rgb(1.0f));
    const double e = irradianceAt(maker, {0, 0, 0}, 0.1, 1'000'000);
    const double hits = e * 0.04 / (4 * kPiD) * 1e6;
    EXPECT_NEAR(e / 0.125, 1, 4 / std::sqrt(hits) + 0.005);
}

// A disk as a polygon of 128 sides (its area is 4e-4 less): E = pi L a^2 / (a^2 + h^2). B4.
TEST(Photons, DiskLight) {
    SceneMaker maker;
    TriangleMesh mesh;
    mesh.positions.push_back({0, 0, 1});
    const std::uint32_t sides = 128;
    for (std::uint32_t i = 0; i < sides; ++i) {
        const double phi = 2 * kPiD * i / sides;
        mesh.positions.push_back(Vec3f(Vec3d{std::cos(phi), std::sin(phi), 1}));
        mesh.triangles.push_back({0, 1 + (i + 1) % sides, 1 + i});  // faces down
    }
    mesh.materials.assign(sides, 0);
    mesh.faces.assign(sides, 0);
    InstanceDescription disk;
    disk.shape = std::make_shared<const TriangleMesh>(mesh);
    disk.materials = {maker.diffuse({}, Rgb(1.0f))};
    maker.description.instances.push_back(disk);
    for (const auto& [r, f] : {std::pair{0.0, 0.5}, {0.5, 0.4379826}, {1.0, 0.2763932}}) {
        const double e = irradianceAt(maker, {r, 0, 0}, 0.1, 400'000);
        const double hits = e * 0.04 / (kPiD * kPiD) * 4e5;
        EXPECT_NEAR(e / (kPiD * f), 1, 4 / std::sqrt(hits) + 0.004) << r;
    }
}

// Flux through a slab far below a small lamp: E T over the floor's middle, T = 2n/(n^2+1).
// (analytic D2, D11; the slab also moves the light by less than its thickness.)
TEST(Photons, SlabCausticFlux) {
    SceneMaker maker;
    maker.quad({-0.5, -0.5, 0}, {1, 0, 0}, {0, 1, 0}, maker.diffuse(Rgb(0.5f)));
    maker.box({-40, -40, 1}, {40, 40, 1.001}, maker.material(glass()), false);
    maker.quad({-1, -1, 10}, {0, 2, 0}, {2, 0, 0}, maker.diffuse({}, Rgb(1.0f)));
    const auto scene = maker.build();
    const double n = 2'000'000;
    const PhotonTraceResult result = trace(scene, 2'000'000, PhotonKind::kCaustic);
    const double flux = fluxOf(result, *scene, [](const Vec3d& p) { return p.z < 0.5; });
    // Flux between the squares without the slab: L cos^2 / d^2 over both, by quadrature.
    double expected = 0;
    const int m = 12;
    for (int i = 0; i < m * m * m * m; ++i) {
        const auto cell = [&](int k, double size) { return size * ((k + 0.5) / m - 0.5); };
        const double dx = cell(i % m, 2) - cell(i / m % m, 1);
        const double dy = cell(i / (m * m) % m, 2) - cell(i / (m * m * m), 1);
        const double d2 = dx * dx + dy * dy + 100;
        expected += 4 * 100 / (d2 * d2) / std::pow(m, 4);
    }
    const double hits = expected / (4 * kPiD) * n;
    EXPECT_NEAR(flux / expected, 2 * 1.5 / (1.5 * 1.5 + 1), 4 / std::sqrt(hits) + 0.001);
    EXPECT_EQ(result.balance.lost, 0u);
}

}  // namespace
}  // namespace pm::test
