// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/seen_lamps.h"

#include <algorithm>
#include <cstddef>
#include <limits>

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
constexpr std::uint64_t kPilotSeed = 0x7365656e6c616d70ull;

// A path divides so often, then lobes are chosen.
constexpr std::size_t kMostDivisions = 6;
// What carries less than this goes on by Russian roulette; after so many events what carries less
// than before does.
constexpr float kLeastThroughput = 0.01f;
constexpr int kEventsBeforeRoulette = 5;
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
      m_hasLamps(std::ranges::any_of(scene.lights(), isAreaLight)) {
    if (m_hasLamps)
        m_shown = std::make_unique<std::atomic<Shown>[]>(
            static_cast<std::size_t>(m_columns) * static_cast<std::size_t>(squaresAlong(height)));
}

std::uint32_t SeenLamps::paths(std::int32_t x, std::int32_t y) const {
    if (!m_hasLamps || x < 0 || y < 0 || x >= m_width || y >= m_height) return 0;
    const std::int32_t column = x / kSquare, row = y / kSquare;
    std::atomic<Shown>& kept =
        m_shown[static_cast<std::size_t>(row) * static_cast<std::size_t>(m_columns) +
                static_cast<std::size_t>(column)];
    Shown shown = kept.load(std::memory_order_relaxed);
    if (shown == Shown::kUnknown) {
        shown = look(column, row);
        kept.store(shown, std::memory_order_relaxed);
    }
    return shown == Shown::kLamps ? kPathsAtLamps : shown == Shown::kDelta ? kPathsAtDelta : 0;
}

SeenLamps::Shown SeenLamps::look(std::int32_t column, std::int32_t row) const {
    const std::uint64_t square =
        static_cast<std::uint64_t>(row) << 32 | static_cast<std::uint32_t>(column);
    constexpr float kStep = (static_cast<float>(kSquare) + 2.0f * kBeyond) / kPilots;
    Shown shown = Shown::kNeither;
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
        if (least < kEven * most) return Shown::kLamps;
        if (rays > 1) shown = Shown::kDelta;
    }
    return shown;
}

Rgb SeenLamps::along(const Ray& ray, Sampler& sampler, std::uint32_t& rays) const {
    Waiting waiting;
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
    if (waiting.divisions >= kMostDivisions) {
        const float uLobe = sampler.next1D();
        BsdfSample sample;
        return bsdf.sample(uLobe, sampler.next2D(), sample) && isDelta(sample.lobe) &&
               goOn(arrived, surface, bsdf, sample, sampler, branch);
    }
    std::size_t followed = 0;
    for (const Lobe lobe : kDeltaLobes) {
        BsdfSample sample;
        Branch next;
        if (!bsdf.follow(lobe, sample) || !goOn(arrived, surface, bsdf, sample, sampler, next))
            continue;
        if (followed++ > 0) waiting.branches[waiting.count++] = branch;
        branch = next;
    }
    waiting.divisions += followed > 0 ? followed - 1 : 0;
    return followed > 0;
}

// Along a lobe from where `from` has arrived. False: the roulette ends it.
bool SeenLamps::goOn(const Branch& from, const Surface& surface, const Bsdf& bsdf,
                     const BsdfSample& sample, Sampler& sampler, Branch& next) const {
    next.throughput = from.throughput * sample.weight;
    next.etaScale = from.etaScale;
    if (sample.lobe == Lobe::kRefraction) next.etaScale *= bsdf.etaSquared();
    next.events = from.events;
    const float carried = maxChannel(next.throughput) * next.etaScale;
    float least = kLeastThroughput;
    if (from.events >= kEventsBeforeRoulette)
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
