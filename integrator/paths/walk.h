// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <new>
#include <type_traits>
#include <vector>

#include "integrator/caches/cache_watch.h"
#include "integrator/materials/bsdf.h"
#include "integrator/paths/segment.h"
#include "integrator/paths/vertex.h"
#include "integrator/sampling/event_count.h"
#include "integrator/sampling/sampler.h"
#include "integrator/scene/scene.h"
#include "integrator/shapes/ray_footprint.h"
#include "integrator/shapes/surface.h"
#include "integrator/values/rgb.h"

namespace pm {

// A path on its way from event to event, of light or of what looks for it.
struct PathStep {
    Ray ray;                 // to follow next
    RayFootprint footprint;  // of the ray
    Sampler random;          // at the event where the ray will end
    Rgb carried{1.0f};       // throughput from the camera, or a photon's flux
    EventCount events{};

    // On by a lobe. What is told from others by its viewer is, straight on, what it was.
    void goOn(const Ray& onwards, Lobe lobe) {
        const Viewers viewer = ray.viewer;
        ray = onwards;
        if (lobe == Lobe::kStraight) ray.viewer = viewer;
        random.nextEvent();
    }
};

// Branches of a path that wait to be followed, the last one first.
template <typename Step>
class Waiting {
  public:
    static_assert(std::is_trivially_copyable_v<Step>);

    Waiting() {}  // leaves the places as they are: most paths need none
    void add(const Step& step) {
        if (m_count < kInPlace)
            new (place(m_count)) Step(step);
        else
            m_more.push_back(step);
        ++m_count;
    }
    bool take(Step& step) {
        if (m_count == 0) return false;
        if (--m_count < kInPlace) {
            step = *place(m_count);
        } else {
            step = m_more.back();
            m_more.pop_back();
        }
        return true;
    }

  private:
    static constexpr std::size_t kInPlace = 16;

    Step* place(std::size_t i) { return std::launder(reinterpret_cast<Step*>(m_places)) + i; }

    alignas(Step) std::byte m_places[kInPlace * sizeof(Step)];
    std::size_t m_count = 0;
    std::vector<Step> m_more;
};

// What becomes of a path where it has met a surface.
enum class Verdict : std::uint8_t {
    kEnd,
    kPass,     // it has gone on without being scattered
    kScatter,  // the surface scatters it
};

// Follows a path through the scene, and all its branches to their ends: the one loop in which light
// is scattered. Who follows it, for what, is a policy's business, which is known when this is
// compiled:
//   Step                           derives from PathStep: what else this policy carries along
//   kTransport                     of radiance or of photons
//   CacheUser user(step)           for caches that are asked
//   void setOut(step)              a ray is about to be followed
//   void meetNothing(step)         and has met nothing
//   Verdict meet(step, surface)    or a surface: emission, what is hidden from whom
//   bool scatter(step, surface, bsdf, waiting)
//                                  what light comes from the surface, and by which lobe the step
//                                  goes on, others waiting; false: it does not
// What media absorb has been taken off step.carried wherever a policy is called.
template <typename Policy>
void walk(const Scene& scene, Policy&& policy, typename std::decay_t<Policy>::Step step) {
    using Kind = std::decay_t<Policy>;
    Waiting<typename Kind::Step> waiting;
    const auto goesOn = [&] {
        const CacheWatch::As as(policy.user(step));
        policy.setOut(step);
        Vertex vertex;
        Surface& surface = vertex.surface;
        if (!meet(scene, step.ray, surface, &step.footprint, step.carried)) {
            policy.meetNothing(step);
            return false;
        }
        const Verdict verdict = policy.meet(step, surface);
        if (verdict != Verdict::kScatter) return verdict == Verdict::kPass;
        Bsdf bsdf = vertex.closure(scene, -step.ray.direction, Kind::kTransport, step.carried);
        return policy.scatter(step, surface, bsdf, waiting);
    };
    do
        while (goesOn()) {
        }
    while (waiting.take(step));
}

}  // namespace pm
