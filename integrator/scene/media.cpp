// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/scene/media.h"

#include <algorithm>
#include <array>
#include <span>

#include "integrator/materials/material_description.h"
#include "integrator/scene/shape_record.h"

namespace pm {

namespace {

// Any direction serves; along none of the axes, so that it meets few edges.
constexpr Vec3f kOutwards{0.433612f, 0.286747f, 0.854239f};

// How often each body was left, less how often it was entered.
class Balance {
  public:
    void add(std::uint32_t body, int by) {
        const std::span<Entry> known(m_few.data(), m_count);
        const auto found = std::ranges::find(known, body, &Entry::body);
        if (found != known.end()) {
            found->times += by;
            return;
        }
        const auto more = std::ranges::find(m_many, body, &Entry::body);
        if (more != m_many.end())
            more->times += by;
        else if (m_count < m_few.size())
            m_few[m_count++] = {body, by};
        else
            m_many.push_back({body, by});
    }
    template <typename Visit>
    void forEachInside(const Visit& visit) const {
        for (std::size_t i = 0; i < m_count; ++i)
            if (m_few[i].times > 0) visit(m_few[i].body);
        for (const Entry& entry : m_many)
            if (entry.times > 0) visit(entry.body);
    }

  private:
    struct Entry {
        std::uint32_t body;
        int times;
    };
    std::array<Entry, 16> m_few{};
    std::size_t m_count = 0;
    std::vector<Entry> m_many;
};

}  // namespace

double Scene::Media::Body::size() const {
    const Vec3d s = box.size();
    return s.x * s.y * s.z;
}

float Scene::Media::Body::gap() const {
    return static_cast<float>(kGap * length(box.size()));
}

bool Scene::Media::Body::holds(const Body& other) const {
    const auto gap = static_cast<double>(other.gap());
    for (int axis = 0; axis < 3; ++axis)
        if (!(box.lo[axis] <= other.box.lo[axis] + gap && other.box.hi[axis] <= box.hi[axis] + gap))
            return false;
    return true;
}

const Scene::Media::Body* Scene::Media::bodyOf(const RayHit& hit) const {
    const std::vector<std::uint32_t>& bodies = m_ofShape[hit.shape];
    if (bodies.empty()) return nullptr;
    const std::uint32_t material = m_scene.m_shapes[hit.shape].materialOf(hit.primitive);
    for (const std::uint32_t body : bodies)
        if (m_bodies[body].material == material) return &m_bodies[body];
    return nullptr;
}

bool Scene::Media::isBefore(const Body& a, const Body& b) const {
    if (a.priority != b.priority) return a.priority > b.priority;
    if (a.size() != b.size()) return a.size() < b.size();
    return &a > &b;
}

const Scene::Media::Body* Scene::Media::bodyAt(const Vec3f& position) const {
    float end = -1.0f;
    for (const Body& body : m_bodies)
        if (body.mayHold(position))
            end = std::max(end, std::min({(body.hi.x - position.x) / kOutwards.x,
                                          (body.hi.y - position.y) / kOutwards.y,
                                          (body.hi.z - position.z) / kOutwards.z}));
    if (end < 0.0f) return nullptr;
    // All faces of a body are in its box.
    Ray ray{position, kOutwards, end};
    ray.viewer = kAllRays;
    Balance balance;
    m_scene.m_tracer.stopped(ray, [&](const RayHit& hit) {
        const Body* const body = bodyOf(hit);
        if (!body) return false;
        const bool isLeft = dot(frontAt(hit, ray), ray.direction) > 0.0f;
        balance.add(static_cast<std::uint32_t>(body - m_bodies.data()), isLeft ? 1 : -1);
        return false;
    });
    const Body* best = nullptr;
    balance.forEachInside([&](std::uint32_t index) {
        const Body& body = m_bodies[index];
        if (!best || isBefore(body, *best)) best = &body;
    });
    return best;
}

Vec3f Scene::Media::frontAt(const RayHit& hit, const Ray& ray) const {
    const ShapeRecord& record = m_scene.m_shapes[hit.shape];
    if (!record.curved) return record.facet(hit.primitive, record.corner(hit.primitive)).normal;
    Surface surface;
    m_scene.surfaceAt(hit, surface, {&ray, nullptr, true});
    return surface.geometricNormal;
}

bool Scene::Media::isAlone(const Body& body, const Vec3f& position) const {
    return body.isConvex && std::ranges::none_of(m_bodies, [&](const Body& other) {
               return &other != &body && other.mayHold(position);
           });
}

std::int32_t Scene::Media::mediumOf(const Body* body) const {
    return body ? static_cast<std::int32_t>(body->material) : kNoMedium;
}

std::int32_t Scene::Media::at(const Vec3f& position) const {
    return mediumOf(bodyAt(position));
}

const Scene::Media::Body* Scene::Media::beyond(const Body& body, const Vec3f& towards,
                                               Surface& surface) const {
    const Body* const found = bodyAt(surface.position + towards * surface.offset);
    if (found || m_bodies.size() < 2) return found;
    for (const Body& other : m_bodies) {
        if (&other == &body || !(other.holds(body) || body.holds(other))) continue;
        const float gap = std::min(body.gap(), other.gap());
        const Vec3f place = surface.position + towards * gap;
        if (!(gap > surface.offset) || !other.mayHold(place) || bodyAt(place) != &other) continue;
        surface.offset = gap;
        return &other;
    }
    return nullptr;
}

float Scene::Media::ior(std::int32_t medium) const {
    return medium == kNoMedium ? 1.0f : m_scene.material(static_cast<std::uint32_t>(medium)).ior;
}

bool Scene::Media::resolve(const Vec3f& direction, Surface& surface) const {
    const bool isFront = dot(direction, surface.geometricNormal) < 0.0f;
    const Vec3f off = surface.geometricNormal * (isFront ? surface.offset : -surface.offset);
    const bool isFace = !surface.isPane && m_scene.traits(surface.material).fillsItsInside;
    const Body* const body = isFace ? bodyOf({surface.shape, surface.primitive}) : nullptr;
    if (body && isAlone(*body, surface.position)) {
        const std::int32_t own = mediumOf(body);
        surface.medium = isFront ? kNoMedium : own;
        surface.eta = isFront ? ior(own) : 1.0f / ior(own);
        return true;
    }
    surface.medium = at(surface.position + off);
    if (!isFace) return true;
    const Vec3f towards = isFront ? -surface.geometricNormal : surface.geometricNormal;
    std::int32_t there;
    if (body) {
        there = mediumOf(beyond(*body, towards, surface));
        if (surface.medium == there) return false;
    } else {
        // An open face: behind it is its own.
        there = at(surface.position - off);
        (isFront ? there : surface.medium) = static_cast<std::int32_t>(surface.material);
    }
    surface.eta = ior(there) / ior(surface.medium);
    return true;
}

std::uint64_t Scene::Media::memoryBytes() const {
    return m_bodies.size() * sizeof(Body) + m_ofShape.size() * sizeof(m_ofShape[0]);
}

}  // namespace pm
