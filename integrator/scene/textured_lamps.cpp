// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Scene: lamps whose radiance comes from a texture, and points on them.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "integrator/materials/opacity.h"
#include "integrator/sampling/pinned_math.h"
#include "integrator/sampling/warps.h"
#include "integrator/scene/scene.h"
#include "integrator/scene/scene_builder.h"
#include "integrator/scene/shape_record.h"

namespace pm {

namespace {

// Looks at all lamps of a scene together, where that is enough for one at each.
constexpr std::size_t kMostLooks = 1 << 24;
// A lamp that shows nothing has this share of the power that its whole texture would give it at 1:
// something may have been overlooked.
constexpr double kLeastPower = 1e-6;
// Sines of a sphere's latitude-longitude picture at its poles.
constexpr float kLeastSine = 1e-4f;

bool shinesByTexture(const Scene& scene, const Light& light) {
    return light.surface() && scene.traits(light.surface()->material).shinesUnevenly;
}

// Of the circle on which a picture's row lies, the sphere's radius being 1.
float sineOfRow(float v) {
    return std::max(kLeastSine, std::abs(sinCosTurns(0.5f * v).sin));
}

}  // namespace

Rgb Scene::emission(std::uint32_t index, Vec2f uv, const UvFootprint& footprint) const {
    const MaterialDescription& material = this->material(index);
    // What is cut away doesn't shine.
    const float share = ownOpacityAt(materials(), material, {uv});
    Rgb ofParts;
    if (material.kind == MaterialKind::kMixture && m_traits[index].emits) {
        const float second = weightAt(materials(), material, {uv});
        ofParts = (emission(material.first, uv, footprint) * (1.0f - second) +
                   emission(material.second, uv, footprint) * second) *
                  share;
        if (isBlack(material.emission)) return ofParts;
    }
    if (material.emissionTexture == kNoTexture) return ofParts + material.emission * share;
    const auto texture = static_cast<std::size_t>(material.emissionTexture);
    const bool isBad = texture < m_hasBadTexels.size() && m_hasBadTexels[texture];
    const Texel t =
        asLight(isBad ? textures()->lookUpOfLight(material.emissionTexture, uv)
                      : textures()->lookUp(material.emissionTexture, {uv, {}, footprint}));
    return ofParts + material.emission * Rgb(t.r, t.g, t.b) * share;
}

bool Scene::findBadTexels(std::int32_t texture, const CancelCheck& cancel) {
    const auto index = static_cast<std::size_t>(texture);
    if (index < m_hasBadTexels.size() && m_hasBadTexels[index]) return true;
    const BadTexels bad = textures()->badTexels(texture, cancel);
    if (!bad.any()) return false;
    m_hasBadTexels.resize(std::max(m_hasBadTexels.size(), index + 1));
    m_hasBadTexels[index] = true;
    std::string whose = "the environment";
    for (const MaterialDescription& one : m_description.materials)
        if (one.emissionTexture == texture) whose = fmt::format("material '{}'", one.name);
    m_notices.push_back(
        {NoticeCode::kTexture,
         fmt::format("the light of {} has {} texels below 0 and {} that are infinite or not "
                     "numbers; they count as 0 ({})",
                     whose, bad.negative, bad.notFinite, textures()->name(texture))});
    return true;
}

std::vector<std::int32_t> Scene::texturesOfEmission(std::uint32_t index) const {
    const MaterialDescription& shining = material(index);
    std::vector<std::int32_t> textures;
    for (const std::int32_t texture :
         {shining.emissionTexture, shining.opacityTexture, shining.weightTexture})
        if (texture != kNoTexture) textures.push_back(texture);
    if (shining.kind == MaterialKind::kMixture)
        for (const std::uint32_t part : {shining.first, shining.second})
            std::ranges::copy(texturesOfEmission(part), std::back_inserter(textures));
    return textures;
}

bool Scene::isOfEmission(std::int32_t texture) const {
    return std::ranges::any_of(m_description.materials, [&](const MaterialDescription& m) {
        return m.emissionTexture == texture;
    });
}

Rgb Scene::mostEmission(std::uint32_t index) const {
    const MaterialDescription& m = material(index);
    if (m.kind != MaterialKind::kMixture) return m.emission;
    return m.emission + mostEmission(m.first) + mostEmission(m.second);
}

bool Scene::isKnownBlack(std::uint32_t index, std::span<const Vec2f> uv) const {
    const MaterialDescription& shining = material(index);
    if (shining.kind == MaterialKind::kMixture || shining.emissionTexture == kNoTexture)
        return false;
    const auto texture = static_cast<std::size_t>(shining.emissionTexture);
    if (texture < m_hasBadTexels.size() && m_hasBadTexels[texture]) return false;
    Vec2f lo = uv[0], hi = uv[0];
    for (const Vec2f& at : uv) {
        lo = {std::min(lo.x, at.x), std::min(lo.y, at.y)};
        hi = {std::max(hi.x, at.x), std::max(hi.y, at.y)};
    }
    return textures()->isBlackWithin(shining.emissionTexture, lo, hi);
}

LampTexture Scene::lookAtLamp(const SurfaceLight& light, std::size_t mostLooks,
                              const CancelCheck& cancel) const {
    const ShapeRecord& record = m_shapes[light.shape];
    std::uint32_t across = 1, down = 1;
    for (const std::int32_t texture : texturesOfEmission(light.material)) {
        const auto [columns, rows] = textures()->texels(texture);
        across = std::max(across, columns);
        down = std::max(down, rows);
    }
    LampTexture::Lamp lamp;
    lamp.mostLooks = mostLooks;
    if (!record.mesh) {
        lamp.domain = LampTexture::Domain::kSquare;
        lamp.texels = std::max(across, down);
        lamp.look = [&, this](Vec2f uv, float) {
            return LampTexture::Look{
                channelMean(emission(light.material, uv)),
                0.5 * std::numbers::pi * static_cast<double>(sinCosTurns(0.5f * uv.y).sin)};
        };
        return LampTexture(lamp, cancel);
    }
    std::array<Vec2f, 3> uv{};
    record.texcoords(light.primitive, uv);
    if (isKnownBlack(light.material, uv)) return LampTexture();
    const Vec2f e1 = uv[1] - uv[0], e2 = uv[2] - uv[0];
    for (const Vec2f& edge : {e1, e2, e2 - e1})
        lamp.texels = std::max({lamp.texels, std::abs(static_cast<double>(edge.x)) * across,
                                std::abs(static_cast<double>(edge.y)) * down});
    lamp.look = [&, this](Vec2f b, float step) {
        return LampTexture::Look{channelMean(
            emission(light.material, uv[0] + e1 * b.x + e2 * b.y, {e1 * step, e2 * step}))};
    };
    return LampTexture(lamp, cancel);
}

void Scene::lookAtTextures(const CancelCheck& cancel) {
    std::vector<Light*> lights;
    for (Light& light : m_lights)
        if (shinesByTexture(*this, light)) lights.push_back(&light);
    if (lights.empty()) return;
    std::set<std::int32_t> textures;
    for (const Light& light : m_lights)
        if (light.surface())
            for (const std::int32_t texture : texturesOfEmission(light.surface()->material))
                if (isOfEmission(texture)) textures.insert(texture);
    for (const std::int32_t texture : textures) findBadTexels(texture, cancel);
    const std::size_t mostLooks = std::max<std::size_t>(1, kMostLooks / lights.size());
    std::vector<LampTexture> seen(lights.size());
    tbb::parallel_for(std::size_t{0}, lights.size(), [&](std::size_t i) {
        seen[i] = lookAtLamp(*lights[i]->surface(), mostLooks, cancel);
    });
    for (std::size_t i = 0; i < lights.size(); ++i) {
        SurfaceLight& shining = *lights[i]->surface();
        const double whole = channelMean(mostEmission(shining.material));
        lights[i]->powerMean = std::numbers::pi * static_cast<double>(shining.area) *
                               std::max(seen[i].mean(), kLeastPower * whole);
        if (seen[i].isEven()) continue;
        shining.texture = static_cast<std::int32_t>(m_lampTextures.size());
        m_lampTextures.push_back(std::move(seen[i]));
    }
}

Surface Scene::pointOnLight(const SurfaceLight& light, Vec2f u, float& density) const {
    density = 1.0f;
    const LampTexture* const texture = lampTexture(light);
    if (!texture) return pointOnLight(light, u);
    const ShapeRecord& record = m_shapes[light.shape];
    const Vec2f at = texture->sample(u, density);
    Surface surface;
    surface.shape = light.shape;
    if (record.mesh) {
        surfaceOnTriangle(record, light.primitive, record.corner(light.primitive),
                          static_cast<double>(at.x), static_cast<double>(at.y), surface);
        return surface;
    }
    const PlacedSphere& sphere = *record.curved->sphere();
    sphere.surfaceAlong(sphere.directionOf(at), surface);
    nameSurface(record, 0, surface);
    density *= 2.0f * kInvPi / sineOfRow(surface.uv.y);
    return surface;
}

float Scene::lampDensity(const SurfaceLight& light, const Surface& point) const {
    const LampTexture* const texture = lampTexture(light);
    if (!texture) return 1.0f;
    const ShapeRecord& record = m_shapes[light.shape];
    if (!record.mesh) return texture->density(point.uv) * (2.0f * kInvPi / sineOfRow(point.uv.y));
    // The barycentric coordinates of the point that is nearest to it on the plane.
    const auto [vertex, e1, e2] = record.corner(light.primitive);
    const Vec3d normal = cross(e1, e2), way = Vec3d(point.position) - vertex;
    const double squared = lengthSquared(normal);
    return texture->density({static_cast<float>(dot(cross(way, e2), normal) / squared),
                             static_cast<float>(dot(cross(e1, way), normal) / squared)});
}

}  // namespace pm
