// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/seen_lamps.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

#include "integrator/materials/bsdf.h"

namespace pm {

namespace {

// Paths of each camera sample where the pilot met a delta lobe, and where it saw a lamp, or more of
// it here than there: what is this even needs no more than one. See docs/decisions.md.
constexpr float kEven = 0.5f;
constexpr std::uint32_t kPathsAtDelta = 1, kPathsAtLamps = 8;
// Pilot paths along each side of a square, which reach so many pixels beyond it.
constexpr std::int32_t kPilots = 8;
constexpr float kBeyond = 1.0f;
// How far a filter reaches beyond a pixel, at most.
constexpr double kFilterReach = 1.0;
constexpr std::uint64_t kPilotSeed = 0x7365656e6c616d70ull;

// As in PathWalk: only light caught between lossless surfaces comes so far.
constexpr int kMaxEvents = 1000;
constexpr std::array<Lobe, 3> kDeltaLobes{Lobe::kReflection, Lobe::kRefraction, Lobe::kStraight};

bool isAreaLight(const Light& light) {
    return light.kind == Light::Kind::kTriangle || light.kind == Light::Kind::kSphere;
}

bool mayHaveDelta(const MaterialDescription& material) {
    return material.kind != MaterialKind::kSurface || material.transparency > 0.0f ||
           material.opacityTexture != kNoTexture;
}

std::int32_t squaresAlong(std::int32_t pixels) {
    return (pixels + SeenLamps::kSquare - 1) / SeenLamps::kSquare;
}

}  // namespace

SeenLamps::SeenLamps(const Scene& scene, const LightSampler& lights, const Camera& camera,
                     std::int32_t width, std::int32_t height)
    : m_scene(scene),
      m_lights(lights),
      m_camera(camera),
      m_width(width),
      m_height(height),
      m_columns(squaresAlong(width)),
      m_hasLamps(std::ranges::any_of(scene.lights(), isAreaLight)),
      m_balls(lampBalls(scene)) {
    if (m_hasLamps)
        m_shown = std::make_unique<std::atomic<std::uint8_t>[]>(
            static_cast<std::size_t>(m_columns) * static_cast<std::size_t>(squaresAlong(height)));
}

std::uint32_t SeenLamps::paths(std::int32_t x, std::int32_t y) const {
    return shownAt(x, y) & kPaths;
}

std::span<const LampImage> SeenLamps::images(std::int32_t x, std::int32_t y) const {
    if (!(shownAt(x, y) & kHasImages)) return {};
    const std::lock_guard lock(m_imagesMutex);
    return m_images.at({x / kSquare, y / kSquare});
}

std::uint8_t SeenLamps::shownAt(std::int32_t x, std::int32_t y) const {
    if (!m_hasLamps || x < 0 || y < 0 || x >= m_width || y >= m_height) return 0;
    const std::int32_t column = x / kSquare, row = y / kSquare;
    std::atomic<std::uint8_t>& kept =
        m_shown[static_cast<std::size_t>(row) * static_cast<std::size_t>(m_columns) +
                static_cast<std::size_t>(column)];
    std::uint8_t shown = kept.load(std::memory_order_relaxed);
    if (shown == 0) {
        shown = look(column, row);
        kept.store(shown, std::memory_order_relaxed);
    }
    return shown;
}

std::uint8_t SeenLamps::look(std::int32_t column, std::int32_t row) const {
    std::uint32_t paths = pathsFor(column, row);
    const bool hasImages = findImages(column, row);
    if (hasImages) paths = kPathsAtLamps;
    return static_cast<std::uint8_t>(kKnown | paths | (hasImages ? kHasImages : 0));
}

// Two threads may both come here: they find the same, and the first one's stays.
bool SeenLamps::findImages(std::int32_t column, std::int32_t row) const {
    if (m_balls.empty()) return false;
    const double x0 = column * kSquare, y0 = row * kSquare;
    std::vector<LampRay> rays;
    for (std::int32_t i = 0; i < kSquare * kSquare; ++i)
        addLampRays(m_scene, m_camera, x0 + i % kSquare + 0.5, y0 + i / kSquare + 0.5, rays);
    auto images =
        findLampImages(m_scene, m_camera, m_balls, x0 - kFilterReach, x0 + kSquare + kFilterReach,
                       y0 - kFilterReach, y0 + kSquare + kFilterReach, std::move(rays));
    if (images.empty()) return false;
    const std::lock_guard lock(m_imagesMutex);
    m_images.try_emplace({column, row}, std::move(images));
    return true;
}

std::uint32_t SeenLamps::pathsFor(std::int32_t column, std::int32_t row) const {
    const std::uint64_t square =
        static_cast<std::uint64_t>(row) << 32 | static_cast<std::uint32_t>(column);
    constexpr float kStep = (static_cast<float>(kSquare) + 2.0f * kBeyond) / kPilots;
    std::uint32_t paths = 0;
    float least = std::numeric_limits<float>::max(), most = 0.0f;
    for (std::int32_t i = 0; i < kPilots * kPilots; ++i) {
        Sampler sampler(kPilotSeed, 0, square, static_cast<std::uint32_t>(i));
        const Vec2f jitter = sampler.next2D();
        const float x = (static_cast<float>(i % kPilots) + jitter.x) * kStep - kBeyond;
        const float y = (static_cast<float>(i / kPilots) + jitter.y) * kStep - kBeyond;
        std::uint32_t rays = 0;
        const Ray ray = m_camera.ray(column * kSquare + static_cast<double>(x),
                                     row * kSquare + static_cast<double>(y));
        const float found = maxChannel(along(ray, sampler, rays));
        least = std::min(least, found);
        most = std::max(most, found);
        if (least < kEven * most) return kPathsAtLamps;
        if (rays > 1) paths = kPathsAtDelta;
    }
    return paths;
}

Rgb SeenLamps::along(const Ray& ray, Sampler& sampler, std::uint32_t& rays,
                     const Effort& effort) const {
    Waiting waiting{effort};
    waiting.branches[waiting.count++].ray = ray;
    Rgb found;
    while (waiting.count > 0) {
        Branch branch = waiting.branches[--waiting.count];
        do ++rays;
        while (step(branch, waiting, sampler, found));
    }
    return found;
}

// To the next surface, and on from there. False: nothing goes on.
bool SeenLamps::step(Branch& branch, Waiting& waiting, Sampler& sampler, Rgb& found) const {
    Surface surface;
    if (!m_scene.intersect(branch.ray, surface)) return false;
    const Vec3f out = -branch.ray.direction;
    if (surface.light != kNoLight)
        found += branch.throughput * m_lights.emittedRadiance(surface, out);
    if (!mayHaveDelta(m_scene.material(surface.material)) || ++branch.events == kMaxEvents)
        return false;
    const Bsdf bsdf(m_scene, surface, out, Transport::kRadiance, branch.throughput);
    if (bsdf.isBlackBody()) return false;
    const Branch arrived = branch;
    if (waiting.divisions >= waiting.effort.divisions) {
        const float uLobe = sampler.next1D();
        BsdfSample sample;
        return bsdf.sample(uLobe, sampler.next2D(), sample) && isDelta(sample.lobe) &&
               goOn(arrived, surface, bsdf, sample, waiting.effort, sampler, branch);
    }
    std::size_t followed = 0;
    for (const Lobe lobe : kDeltaLobes) {
        BsdfSample sample;
        Branch next;
        if (!bsdf.follow(lobe, sample) ||
            !goOn(arrived, surface, bsdf, sample, waiting.effort, sampler, next))
            continue;
        if (followed++ > 0) waiting.branches[waiting.count++] = branch;
        branch = next;
    }
    waiting.divisions += followed > 0 ? followed - 1 : 0;
    return followed > 0;
}

// Along a lobe from where `from` has arrived. False: the roulette ends it.
bool SeenLamps::goOn(const Branch& from, const Surface& surface, const Bsdf& bsdf,
                     const BsdfSample& sample, const Effort& effort, Sampler& sampler,
                     Branch& next) const {
    next.throughput = from.throughput * sample.weight;
    next.etaScale = from.etaScale;
    if (sample.lobe == Lobe::kRefraction) next.etaScale *= bsdf.etaSquared();
    next.events = from.events;
    const float carried = maxChannel(next.throughput) * next.etaScale;
    float least = effort.leastThroughput;
    if (from.events >= effort.events)
        least = std::max(least, maxChannel(from.throughput) * from.etaScale);
    if (carried < least) {
        const float survival = carried / least;
        if (!(sampler.next1D() < survival)) return false;
        next.throughput *= 1.0f / survival;
    }
    next.ray = rayFrom(surface, sample.direction);
    return true;
}

}  // namespace pm
