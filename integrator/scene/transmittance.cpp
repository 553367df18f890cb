// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Scene: what a ray between two points goes through.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "integrator/materials/straight_share.h"
#include "integrator/scene/media.h"
#include "integrator/scene/scene.h"
#include "integrator/scene/shape_record.h"

namespace pm {

namespace {

struct Crossing {
    RayHit hit;
    // Of light that goes straight on; of a face of glass it is asked afterwards, see StraightWay.
    float share;
    bool isOfGlass;
};

// What a ray crosses; most rays cross few.
class Crossings {
  public:
    void add(const Crossing& crossing) {
        if (m_count < kFew) {
            m_few[m_count++] = crossing;
            return;
        }
        if (m_many.empty()) m_many.assign(m_few.begin(), m_few.end());
        m_many.push_back(crossing);
    }
    // By distance, shape and primitive, however they were found.
    std::span<const Crossing> sorted() {
        const std::span<Crossing> all = m_many.empty() ? std::span(m_few).first(m_count) : m_many;
        std::ranges::sort(all, {}, [](const Crossing& c) {
            return std::tuple(c.hit.t, c.hit.shape, c.hit.primitive);
        });
        return all;
    }

  private:
    static constexpr std::size_t kFew = 16;
    std::array<Crossing, kFew> m_few;
    std::size_t m_count = 0;
    std::vector<Crossing> m_many;  // all, where they are more
};

}  // namespace

Rgb Scene::straightShare(const Surface& surface, const Vec3f& direction) const {
    if (!m_traits[surface.material].letsThrough() && !(surface.eta > 0.0f)) return {};
    return pm::straightShare(m_materials, surface,
                             opacityAt(m_materials, surface.material, pm::contextAt(surface)),
                             dot(direction, surface.geometricNormal) < 0.0f);
}

// Of what is no glass.
float Scene::openShare(const Ray& ray, const RayHit& hit) const {
    const std::uint32_t index = m_shapes[hit.shape].materialOf(hit.primitive);
    if (!m_traits[index].isCutAway) return 0.0f;
    const MaterialDescription& material = m_materials[index];
    TextureContext at;
    if (material.opacityTexture != kNoTexture || material.kind == MaterialKind::kMixture)
        at = contextAt(ray, hit);
    return 1.0f - opacityAt(m_materials, index, at);
}

// Whether they are so close behind each other that a path which goes straight on from the first
// does not meet the other: neighbours at their edge, faces in one place.
bool Scene::areOne(const Ray& ray, const RayHit& crossing, const RayHit& next) const {
    const auto offsetAndSlope = [&](const RayHit& hit) {
        Surface surface;
        surfaceAt(hit, surface, {&ray, nullptr, true});
        return std::pair(surface.offset, std::abs(dot(surface.geometricNormal, ray.direction)));
    };
    const auto [offset, slope] = offsetAndSlope(crossing);
    const auto [offsetNext, slopeNext] = offsetAndSlope(next);
    return (next.t - crossing.t) * slope <= offset + offsetNext;
}

// What is left of light on a way straight from medium to medium.
class Scene::StraightWay {
  public:
    StraightWay(const Scene& scene, const Ray& ray)
        : m_scene(scene), m_ray(ray), m_length(length(ray.direction)) {}

    // Through what is cut away of a sheet.
    void pass(float share) { m_left *= share; }
    enum class Entered { kNothing, kGlass, kStopped };
    // Through a face of glass. isOne: with the one crossed before, so that it counts with that but
    // for what is behind it.
    Entered enter(const RayHit& hit, bool isOne) {
        if (hit.t < m_skippedTo) return Entered::kNothing;
        Surface surface;
        m_scene.surfaceAt(hit, surface, {&m_ray, nullptr, true});
        const bool isLeft = dot(m_ray.direction, surface.geometricNormal) > 0.0f;
        const bool isFace = !m_scene.m_media || m_scene.m_media->resolve(m_ray.direction, surface);
        if (m_scene.m_media)
            absorb(surface.medium, hit.t);
        else
            absorb(isLeft ? static_cast<std::int32_t>(surface.material) : kNoMedium, hit.t);
        m_behind = rayOrigin(surface, m_ray.direction);
        m_hasEntered = !isLeft;
        m_lastOfGlass = static_cast<std::int32_t>(surface.material);
        if (!isFace) return Entered::kNothing;
        // Past a gap to what stands in the other body.
        m_skippedTo = dot(*m_behind - m_ray.origin, m_ray.direction) / (m_length * m_length);
        const Rgb share = m_scene.straightShare(surface, m_ray.direction);
        m_left *= isOne ? Rgb(1.0f / straightEtaSquared(m_scene.m_materials[surface.material],
                                                        surface, !isLeft))
                        : share;
        return isBlack(share) ? Entered::kStopped : Entered::kGlass;
    }
    Rgb end() {
        if (!m_scene.m_absorbs) return m_left;
        if (m_scene.m_media)
            absorb(m_scene.m_media->at(m_behind.value_or(m_ray.origin)), m_ray.tMax);
        else if (m_hasEntered)
            absorb(m_lastOfGlass, m_ray.tMax);
        return m_left;
    }

  private:
    void absorb(std::int32_t medium, float t) {
        if (m_scene.m_absorbs) m_left *= m_scene.leftIn(medium, (t - m_from) * m_length);
        m_from = t;
    }

    const Scene& m_scene;
    const Ray& m_ray;
    const float m_length;
    Rgb m_left{1.0f};
    float m_from = 0.0f, m_skippedTo = 0.0f;  // in units of the ray's direction
    std::optional<Vec3f> m_behind;            // the last face of glass
    std::int32_t m_lastOfGlass = kNoMedium;
    bool m_hasEntered = false;
};

bool Scene::mayEnter(const RayHit& hit) const {
    const MaterialTraits& traits = m_traits[m_shapes[hit.shape].materialOf(hit.primitive)];
    return traits.isGlass && (traits.letsThrough() || (m_media && m_media->isOfBody(hit)));
}

Rgb Scene::transmittance(const Ray& asked) const {
    const CacheWatch::As as(CacheUser::kShadow);
    Ray ray = asked;
    ray.viewer = kShadowRays;
    if (!m_letsThrough && !m_media) return m_tracer.occluded(ray) ? Rgb{} : Rgb(1.0f);
    Crossings crossings;
    const bool isStopped = m_tracer.stopped(ray, [&](const RayHit& hit) {
        // What is behind a face of glass takes rays of its own, so it is asked afterwards.
        const bool isOfGlass = mayEnter(hit);
        const float share = isOfGlass ? 1.0f : openShare(ray, hit);
        if (share > 0.0f) crossings.add({hit, share, isOfGlass});
        return !(share > 0.0f);
    });
    if (isStopped) return {};
    StraightWay way(*this, ray);
    const RayHit* last = nullptr;
    for (const Crossing& crossing : crossings.sorted()) {
        const bool isOne = last && areOne(ray, *last, crossing.hit);
        if (crossing.isOfGlass) {
            const auto entered = way.enter(crossing.hit, isOne);
            if (entered == StraightWay::Entered::kStopped) return {};
            if (entered == StraightWay::Entered::kNothing) continue;
        } else if (!isOne) {
            way.pass(crossing.share);
        }
        if (!isOne) last = &crossing.hit;
    }
    return way.end();
}

}  // namespace pm
