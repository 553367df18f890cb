// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What a ray covers where it meets a surface: there, of texture coordinates, and by how much the
// normals turn.
#include <algorithm>
#include <cmath>
#include <utility>

#include "integrator/scene/scene.h"
#include "integrator/scene/shape_record.h"
#include "integrator/shapes/ray_footprint.h"

namespace pm {

namespace {

// Of what is curved a step as long as this, in its size, is taken for any longer one.
constexpr float kLongestStep = 0.05f;

// A step in a triangle's plane as shares of its edges.
Vec2f sharesOf(const Vec3f& step, const Vec3d& e1, const Vec3d& e2) {
    const Vec3d s(step), n = cross(e1, e2);
    const double squared = lengthSquared(n);
    if (!(squared > 0.0)) return {};
    return {static_cast<float>(dot(cross(s, e2), n) / squared),
            static_cast<float>(dot(cross(e1, s), n) / squared)};
}

// What a mirror or glass sends on of wide rays may be a picture of its texture.
bool isFiltered(const RayFootprint& footprint, const MaterialTraits& material) {
    return !footprint.isWide || material.isOfSurface;
}

// What a difference of texture coordinates is where a seam may lie between.
float acrossSeam(float difference) {
    return difference - std::nearbyint(difference);
}

}  // namespace

void Scene::footprintOnTriangle(const MaterialTraits& material, const Attributes& attributes,
                                const Corner& corner, Vec2f at, const Arrival& arrival,
                                Surface& surface) const {
    RayFootprint& footprint = *arrival.footprint;
    footprint.arrive(*arrival.ray, surface.position, surface.geometricNormal);
    const Vec2f x = sharesOf(footprint.x.origin, corner.e1, corner.e2),
                y = sharesOf(footprint.y.origin, corner.e1, corner.e2);
    if (attributes.hasNormals && material.hasDelta) {
        const Vec3f n0 = attributes.normals[0], along1 = attributes.normals[1] - n0,
                    along2 = attributes.normals[2] - n0;
        const Vec3f n = n0 + along1 * at.x + along2 * at.y;
        const float size = std::copysign(length(n), dot(n, surface.shadingNormal));
        if (size != 0.0f)
            for (auto [side, share] : {std::pair{&footprint.x, x}, {&footprint.y, y}}) {
                const Vec3f turn = (along1 * share.x + along2 * share.y) / size;
                side->normal = turn - surface.shadingNormal * dot(turn, surface.shadingNormal);
            }
    }
    if (!attributes.hasTexcoords || !isFiltered(footprint, material)) return;
    const Vec2f t0 = attributes.texcoords[0], t1 = attributes.texcoords[1],
                t2 = attributes.texcoords[2];
    const auto onto = [&](const Vec2f& share) -> Vec2f {
        return {(t1.x - t0.x) * share.x + (t2.x - t0.x) * share.y,
                (t1.y - t0.y) * share.x + (t2.y - t0.y) * share.y};
    };
    surface.footprint = {onto(x), onto(y)};
}

void Scene::footprintOnCurved(const ShapeRecord& record, const Arrival& arrival,
                              Surface& surface) const {
    RayFootprint& footprint = *arrival.footprint;
    footprint.arrive(*arrival.ray, surface.position, surface.geometricNormal);
    const auto longest = kLongestStep * static_cast<float>(record.curved->size());
    const bool filters = isFiltered(footprint, m_traits[surface.material]);
    for (auto [side, onto] :
         {std::pair{&footprint.x, &surface.footprint.x}, {&footprint.y, &surface.footprint.y}}) {
        const float step = length(side->origin);
        if (!(step > 0.0f)) continue;
        const float share = std::min(1.0f, longest / step);
        Surface beside;
        record.curved->surfaceNear(Vec3d(surface.position) + Vec3d(side->origin * share), beside);
        side->normal = (beside.shadingNormal - surface.shadingNormal) / share;
        if (filters)
            *onto = {acrossSeam(beside.uv.x - surface.uv.x) / share,
                     acrossSeam(beside.uv.y - surface.uv.y) / share};
    }
}

}  // namespace pm
