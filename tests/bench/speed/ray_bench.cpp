// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/sampling/warps.h"
#include "integrator/scene/camera.h"
#include "tests/bench/run/bench_scenes.h"
#include "tests/bench/speed/bare_embree.h"
#include "tests/bench/speed/speed_bench.h"
#include "tests/support/draws.h"

namespace pm::bench {

namespace {

// Rays as a render makes them, one of each kind a pixel, in the order of the pixels.
struct RaySets {
    std::vector<Ray> camera, bounce, shadow;
};

RaySets makeRays(const Scene& scene) {
    constexpr std::int32_t kSize = 512;
    const Camera camera(scene, kSize, kSize);
    const LightSampler lights(scene);
    RaySets rays;
    for (std::int32_t y = 0; y < kSize; ++y)
        for (std::int32_t x = 0; x < kSize; ++x) {
            test::Draws sampler(1, 0, static_cast<std::uint64_t>(y * kSize + x), 0);
            const Vec2f jitter = sampler.next2D();
            rays.camera.push_back(
                camera.ray({x + static_cast<double>(jitter.x), y + static_cast<double>(jitter.y)}));
            Surface surface;
            if (!scene.intersect(rays.camera.back(), surface)) continue;
            const float side =
                dot(surface.geometricNormal, rays.camera.back().direction) > 0 ? -1.0f : 1.0f;
            const Frame frame(surface.geometricNormal * side);
            rays.bounce.push_back(
                rayFrom(surface, frame.toWorld(sampleCosineHemisphere(sampler.next2D()))));
            LightSample light;
            if (lights.sample(surface, sampler.next2D(), light))
                rays.shadow.push_back(light.shadowRay);
        }
    return rays;
}

// One kind of rays on one scene, by all who can trace them.
class RayRace {
  public:
    explicit RayRace(const Scene& scene)
        : m_scene(scene), m_own(scene), m_robust(scene, true), m_fast(scene, false) {}

    // The cells of a row: each rival's Mray/s, then ratios to robust Embree.
    std::vector<std::string> nearest(const std::vector<Ray>& rays, int turns) const {
        const auto times =
            takeTurns(turns, {[&] {
                                  Surface surface;
                                  for (const Ray& ray : rays)
                                      benchmark::DoNotOptimize(m_scene.intersect(ray, surface));
                              },
                              [&] {
                                  RayHit hit;
                                  for (const Ray& ray : rays)
                                      benchmark::DoNotOptimize(m_own.tracer().intersect(ray, hit));
                              },
                              [&] { benchmark::DoNotOptimize(m_robust.countHits(rays)); },
                              [&] { benchmark::DoNotOptimize(m_fast.countHits(rays)); }});
        return cells(rays.size(), times);
    }

    std::vector<std::string> occlusion(const std::vector<Ray>& rays, int turns) const {
        const auto times =
            takeTurns(turns, {[&] {
                                  for (const Ray& ray : rays)
                                      benchmark::DoNotOptimize(m_scene.occluded(ray));
                              },
                              [&] {
                                  for (const Ray& ray : rays)
                                      benchmark::DoNotOptimize(m_own.tracer().occluded(ray));
                              },
                              [&] { benchmark::DoNotOptimize(m_robust.countOccluded(rays)); },
                              [&] { benchmark::DoNotOptimize(m_fast.countOccluded(rays)); }});
        return cells(rays.size(), times);
    }

  private:
    static std::vector<std::string> cells(std::size_t rays,
                                          const std::vector<std::vector<double>>& times) {
        std::vector<std::string> row;
        for (const auto& seconds : times)
            row.push_back(show(rate(static_cast<double>(rays), seconds), 1e-6));
        row.push_back(show(speedRatio(times[0], times[2])));
        row.push_back(show(speedRatio(times[1], times[2])));
        return row;
    }

    const Scene& m_scene;
    LoneRayTracer m_own;
    BareEmbree m_robust, m_fast;
};

}  // namespace

void benchRays(Report& report, int turns) {
    report.table("Rays, Mray/s, one thread, one by one: median (quartiles) of interleaved turns",
                 {"scene, rays", "Scene (whole surface)", "RayTracer", "bare Embree, robust",
                  "bare Embree, fast", "Scene / bare robust", "RayTracer / bare robust"});
    const auto race = [&](const std::string& name, const test::SceneMaker& maker) {
        const auto scene = maker.build();
        const RaySets rays = makeRays(*scene);
        const RayRace race(*scene);
        const auto add = [&](const char* kind, std::vector<std::string> cells) {
            cells.insert(cells.begin(), fmt::format("{}, {}", name, kind));
            report.row(std::move(cells));
        };
        add("camera", race.nearest(rays.camera, turns));
        add("diffuse bounce", race.nearest(rays.bounce, turns));
        add("shadow", race.occlusion(rays.shadow, turns));
    };
    race("box of 32 triangles and 2 spheres", boxWithSpheres());
    race("room with 1 M triangles", roomWithMesh());
}

}  // namespace pm::bench
