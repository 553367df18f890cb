// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/scene/scene_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "integrator/materials/layers.h"
#include "integrator/materials/opacity.h"
#include "integrator/scene/coincident_faces.h"
#include "integrator/scene/limit_shapes.h"
#include "integrator/scene/media.h"
#include "integrator/shapes/close_spheres.h"
#include "integrator/shapes/instance_transform.h"
#include "integrator/values/error.h"

namespace pm {

void Scene::Builder::run() {
    completeMixtures(m_scene.m_description.materials);
    m_scene.m_traits = traitsOf(m_scene.m_description.materials, m_scene.m_materials.roles);
    checkInstances();
    findHeights();
    cutPlain();
    findBounds();
    cutDisplaced();
    countUses();
    for (const InstanceDescription& instance : m_scene.m_description.instances) addShape(instance);
    shareGroupCache();
    findHuge();
    m_scene.m_isFlat = m_scene.findFlat(m_cancel);
    m_scene.m_hasSheets = findSheets();
    m_scene.m_viewersDiffer = findViewers();
    const std::vector<MaterialTraits>& traits = m_scene.m_traits;
    m_scene.m_letsThrough = std::ranges::any_of(traits, &MaterialTraits::letsThrough);
    m_scene.m_filtersTextures = std::ranges::any_of(traits, &MaterialTraits::filtersTextures);
    m_scene.m_absorbs = std::ranges::any_of(traits, &MaterialTraits::absorbs);
    m_scene.m_hasThinWalls = std::ranges::any_of(traits, &MaterialTraits::isThinWalled);
    noteHiddenSheen();
    noteLostAnisotropy();
    addToTracer();
    for (std::uint32_t i = 0; i < m_scene.m_shapes.size(); ++i) findLights(i);
    m_scene.lookAtTextures(m_cancel);
    m_scene.m_media = Media::find(m_scene, m_scene.m_notices, m_cancel);
    m_scene.m_tables =
        makeMaterialTables(m_scene.m_description.materials, m_scene.m_media != nullptr, m_cancel);
    m_scene.m_coincident = CoincidentFaces::find(m_scene, m_scene.m_notices, m_cancel);
    lookForCloseSpheres();
    const SceneDescription& d = m_scene.m_description;
    const SceneBox box{m_scene.m_centre, m_scene.m_halfSize};
    addLights(d.lights, false, box, m_scene.m_lights);
    m_scene.m_nearLightCount = m_scene.m_lights.size();
    addLights(d.lights, true, box, m_scene.m_lights);
    addEnvironment(box);
    addLightTriangles();
    if (m_scene.m_lights.empty())
        m_scene.m_notices.push_back(
            {NoticeCode::kNoLight, "nothing in the scene emits light: the picture is black"});
}

void Scene::Builder::noteHiddenSheen() {
    for (const MaterialDescription& material : m_scene.m_description.materials)
        if (hasCoat(material) && !isBlack(material.sheen))
            m_scene.m_notices.push_back(
                {NoticeCode::kNotCovered,
                 fmt::format("material '{}' has a coat, so its sheen is left out", material.name)});
}

// Once a material, of however many instances.
void Scene::Builder::noteLostAnisotropy() {
    std::set<std::uint32_t> told;
    for (const ShapeRecord& record : m_scene.m_shapes) {
        // Only what has texture coordinates has tangents.
        if (record.hasMaps) continue;
        for (const std::uint32_t index : record.materials) {
            const MaterialDescription& material = m_scene.m_description.materials[index];
            if (m_scene.traits(index).isStretched && told.insert(index).second)
                m_scene.m_notices.push_back(
                    {NoticeCode::kNotCovered,
                     fmt::format("material '{}' is anisotropic along texture coordinates, which "
                                 "some shape of it has not: that one shines alike all around",
                                 material.name)});
        }
    }
}

void Scene::Builder::checkInstances() const {
    const SceneDescription& d = m_scene.m_description;
    if (d.instances.empty()) throw Error(Status::kInvalidScene, "the scene has no geometry");
    for (const InstanceDescription& instance : d.instances) {
        for (const double v : instance.transform)
            if (!std::isfinite(v))
                throw Error(
                    Status::kInvalidScene,
                    fmt::format("instance '{}': its transform has a value that is not finite",
                                instance.name));
        if (determinant(instance.transform) == 0.0)
            throw Error(Status::kInvalidScene,
                        fmt::format("instance '{}': its transform is singular", instance.name));
        for (const std::uint32_t material : instance.materials)
            if (material >= d.materials.size())
                throw Error(Status::kInvalidScene,
                            fmt::format("instance '{}' refers to material {} of {}", instance.name,
                                        material, d.materials.size()));
        checkSlots(instance);
    }
}

void Scene::Builder::checkSlots(const InstanceDescription& instance) {
    std::uint32_t slots = 1;
    if (const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&instance.shape)) {
        for (const std::uint32_t slot : (*mesh)->materials) slots = std::max(slots, slot + 1);
    }
    if (const auto* limit = std::get_if<std::shared_ptr<const LimitShape>>(&instance.shape))
        for (const std::uint32_t slot : (*limit)->cage().mesh.faceMaterials)
            slots = std::max(slots, slot + 1);
    if (instance.materials.size() < slots)
        throw Error(Status::kInvalidScene,
                    fmt::format("instance '{}' has {} materials; its mesh uses {} slots",
                                instance.name, instance.materials.size(), slots));
}

FaceKind Scene::Builder::kindOf(const ShapeRecord& record, std::uint32_t primitive) const {
    const MaterialTraits& traits = m_scene.traits(record.materialOf(primitive));
    if (traits.isInvisible) return FaceKind::kInvisible;
    if (traits.emits) return record.mirrored ? FaceKind::kShiningMirrored : FaceKind::kShining;
    if (traits.isGlass) return FaceKind::kGlass;
    return traits.isSheet() ? FaceKind::kSheet : FaceKind::kOpaque;
}

void Scene::Builder::leaveOutCopies() {
    const auto forEachFace = [&](const VisitFace& visit) {
        for (std::uint32_t shape = 0; shape < m_scene.m_shapes.size(); ++shape) {
            const ShapeRecord& record = m_scene.m_shapes[shape];
            if (!record.mesh || record.placement) continue;
            for (std::uint32_t i = 0; i < record.mesh->triangles.size(); ++i) {
                goOn();
                const auto& t = record.mesh->triangles[i];
                visit({{record.positions[t[0]], record.positions[t[1]], record.positions[t[2]]},
                       kindOf(record, i),
                       shape,
                       i});
            }
        }
    };
    const auto needless =
        findNeedlessCopies(m_scene.m_triangleCount - m_triangleCountOfGroups, forEachFace);
    if (needless.empty()) return;
    for (const PlacedFace& face : needless) m_scene.m_shapes[face.shape].leaveOut(face.primitive);
    for (ShapeRecord& record : m_scene.m_shapes)
        if (record.mesh && !record.visible.empty()) record.leaveOutExact();
    m_scene.m_notices.push_back(
        {NoticeCode::kDegenerateGeometry,
         fmt::format("{} triangles are copies of others in the same place, more than {} of "
                     "each: only the first of each is seen",
                     needless.size(), kMostCopies)});
}

void Scene::Builder::addToTracer() {
    for (ShapeRecord& record : m_scene.m_shapes) record.leaveOutInvisible(m_scene);
    leaveOutCopies();
    for (std::uint32_t shape = 0; shape < m_scene.m_shapes.size(); ++shape) {
        const ShapeRecord& record = m_scene.m_shapes[shape];
        if (record.groups) {
            m_scene.m_tracer.addGroups(*record.groups, seenBy(shape));
            continue;
        }
        if (!record.mesh && record.visible.empty()) {
            m_scene.m_tracer.addCurved(*record.curved, seenBy(shape));
            continue;
        }
        if (record.placement) {
            m_scene.m_tracer.addInstance(sharedMesh(record), record.placement->toScene,
                                         seenBy(shape));
            continue;
        }
        const std::vector<TriangleMesh::Corners>& triangles =
            record.visible.empty() ? record.mesh->triangles : record.visible;
        m_scene.m_tracer.addTriangles({record.positions.data(), record.positions.size() - 1},
                                      {triangles.data(), triangles.size()}, record.exact,
                                      seenBy(shape));
    }
    m_cancel.throwIfSet("building the scene");
    m_scene.m_tracer.commit(m_cancel);
}

void Scene::Builder::lookForCloseSpheres() {
    std::vector<GlassSphere> spheres;
    for (const ShapeRecord& record : m_scene.m_shapes)
        if (record.curved && record.curved->sphere() && m_scene.traits(record.materials[0]).isGlass)
            spheres.push_back({record.curved->sphere()->sphere().centre,
                               record.curved->sphere()->sphere().radius});
    if (const std::size_t count = countCloseSpheres(std::move(spheres)); count > 0)
        m_scene.m_notices.push_back(
            {NoticeCode::kDegenerateGeometry,
             fmt::format("{} spheres of glass lie in others, closer to their surface than rays "
                         "can tell: light through both is lost; leave a gap of a millionth of "
                         "the radius",
                         count)});
}

bool Scene::Builder::findViewers() const {
    return std::ranges::any_of(
        m_scene.m_description.instances, [&](const InstanceDescription& instance) {
            const bool shadow = (instance.hiddenFrom & kShadowRays) != 0,
                       reflection = (instance.hiddenFrom & kReflectionRays) != 0;
            const auto shines = [&](std::uint32_t m) { return m_scene.traits(m).emits; };
            return shadow != reflection ||
                   (reflection && std::ranges::any_of(instance.materials, shines));
        });
}

Viewers Scene::Builder::seenBy(std::uint32_t shape) const {
    const InstanceDescription& instance = m_scene.m_description.instances[shape];
    const auto shines = [&](std::uint32_t m) { return m_scene.traits(m).emits; };
    Viewers seen = kCameraRays | kShadowRays | kReflectionRays;
    seen &= ~instance.hiddenFrom;
    if ((seen & kShadowRays) != 0 || std::ranges::any_of(instance.materials, shines))
        seen |= kLightRays;
    return seen;
}

bool Scene::Builder::findSheets() const {
    const auto isOne = [&](std::uint32_t material) { return m_scene.traits(material).isSheet(); };
    return std::ranges::any_of(m_scene.m_shapes, [&](const ShapeRecord& record) {
        return std::ranges::any_of(record.materials, isOne);
    });
}

Scene::Scene(SceneDescription description, const std::string& isa, const CancelCheck& cancel)
    : m_description(std::move(description)), m_tracer(isa) {
    Builder(*this, cancel).run();
}

std::shared_ptr<const Scene> Scene::build(SceneDescription description, const std::string& isa,
                                          const CancelCheck& cancel) {
    return std::shared_ptr<const Scene>(new Scene(std::move(description), isa, cancel));
}

}  // namespace pm
