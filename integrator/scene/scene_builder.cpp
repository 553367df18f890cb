// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Builds a Scene: checks the description, moves everything to the scene's own centre in double,
// then rounds to float once; finds the lights; hands the shapes to the ray tracer.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_map>

#include "integrator/materials/opacity.h"
#include "integrator/scene/coincident_faces.h"
#include "integrator/scene/limit_shapes.h"
#include "integrator/scene/media.h"
#include "integrator/scene/scene.h"
#include "integrator/scene/scene_core.h"
#include "integrator/scene/shape_record.h"
#include "integrator/shapes/close_spheres.h"
#include "integrator/shapes/copied_faces.h"
#include "integrator/shapes/huge_triangles.h"
#include "integrator/shapes/instance_transform.h"
#include "integrator/values/error.h"

namespace pm {

namespace {

bool emits(const MaterialDescription& material) {
    return !isBlack(material.emission);
}

}  // namespace

class Scene::Builder {
  public:
    Builder(Scene& scene, const CancelCheck& cancel) : m_scene(scene), m_cancel(cancel) {}

    void run() {
        cutWhereNeeded(m_scene.m_description, m_cancel);
        checkInstances();
        findHeights();
        findBounds();
        countUses();
        for (const InstanceDescription& instance : m_scene.m_description.instances)
            addShape(instance);
        shareGroupCache();
        findHuge();
        m_scene.m_isFlat = m_scene.findFlat(m_cancel);
        m_scene.m_hasSheets = findSheets();
        m_scene.m_viewersDiffer = findViewers();
        m_scene.m_letsThrough =
            std::ranges::any_of(m_scene.m_description.materials, pm::letsThrough);
        m_scene.m_filtersTextures =
            std::ranges::any_of(m_scene.m_description.materials, filtersTexture);
        m_scene.m_absorbs = std::ranges::any_of(m_scene.m_description.materials, absorbs);
        m_scene.m_hasThinWalls = std::ranges::any_of(m_scene.m_description.materials,
                                                     [](const auto& m) { return m.thinWalled; });
        noteHiddenSheen();
        addToTracer();
        for (std::uint32_t i = 0; i < m_scene.m_shapes.size(); ++i) findLights(i);
        m_scene.lookAtTextures(m_cancel);
        m_scene.m_media = Media::find(m_scene, m_scene.m_notices, m_cancel);
        m_scene.m_tables = makeMaterialTables(m_scene.m_description.materials,
                                              m_scene.m_media != nullptr, m_cancel);
        m_scene.m_coincident = CoincidentFaces::find(m_scene, m_scene.m_notices, m_cancel);
        lookForCloseSpheres();
        const SceneDescription& d = m_scene.m_description;
        const SceneBox box{m_scene.m_centre, m_scene.m_halfSize};
        addLights(d.lights, false, box, m_scene.m_lights);
        m_scene.m_nearLightCount = m_scene.m_lights.size();
        addLights(d.lights, true, box, m_scene.m_lights);
        addEnvironment(box);
        addLampTriangles();
        if (m_scene.m_lights.empty())
            m_scene.m_notices.push_back(
                {NoticeCode::kNoLight, "nothing in the scene emits light: the picture is black"});
    }

  private:
    // Called for every little step of what may take long.
    void goOn() {
        constexpr std::uint32_t kStepsBetweenLooks = 1 << 16;
        if (++m_steps % kStepsBetweenLooks == 0) m_cancel.throwIfSet("building the scene");
    }

    void noteHiddenSheen() {
        for (const MaterialDescription& material : m_scene.m_description.materials)
            if (hasCoat(material) && !isBlack(material.sheen))
                m_scene.m_notices.push_back(
                    {NoticeCode::kNotCovered,
                     fmt::format("material '{}' has a coat, so its sheen is left out",
                                 material.name)});
    }

    void checkInstances() const {
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
                                fmt::format("instance '{}' refers to material {} of {}",
                                            instance.name, material, d.materials.size()));
            checkSlots(instance);
        }
    }

    static void checkSlots(const InstanceDescription& instance) {
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

    // Meshes of which so many triangles would be there, in all their places, are instanced; smaller
    // ones take less memory and time where they are moved to their places.
    static constexpr std::size_t kLeastInstanced = 4096, kLeastOfInstanced = 16;

    void countUses() {
        for (const InstanceDescription& instance : m_scene.m_description.instances)
            if (const auto* mesh =
                    std::get_if<std::shared_ptr<const TriangleMesh>>(&instance.shape))
                if (!isFlattened(instance)) ++m_uses[mesh->get()];
    }

    // Where something in it is met by no ray, or float would not do in its own space.
    bool isFlattened(const InstanceDescription& instance) const {
        return Placement(instance.transform).condition > Placement::kMostCondition ||
               std::ranges::any_of(instance.materials, [&](std::uint32_t material) {
                   return isInvisible(m_scene.material(material));
               });
    }

    bool isInstanced(const InstanceDescription& instance, const TriangleMesh& mesh) const {
        const auto found = m_uses.find(&mesh);
        return found != m_uses.end() && found->second > 1 &&
               mesh.triangles.size() >= kLeastOfInstanced &&
               found->second * mesh.triangles.size() >= kLeastInstanced && !isFlattened(instance);
    }

    // Of the materials that have some; those on what can't be displaced are told.
    void findHeights() {
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

    void tellNotDisplaced(const InstanceDescription& instance,
                          const MaterialDescription& material) {
        m_scene.m_notices.push_back(
            {NoticeCode::kNotCovered,
             fmt::format(
                 "instance '{}' is no limit surface with texture coordinates that is cut on "
                 "demand: the displacement of its material '{}' is left out",
                 instance.name, material.name)});
    }

    // Of a limit shape's slots; null where they are not displaced.
    std::vector<const HeightField*> heightsOf(const InstanceDescription& instance,
                                              const LimitShape& shape) const {
        std::vector<const HeightField*> heights;
        if (!shape.surface().hasTexcoords()) return heights;
        for (const std::uint32_t material : instance.materials)
            heights.push_back(m_scene.m_heights[material].get());
        return heights;
    }

    // With the box of each triangle and sphere, world; of an instanced mesh with that of all.
    template <typename Visit>
    void forEachBox(const Visit& visit) {
        for (const InstanceDescription& instance : m_scene.m_description.instances) {
            const Transform& transform = instance.transform;
            if (const auto* mesh =
                    std::get_if<std::shared_ptr<const TriangleMesh>>(&instance.shape)) {
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
                visit(
                    CurvedShape(instance.shape, transform, {}, hasTexture, instance.name).bounds());
            }
        }
    }

    Box3d boxOf(const TriangleMesh& mesh, const Transform& transform) {
        Box3d box;
        for (const Vec3f& position : mesh.positions) {
            goOn();
            const Vec3d p = transformPoint(transform, Vec3d(position));
            box.grow({p, p});
        }
        return box;
    }

    void findBounds() {
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
            eye = Vec3d{camera->cameraToWorld[3], camera->cameraToWorld[7],
                        camera->cameraToWorld[11]};
        const auto core = findCore(
            whole, [&](const auto& visit) { forEachBox(visit); }, eye);
        m_scene.place(whole, core);
    }

    void addShape(const InstanceDescription& instance) {
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
                                  hasTexture(m_scene.material(record.materials[0])), instance.name);
        }
        m_scene.prepareMaps(record, instance, m_cancel);
        m_scene.m_shapes.push_back(std::move(record));
    }

    void addLimit(const std::shared_ptr<const LimitShape>& shape,
                  const InstanceDescription& instance, ShapeRecord& record) {
        Transform toScene = instance.transform;
        for (int axis = 0; axis < 3; ++axis)
            toScene[static_cast<std::size_t>(4 * axis + 3)] -= m_scene.m_centre[axis];
        record.groups = std::make_unique<LimitGroups>(
            shape, toScene, heightsOf(instance, *shape),
            ruleOf(m_scene.m_description, instance, m_scene.m_centre), m_cancel);
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

    // One for all limit surfaces of the scene.
    void shareGroupCache() {
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

    void placeMesh(const std::shared_ptr<const TriangleMesh>& mesh, Transform transform,
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

    // Built in the mesh's own space, for all of its instances and for scenes to come.
    std::shared_ptr<const SharedMesh> sharedMesh(const ShapeRecord& record) const {
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

    void addMesh(const std::shared_ptr<const TriangleMesh>& mesh, const Transform& transform,
                 ShapeRecord& record) {
        record.mesh = mesh;
        record.positions.reserve(mesh->positions.size() + 1);
        for (const Vec3f& p : mesh->positions) {
            goOn();
            record.positions.push_back(
                Vec3f(transformPoint(transform, Vec3d(p)) - m_scene.m_centre));
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

    // Calls visit(shape, triangle, its longest edge) for all triangles but instanced ones,
    // visit(shape, 0, diameter) for spheres; of groups once each, with about their triangles' size.
    template <typename Visit>
    void forEachSize(const Visit& visit) {
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

    // Triangles beside which all else is small are intersected in double where rays would otherwise
    // start farther off them than would do for what is small. Their vertices aren't rounded.
    void findHuge() {
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
                        transformPoint(
                            transform,
                            Vec3d(record.mesh->positions[record.mesh->triangles[i][k]])) -
                        m_scene.m_centre;
                record.exact.push_back(exact);
                record.facets[i] = Facet(record.corner(i), record.mirrored, true);
            }
        }
    }

    static double triangleArea(const ShapeRecord& record, std::uint32_t primitive) {
        const auto& t = record.mesh->triangles[primitive];
        const Vec3d v0 = record.vertex(t[0]);
        return 0.5 * length(cross(record.vertex(t[1]) - v0, record.vertex(t[2]) - v0));
    }

    FaceKind kindOf(const ShapeRecord& record, std::uint32_t primitive) const {
        const MaterialDescription& material = m_scene.material(record.materialOf(primitive));
        if (isInvisible(material)) return FaceKind::kInvisible;
        if (emits(material))
            return record.mirrored ? FaceKind::kShiningMirrored : FaceKind::kShining;
        if (material.kind == MaterialKind::kDielectric) return FaceKind::kGlass;
        return isSheet(material) ? FaceKind::kSheet : FaceKind::kOpaque;
    }

    void leaveOutCopies() {
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
        for (const PlacedFace& face : needless)
            m_scene.m_shapes[face.shape].leaveOut(face.primitive);
        for (ShapeRecord& record : m_scene.m_shapes)
            if (record.mesh && !record.visible.empty()) record.leaveOutExact();
        m_scene.m_notices.push_back(
            {NoticeCode::kDegenerateGeometry,
             fmt::format("{} triangles are copies of others in the same place, more than {} of "
                         "each: only the first of each is seen",
                         needless.size(), kMostCopies)});
    }

    void addToTracer() {
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

    void lookForCloseSpheres() {
        std::vector<GlassSphere> spheres;
        for (const ShapeRecord& record : m_scene.m_shapes)
            if (record.curved && record.curved->sphere() &&
                m_scene.material(record.materials[0]).kind == MaterialKind::kDielectric)
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

    // Lamps are met by sampled lobes and looked for by shadow rays.
    bool findViewers() const {
        return std::ranges::any_of(
            m_scene.m_description.instances, [&](const InstanceDescription& instance) {
                const bool shadow = (instance.hiddenFrom & kShadowRays) != 0,
                           reflection = (instance.hiddenFrom & kReflectionRays) != 0;
                const auto shines = [&](std::uint32_t m) { return emits(m_scene.material(m)); };
                return shadow != reflection ||
                       (reflection && std::ranges::any_of(instance.materials, shines));
            });
    }

    Viewers seenBy(std::uint32_t shape) const {
        const InstanceDescription& instance = m_scene.m_description.instances[shape];
        const auto shines = [&](std::uint32_t m) { return emits(m_scene.material(m)); };
        Viewers seen = kCameraRays | kShadowRays | kReflectionRays;
        seen &= ~instance.hiddenFrom;
        if ((seen & kShadowRays) != 0 || std::ranges::any_of(instance.materials, shines))
            seen |= kLightRays;
        return seen;
    }

    bool findSheets() const {
        const auto isOne = [&](std::uint32_t material) {
            return isSheet(m_scene.material(material));
        };
        return std::ranges::any_of(m_scene.m_shapes, [&](const ShapeRecord& record) {
            return std::ranges::any_of(record.materials, isOne);
        });
    }

    void findLights(std::uint32_t shape) {
        ShapeRecord& record = m_scene.m_shapes[shape];
        if (std::ranges::none_of(record.materials, [&](std::uint32_t material) {
                return emits(m_scene.material(material));
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
            if (!emits(m_scene.material(material))) continue;
            const double area = record.mesh ? triangleArea(record, i) : record.curved->area();
            if (!(area > 0)) continue;
            if (record.lightOfPrimitive.empty())
                record.lightOfPrimitive.assign(primitives, kNoLight);
            record.lightOfPrimitive[i] = static_cast<std::int32_t>(m_scene.m_lights.size());
            const SurfaceLight light{shape, i, material, -1, static_cast<float>(area)};
            const Rgb& e = m_scene.material(material).emission;
            const double power = kPiDouble * area * channelSum(e) / 3;
            if (record.mesh)
                m_scene.m_lights.emplace_back(TriangleLight{light}, power);
            else
                m_scene.m_lights.emplace_back(SphereLight{light}, power);
        }
    }

    void addEnvironment(const SceneBox& box) {
        const auto& description = m_scene.m_description.environment;
        if (!description || isBlack(description->radiance)) return;
        const bool hasBadTexels = description->texture != kNoTexture &&
                                  m_scene.findBadTexels(description->texture, m_cancel);
        auto environment = std::make_unique<const Environment>(
            *description, m_scene.m_description.textures.get(), m_cancel, hasBadTexels);
        if (!(environment->integral() > 0)) return;
        m_scene.m_environment = std::move(environment);
        const EnvironmentLight light{m_scene.m_environment.get()};
        m_scene.m_lights.emplace_back(light, light.powerMean(box));
    }

    void addLampTriangles() {
        m_scene.m_lampTriangles.resize(m_scene.m_lights.size());
        for (std::size_t i = 0; i < m_scene.m_lights.size(); ++i) {
            goOn();
            const SurfaceLight* const shining = m_scene.m_lights[i].surface();
            if (!shining || m_scene.material(shining->material).emissionTexture != kNoTexture)
                continue;
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

    // Bytes; a render divides its memory anew.
    static constexpr std::uint64_t kUsualGroupBudget = std::uint64_t{512} << 20;
    static constexpr double kPiDouble = 3.14159265358979323846;
    Scene& m_scene;
    CancelCheck m_cancel;
    std::uint32_t m_steps = 0;
    std::unordered_map<const TriangleMesh*, std::size_t> m_uses;
    // Of instanced ones, in their own space.
    std::unordered_map<const TriangleMesh*, double> m_areas, m_margins;
    std::size_t m_groupCount = 0;
    std::uint64_t m_triangleCountOfGroups = 0;
};

Scene::Scene(SceneDescription description, const std::string& isa, const CancelCheck& cancel)
    : m_description(std::move(description)), m_tracer(isa) {
    Builder(*this, cancel).run();
}

std::shared_ptr<const Scene> Scene::build(SceneDescription description, const std::string& isa,
                                          const CancelCheck& cancel) {
    return std::shared_ptr<const Scene>(new Scene(std::move(description), isa, cancel));
}

}  // namespace pm
