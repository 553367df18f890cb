// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Where shapes are, and what of them the scene keeps.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "integrator/geometry/subdivision.h"
#include "integrator/materials/opacity.h"
#include "integrator/scene/limit_shapes.h"
#include "integrator/scene/scene_builder.h"
#include "integrator/shapes/huge_triangles.h"
#include "integrator/shapes/instance_transform.h"
#include "integrator/values/error.h"

namespace pm {

void Scene::Builder::countUses() {
    for (const InstanceDescription& instance : m_scene.m_description.instances)
        if (const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&instance.shape))
            if (!isFlattened(instance)) ++m_uses[mesh->get()];
}

bool Scene::Builder::isFlattened(const InstanceDescription& instance) const {
    return Placement(instance.transform).condition > Placement::kMostCondition ||
           std::ranges::any_of(instance.materials, [&](std::uint32_t material) {
               return m_scene.traits(material).isInvisible;
           });
}

bool Scene::Builder::isInstanced(const InstanceDescription& instance,
                                 const TriangleMesh& mesh) const {
    const auto found = m_uses.find(&mesh);
    return found != m_uses.end() && found->second > 1 &&
           mesh.triangles.size() >= kLeastOfInstanced &&
           found->second * mesh.triangles.size() >= kLeastInstanced && !isFlattened(instance);
}

void Scene::Builder::findHeights() {
    const SceneDescription& d = m_scene.m_description;
    m_scene.m_heights.resize(d.materials.size());
    for (const InstanceDescription& instance : d.instances) {
        const auto* limit = std::get_if<std::shared_ptr<const LimitShape>>(&instance.shape);
        for (const std::uint32_t index : instance.materials) {
            const MaterialDescription& material = m_scene.material(index);
            if (material.displacementTexture == kNoTexture || !d.textures) continue;
            if (!limit || !(*limit)->surface().hasTexcoords()) {
                tellNotDisplaced(instance, material);
                continue;
            }
            auto& heights = m_scene.m_heights[index];
            if (!heights)
                heights = std::make_unique<TextureHeights>(*d.textures, material, m_cancel);
        }
    }
}

void Scene::Builder::tellNotDisplaced(const InstanceDescription& instance,
                                      const MaterialDescription& material) {
    m_scene.m_notices.push_back(
        {NoticeCode::kNotCovered,
         fmt::format("instance '{}' is no limit surface with texture coordinates that is cut on "
                     "demand: the displacement of its material '{}' is left out",
                     instance.name, material.name)});
}

std::vector<const HeightField*> Scene::Builder::heightsOf(const InstanceDescription& instance,
                                                          const LimitShape& shape) const {
    std::vector<const HeightField*> heights;
    if (!shape.surface().hasTexcoords()) return heights;
    for (const std::uint32_t material : instance.materials)
        heights.push_back(m_scene.m_heights[material].get());
    return heights;
}

std::vector<bool> Scene::Builder::slotsCutWhole(const InstanceDescription& instance) const {
    std::vector<bool> slots;
    for (const std::uint32_t material : instance.materials)
        slots.push_back(m_scene.traits(material).emits || m_scene.traits(material).isInvisible);
    if (std::ranges::none_of(slots, [](bool isWhole) { return isWhole; })) slots.clear();
    return slots;
}

bool Scene::Builder::isDisplaced(const InstanceDescription& instance,
                                 const LimitShape& shape) const {
    return std::ranges::any_of(heightsOf(instance, shape), [](const auto* h) { return h; });
}

void Scene::Builder::cutPlain() {
    for (InstanceDescription& instance : m_scene.m_description.instances) {
        const auto* const limit = std::get_if<std::shared_ptr<const LimitShape>>(&instance.shape);
        if (!limit || slotsCutWhole(instance).empty() || isDisplaced(instance, **limit)) continue;
        const int rate = instance.tessellationRate > 0 ? static_cast<int>(instance.tessellationRate)
                                                       : (*limit)->rate();
        instance.shape =
            std::make_shared<const TriangleMesh>(tessellate((*limit)->cage(), rate, m_cancel).mesh);
    }
}

void Scene::Builder::cutDisplaced() {
    for (std::size_t i = m_scene.m_description.instances.size(); i-- > 0;)
        if (!slotsCutWhole(m_scene.m_description.instances[i]).empty()) cutDisplaced(i);
}

void Scene::Builder::cutDisplaced(std::size_t index) {
    InstanceDescription cut = m_scene.m_description.instances[index];
    const auto* const limit = std::get_if<std::shared_ptr<const LimitShape>>(&cut.shape);
    if (!limit) return;
    const std::vector<bool> whole = slotsCutWhole(cut);
    std::vector<bool> others = whole;
    others.flip();
    const auto groups = groupsOf(*limit, cut, others);
    if (groups->groupCount() == 0) return;
    const std::vector<std::uint32_t>& slots = (*limit)->cage().mesh.faceMaterials;
    const bool isAll =
        slots.empty() || std::ranges::all_of(slots, [&](std::uint32_t s) { return whole[s]; });
    auto mesh = std::make_shared<const TriangleMesh>(
        meshOf(*groups, determinant(cut.transform) < 0, m_cancel));
    m_placed.insert(mesh.get());
    cut.cutOf = *limit;
    cut.shape = std::move(mesh);
    const Vec3d& c = m_scene.m_centre;
    cut.transform = {1, 0, 0, c.x, 0, 1, 0, c.y, 0, 0, 1, c.z};
    auto& instances = m_scene.m_description.instances;
    if (isAll)
        instances[index] = std::move(cut);
    else
        instances.push_back(std::move(cut));
}

template <typename Visit>
void Scene::Builder::forEachBox(const Visit& visit) {
    for (const InstanceDescription& instance : m_scene.m_description.instances) {
        const Transform& transform = instance.transform;
        if (const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&instance.shape)) {
            const TriangleMesh& m = **mesh;
            if (isInstanced(instance, m)) {
                visit(boxOf(m, transform));
                continue;
            }
            for (const auto& triangle : m.triangles) {
                goOn();
                Box3d box;
                for (const std::uint32_t v : triangle) {
                    const Vec3d p = transformPoint(transform, Vec3d(m.positions[v]));
                    box.grow({p, p});
                }
                visit(box);
            }
        } else if (const auto* limit =
                       std::get_if<std::shared_ptr<const LimitShape>>(&instance.shape)) {
            double highest = 0.0;
            for (const HeightField* const heights : heightsOf(instance, **limit))
                if (heights)
                    for (const double end : heights->range())
                        highest = std::max(highest, std::abs(end));
            visit(boxAround(**limit, transform, highest));
        } else {
            const bool hasTexture = false;
            visit(CurvedShape(instance.shape, transform, {}, hasTexture, instance.name).bounds());
        }
    }
}

Box3d Scene::Builder::boxOf(const TriangleMesh& mesh, const Transform& transform) {
    Box3d box;
    for (const Vec3f& position : mesh.positions) {
        goOn();
        const Vec3d p = transformPoint(transform, Vec3d(position));
        box.grow({p, p});
    }
    return box;
}

void Scene::Builder::findBounds() {
    Box3d whole;
    forEachBox([&](const Box3d& box) { whole.grow(box); });
    if (whole.empty()) throw Error(Status::kInvalidScene, "the scene has no geometry");
    const double largest = RayTracer::kLargestCoordinate;
    if (!isFinite(whole.lo) || !isFinite(whole.hi) || maxAbsComponent(whole.size()) > largest)
        throw Error(Status::kInvalidScene,
                    fmt::format("the scene is {} units wide; at most {} is allowed",
                                maxAbsComponent(whole.size()), largest));
    std::optional<Vec3d> eye;
    if (const auto& camera = m_scene.m_description.camera)
        eye = Vec3d{camera->cameraToWorld[3], camera->cameraToWorld[7], camera->cameraToWorld[11]};
    const auto core = findCore(
        whole, [&](const auto& visit) { forEachBox(visit); }, eye);
    m_scene.place(whole, core);
}

void Scene::Builder::addShape(const InstanceDescription& instance) {
    ShapeRecord record;
    record.materials = instance.materials;
    record.instanceId = instance.id;
    record.mirrored = determinant(instance.transform) < 0;
    if (const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&instance.shape)) {
        if (isInstanced(instance, **mesh))
            placeMesh(*mesh, instance.transform, record);
        else
            addMesh(*mesh, instance.transform, record);
    } else if (const auto* limit =
                   std::get_if<std::shared_ptr<const LimitShape>>(&instance.shape)) {
        addLimit(*limit, instance, record);
    } else {
        record.curved.emplace(instance.shape, instance.transform, m_scene.m_centre,
                              m_scene.traits(record.materials[0]).looksUpTextures, instance.name);
    }
    m_scene.prepareMaps(record, instance, m_cancel);
    m_scene.m_shapes.push_back(std::move(record));
}

std::unique_ptr<LimitGroups> Scene::Builder::groupsOf(
    const std::shared_ptr<const LimitShape>& shape, const InstanceDescription& instance,
    std::vector<bool> slotsLeftOut) const {
    Transform toScene = instance.transform;
    for (int axis = 0; axis < 3; ++axis)
        toScene[static_cast<std::size_t>(4 * axis + 3)] -= m_scene.m_centre[axis];
    return std::make_unique<LimitGroups>(shape, toScene, heightsOf(instance, *shape),
                                         ruleOf(m_scene.m_description, instance, m_scene.m_centre),
                                         m_cancel, std::move(slotsLeftOut));
}

void Scene::Builder::addLimit(const std::shared_ptr<const LimitShape>& shape,
                              const InstanceDescription& instance, ShapeRecord& record) {
    record.groups = groupsOf(shape, instance, slotsCutWhole(instance));
    m_groupCount += record.groups->groupCount();
    m_scene.m_triangleCount += record.groups->triangleCount();
    m_triangleCountOfGroups += record.groups->triangleCount();
    // As far as a guide to how fine the scene is goes.
    for (std::uint32_t slot = 0; slot < record.materials.size(); ++slot)
        record.groups->forEachCageTriangle(slot, [&](const std::array<Vec3d, 3>& t) {
            goOn();
            m_scene.m_triangleArea += 0.5 * length(cross(t[1] - t[0], t[2] - t[0]));
        });
}

void Scene::Builder::shareGroupCache() {
    if (m_groupCount == 0) return;
    // What a triangle takes in a group, measured over groups of about 1000.
    constexpr std::uint64_t kBytesPerTriangle = 64;
    m_scene.m_groupBytes = m_triangleCountOfGroups * kBytesPerTriangle;
    m_scene.m_groupCache = std::make_unique<GroupCache>(m_groupCount, kUsualGroupBudget);
    std::size_t firstKey = 0;
    for (ShapeRecord& record : m_scene.m_shapes) {
        if (!record.groups) continue;
        record.groups->keepIn(*m_scene.m_groupCache, firstKey);
        firstKey += record.groups->groupCount();
    }
}

void Scene::Builder::placeMesh(const std::shared_ptr<const TriangleMesh>& mesh, Transform transform,
                               ShapeRecord& record) {
    const Box3d box = boxOf(*mesh, transform);
    for (int axis = 0; axis < 3; ++axis)
        transform[static_cast<std::size_t>(4 * axis + 3)] -= m_scene.m_centre[axis];
    record.mesh = mesh;
    record.placement.emplace(transform);
    // Of rays from anywhere in the scene, in whichever place float does least well.
    double& margin = m_margins[mesh.get()];
    margin = std::max(margin, record.placement->errorInObject(2.0 * m_scene.m_radius));
    const double farthest = std::max(maxAbsComponent(box.lo - m_scene.m_centre),
                                     maxAbsComponent(box.hi - m_scene.m_centre));
    // As surfaceOffset takes it.
    record.reachOfPlacement =
        static_cast<float>(record.placement->error(farthest) / (16 * 0x1p-24));
    // Of all places alike, as far as a guide to how fine the scene is goes.
    const double scale = std::cbrt(std::abs(determinant(transform)));
    double& area = m_areas[mesh.get()];
    if (area == 0.0)
        for (const auto& t : mesh->triangles) {
            goOn();
            const Vec3d v0(mesh->positions[t[0]]);
            area += 0.5 * length(cross(Vec3d(mesh->positions[t[1]]) - v0,
                                       Vec3d(mesh->positions[t[2]]) - v0));
        }
    m_scene.m_triangleArea += area * scale * scale;
    m_scene.m_triangleCount += mesh->triangles.size();
    m_scene.m_hasInstances = true;
}

std::shared_ptr<const SharedMesh> Scene::Builder::sharedMesh(const ShapeRecord& record) const {
    const TriangleMesh& mesh = *record.mesh;
    const double needed = m_margins.at(&mesh);
    const std::string& isa = m_scene.m_tracer.isa();
    return mesh.rayTracing.get<SharedMesh>(
        [&](const SharedMesh& kept) { return kept.isa() == isa && kept.margin() >= needed; },
        [&] {
            constexpr double kToSpare = 16.0;  // for scenes to come, larger ones
            return std::make_shared<const SharedMesh>(isa, mesh.positions, mesh.triangles,
                                                      kToSpare * needed, m_cancel);
        });
}

void Scene::Builder::addMesh(const std::shared_ptr<const TriangleMesh>& mesh,
                             const Transform& transform, ShapeRecord& record) {
    record.mesh = mesh;
    const bool isPlaced = m_placed.contains(mesh.get());
    record.positions.reserve(mesh->positions.size() + 1);
    for (const Vec3f& p : mesh->positions) {
        goOn();
        record.positions.push_back(
            isPlaced ? p : Vec3f(transformPoint(transform, Vec3d(p)) - m_scene.m_centre));
    }
    record.positions.emplace_back();
    record.facets.reserve(mesh->triangles.size());
    for (std::uint32_t i = 0; i < mesh->triangles.size(); ++i) {
        goOn();
        record.facets.emplace_back(record.corner(i), record.mirrored);
        m_scene.m_triangleArea += triangleArea(record, i);
    }
    const NormalTransform normalTransform(transform);
    record.normals.reserve(mesh->normals.size());
    for (const Vec3f& n : mesh->normals) {
        goOn();
        record.normals.push_back(normalTransform.apply(n));
    }
    m_scene.m_triangleCount += mesh->triangles.size();
}

template <typename Visit>
void Scene::Builder::forEachSize(const Visit& visit) {
    for (ShapeRecord& record : m_scene.m_shapes) {
        if (record.groups) {
            for (std::uint32_t i = 0; i < record.groups->groupCount(); ++i)
                visit(record, record.groups->firstTriangle(i),
                      length(record.groups->box(i).size()) /
                          std::sqrt(record.groups->trianglesOf(i)));
            continue;
        }
        if (!record.mesh) {
            visit(record, 0u, record.curved->size());
            continue;
        }
        if (record.placement) continue;
        for (std::uint32_t i = 0; i < record.mesh->triangles.size(); ++i) {
            goOn();
            const Corner c = record.corner(i);
            visit(record, i,
                  std::sqrt(std::max(
                      {lengthSquared(c.e1), lengthSquared(c.e2), lengthSquared(c.e2 - c.e1)})));
        }
    }
}

void Scene::Builder::findHuge() {
    HugeTriangles huge;
    forEachSize([&](const ShapeRecord&, std::uint32_t, double size) { huge.addSize(size); });
    forEachSize([&](const ShapeRecord& record, std::uint32_t i, double size) {
        Vec3d lo, hi;
        record.bounds(i, lo, hi);
        huge.addBox(size, lo, hi);
    });
    const double most = huge.mostNotHuge();
    if (!std::isfinite(most)) return;
    for (std::size_t shape = 0; shape < m_scene.m_shapes.size(); ++shape) {
        ShapeRecord& record = m_scene.m_shapes[shape];
        const Transform& transform = m_scene.m_description.instances[shape].transform;
        for (std::uint32_t i = 0; i < record.facets.size(); ++i) {
            goOn();
            if (!(static_cast<double>(record.facets[i].reach) > most)) continue;
            ExactTriangle exact{i, {}};
            for (std::size_t k = 0; k < 3; ++k)
                exact.corners[k] =
                    transformPoint(transform,
                                   Vec3d(record.mesh->positions[record.mesh->triangles[i][k]])) -
                    m_scene.m_centre;
            record.exact.push_back(exact);
            record.facets[i] = Facet(record.corner(i), record.mirrored, true);
        }
    }
}

}  // namespace pm
