// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Scene: what a ray between two points goes through.
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <tuple>
#include <vector>

#include "integrator/materials/opacity.h"
#include "integrator/scene/media.h"
#include "integrator/scene/scene.h"
#include "integrator/scene/shape_record.h"

namespace pm {

namespace {

struct Crossing {
    RayHit hit;
    float share;  // of light that goes straight on
};

// In place of a share: of a face of glass that may be none.
constexpr float kMayBeNone = 2.0f;

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

float Scene::straightShare(const Ray& ray, const RayHit& hit) const {
    const MaterialDescription& material =
        m_materials[m_shapes[hit.shape].materialOf(hit.primitive)];
    if (!letsThrough(material)) return 0.0f;
    Vec2f uv;
    if (material.opacityTexture != kNoTexture) {
        Surface surface;
        surfaceAt(hit, surface, {&ray, nullptr, true});
        uv = surface.uv;
    }
    return 1.0f - opacityAt(m_materials, material, uv);
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

bool Scene::isNone(const Ray& ray, const RayHit& hit) const {
    Surface surface;
    surfaceAt(hit, surface, {&ray, nullptr, true});
    return !m_media->resolve(ray.direction, surface);
}

Rgb Scene::transmittance(const Ray& asked) const {
    const CacheWatch::As as(CacheUser::kShadow);
    Ray ray = asked;
    ray.viewer = kShadowRays;
    if (!m_letsThrough && !m_media) return m_tracer.occluded(ray) ? Rgb{} : Rgb(1.0f);
    Crossings crossings;
    const bool isStopped = m_tracer.stopped(ray, [&](const RayHit& hit) {
        // Whether a face of a body is none is asked afterwards: that takes rays of its own.
        const bool mayBeNone = m_media && m_media->isOfBody(hit);
        const float share = mayBeNone ? kMayBeNone : straightShare(ray, hit);
        if (share > 0.0f) crossings.add({hit, share});
        return !(share > 0.0f);
    });
    if (isStopped) return {};
    float product = 1.0f;
    const RayHit* last = nullptr;
    for (const Crossing& crossing : crossings.sorted()) {
        if (crossing.share == kMayBeNone) {
            if (!isNone(ray, crossing.hit)) return {};
            continue;
        }
        if (last && areOne(ray, *last, crossing.hit)) continue;
        product *= crossing.share;
        last = &crossing.hit;
    }
    if (!m_absorbs || !m_media) return Rgb(product);
    return leftIn(m_media->at(ray.origin), ray.tMax * length(ray.direction)) * product;
}

}  // namespace pm
