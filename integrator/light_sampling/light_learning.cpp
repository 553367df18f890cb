// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What a LightSampler learns: which lights, and how much of the sky, reach where.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <vector>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/sampling/sampler.h"
#include "integrator/sampling/warps.h"

namespace pm {

namespace {

// Random numbers for trials, which nothing else uses.
constexpr std::uint64_t kTrialSeed = 0x6c69676874677565ull;
constexpr std::uint64_t kNoNode = ~std::uint64_t{0};
constexpr const char* kLooking = "looking which lamps reach where";

// Shadow rays that look which lights are hidden.
constexpr std::size_t kSightingsOfAPlace = 32;
constexpr std::size_t kMostSightings = 1 << 17;

// Whether an environment is hidden is looked at from about so many places, in so many directions.
// And the most places that a guide learns from.
constexpr std::size_t kPlacesOfSky = 512, kMostPlacesOfSky = 1024;
constexpr std::uint32_t kSightingsOfSky = 16;

}  // namespace

void LightSampler::learn(std::span<const LitPlace> places, std::uint64_t seed,
                         const CancelCheck& cancel) {
    if (!learns() || places.empty()) return;
    std::vector<Receiver> receivers;
    receivers.reserve(places.size());
    for (const LitPlace& place : places) receivers.push_back(receiverAt(place.surface, place.side));
    const std::uint64_t key = combineBits(seed, kTrialSeed);
    if (isGuided()) learnLights(places, receivers, key, cancel);
    if (m_scene.hasEnvironment()) learnSky(places, receivers, key, cancel);
}

void LightSampler::learnSky(std::span<const LitPlace> places, std::span<const Receiver> receivers,
                            std::uint64_t key, const CancelCheck& cancel) {
    if (!isSkyHidden(places, receivers, key)) return;
    const std::size_t step = (places.size() + kMostPlacesOfSky - 1) / kMostPlacesOfSky;
    std::vector<Receiver> some;
    for (std::size_t i = 0; i < places.size(); i += step) some.push_back(receivers[i]);
    m_skyGuide = std::make_unique<const SkyGuide>(
        m_scene.environment(), some, key, [&](std::size_t i, const Vec3f& direction) {
            cancel.throwIfSet(kLooking);
            return lookAtSky(places[i * step], some[i], direction);
        });
}

void LightSampler::learnLights(std::span<const LitPlace> places,
                               std::span<const Receiver> receivers, std::uint64_t key,
                               const CancelCheck& cancel) {
    m_tree->learn(look(places, key, cancel));
    m_guide = std::make_unique<const LightGuide>(
        *m_tree, receivers, [&](std::size_t place, std::uint32_t node, std::uint32_t number) {
            cancel.throwIfSet(kLooking);
            return lookFrom(places[place], node,
                            Sampler(key, node, place, number).get2D(Purpose::kDirect));
        });
}

float LightSampler::lookAtSky(const LitPlace& place, const Receiver& receiver,
                              const Vec3f& direction) const {
    const Rgb radiance = m_scene.skyRadiance(place.surface, receiver.normal, direction);
    return std::max(0.0f, dot(direction, receiver.normal)) *
           static_cast<float>(channelSum(radiance));
}

// Of directions as the environment chooses them, that a surface could receive light from.
bool LightSampler::isSkyHidden(std::span<const LitPlace> places,
                               std::span<const Receiver> receivers, std::uint64_t key) const {
    const std::size_t step = std::max<std::size_t>(1, places.size() / kPlacesOfSky);
    SkyLooks looks;
    for (std::size_t place = 0; place < places.size(); place += step) {
        const Sampler sampler(key, kNoNode - 1, place, 0);
        const Vec2f start = sampler.get2D(Purpose::kDirect);
        for (std::uint32_t i = 0; i < kSightingsOfSky; ++i) {
            float pdf;
            const Vec3f direction = m_scene.environment().sample(spreadPoint(i, start), pdf);
            if (!(dot(direction, receivers[place].normal) > 0.0f)) continue;
            ++looks.asked;
            if (lookAtSky(places[place], receivers[place], direction) > 0.0f) ++looks.seen;
        }
    }
    return looks.isHidden();
}

std::vector<Sighting> LightSampler::look(std::span<const LitPlace> places, std::uint64_t key,
                                         const CancelCheck& cancel) const {
    const std::size_t count = std::min(kSightingsOfAPlace * places.size(), kMostSightings);
    std::vector<std::optional<Sighting>> found(count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
        cancel.throwIfSet(kLooking);
        const std::size_t place = i % places.size(), number = i / places.size();
        const Sampler sampler(key, kNoNode, place, static_cast<std::uint32_t>(number));
        found[i] = lookFrom(places[place], LightTree::kRoot, sampler.get2D(Purpose::kDirect));
    });
    std::vector<Sighting> sightings;
    for (const auto& sighting : found)
        if (sighting) sightings.push_back(*sighting);
    return sightings;
}

std::optional<Sighting> LightSampler::lookFrom(const LitPlace& place, std::uint32_t node,
                                               Vec2f u) const {
    const Receiver receiver = receiverAt(place.surface, place.side);
    LightDescent descent{refined(u), node};
    m_tree->choose(receiver, {&descent, 1});
    u.x = toBelowOne(descent.u);
    LightSample sample;
    if (!this->sample({u, descent.node, descent.probability}, place.surface, sample) ||
        !(dot(sample.direction, receiver.normal) > 0.0f))
        return std::nullopt;
    return Sighting{descent.node, !isBlack(m_scene.transmittance(sample.shadowRay))};
}

}  // namespace pm
