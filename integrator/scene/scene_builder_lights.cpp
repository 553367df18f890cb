// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <fmt/format.h>

#include <algorithm>

#include "integrator/scene/scene_builder.h"
#include "integrator/values/error.h"

namespace pm {

void Scene::Builder::findLights(std::uint32_t shape) {
    ShapeRecord& record = m_scene.m_shapes[shape];
    if (record.groups) return;  // what of them shines is a mesh
    if (std::ranges::none_of(record.materials, [&](std::uint32_t material) {
            return m_scene.traits(material).emits;
        }))
        return;
    if (record.curved && !record.curved->sphere())
        throw Error(Status::kUnsupported,
                    fmt::format("instance '{}' has a material that emits; meshes and spheres "
                                "may shine",
                                m_scene.m_description.instances[shape].name));
    const std::size_t primitives = record.mesh ? record.mesh->triangles.size() : 1;
    for (std::uint32_t i = 0; i < primitives; ++i) {
        goOn();
        const std::uint32_t material = record.materialOf(i);
        if (!m_scene.traits(material).emits) continue;
        const double area = record.mesh ? triangleArea(record, i) : record.curved->area();
        if (!(area > 0)) continue;
        if (record.lightOfPrimitive.empty()) record.lightOfPrimitive.assign(primitives, kNoLight);
        record.lightOfPrimitive[i] = static_cast<std::int32_t>(m_scene.m_lights.size());
        const SurfaceLight light{shape, i, material, -1, static_cast<float>(area)};
        const Rgb e = m_scene.mostEmission(material);
        const double power = kPiDouble * area * channelSum(e) / 3;
        if (record.mesh)
            m_scene.m_lights.emplace_back(TriangleLight{light}, power);
        else
            m_scene.m_lights.emplace_back(SphereLight{light}, power);
    }
}

void Scene::Builder::addEnvironment(const SceneBox& box) {
    const auto& description = m_scene.m_description.environment;
    if (!description || isBlack(description->radiance)) return;
    const bool hasBadTexels =
        description->texture != kNoTexture && m_scene.findBadTexels(description->texture, m_cancel);
    auto environment = std::make_unique<const Environment>(
        *description, m_scene.m_description.textures.get(), m_cancel, hasBadTexels);
    if (!(environment->integral() > 0)) return;
    m_scene.m_environment = std::move(environment);
    const EnvironmentLight light{m_scene.m_environment.get()};
    m_scene.m_lights.emplace_back(light, light.powerMean(box));
}

void Scene::Builder::addLightTriangles() {
    m_scene.m_lampTriangles.resize(m_scene.m_lights.size());
    for (std::size_t i = 0; i < m_scene.m_lights.size(); ++i) {
        goOn();
        const SurfaceLight* const shining = m_scene.m_lights[i].surface();
        if (!shining || m_scene.traits(shining->material).shinesUnevenly) continue;
        const SurfaceLight& light = *shining;
        const ShapeRecord& record = m_scene.m_shapes[light.shape];
        if (!record.mesh || record.exactOf(light.primitive)) continue;
        LampTriangle& lamp = m_scene.m_lampTriangles[i];
        for (std::size_t k = 0; k < 3; ++k)
            lamp.vertices[k] = Vec3f(record.vertex(record.mesh->triangles[light.primitive][k]));
        const Facet facet = record.facet(light.primitive);
        lamp.normal = facet.normal;
        lamp.reach = facet.reach;
        lamp.area = light.area;
        lamp.material = light.material;
    }
}

double Scene::Builder::triangleArea(const ShapeRecord& record, std::uint32_t primitive) {
    const auto& t = record.mesh->triangles[primitive];
    const Vec3d v0 = record.vertex(t[0]);
    return 0.5 * length(cross(record.vertex(t[1]) - v0, record.vertex(t[2]) - v0));
}

}  // namespace pm
