// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Inside of Scene alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "integrator/materials/opacity.h"
#include "integrator/scene/scene.h"
#include "integrator/scene/scene_core.h"
#include "integrator/scene/shape_record.h"
#include "integrator/shapes/copied_faces.h"

namespace pm {

// Builds a Scene: checks the description, moves everything to the scene's own centre in double,
// then rounds to float once; finds the lights; hands the shapes to the ray tracer. Used once, by
// one thread, in the calling TBB arena.
class Scene::Builder {
  public:
    Builder(Scene& scene, const CancelCheck& cancel) : m_scene(scene), m_cancel(cancel) {}

    void run();

  private:
    // Called for every little step of what may take long.
    void goOn() {
        constexpr std::uint32_t kStepsBetweenLooks = 1 << 16;
        if (++m_steps % kStepsBetweenLooks == 0) m_cancel.throwIfSet("building the scene");
    }

    void noteHiddenSheen();
    void noteLostAnisotropy();
    void checkInstances() const;
    static void checkSlots(const InstanceDescription& instance);

    // Meshes of which so many triangles would be there, in all their places, are instanced; smaller
    // ones take less memory and time where they are moved to their places.
    static constexpr std::size_t kLeastInstanced = 4096, kLeastOfInstanced = 16;
    void countUses();

    // Where something in it is met by no ray, or float would not do in its own space.
    bool isFlattened(const InstanceDescription& instance) const;
    bool isInstanced(const InstanceDescription& instance, const TriangleMesh& mesh) const;

    // Of the materials that have some; those on what can't be displaced are told.
    void findHeights();
    void tellNotDisplaced(const InstanceDescription& instance, const MaterialDescription& material);

    // Of a limit shape's slots; null where they are not displaced.
    std::vector<const HeightField*> heightsOf(const InstanceDescription& instance,
                                              const LimitShape& shape) const;

    // Whether the material of each slot is cut whole; empty where none is.
    std::vector<bool> slotsCutWhole(const InstanceDescription& instance) const;
    bool isDisplaced(const InstanceDescription& instance, const LimitShape& shape) const;
    // Those limit shapes of which some material is cut whole: all of what is not displaced; of what
    // is, the faces of such materials, which go to a mesh of their own, where they would be anyway.
    // The first before the bounds are known, the second after.
    void cutPlain();
    void cutDisplaced();
    void cutDisplaced(std::size_t index);
    std::unique_ptr<LimitGroups> groupsOf(const std::shared_ptr<const LimitShape>& shape,
                                          const InstanceDescription& instance,
                                          std::vector<bool> slotsLeftOut) const;

    // With the box of each triangle and sphere, world; of an instanced mesh with that of all.
    template <typename Visit>
    void forEachBox(const Visit& visit);
    Box3d boxOf(const TriangleMesh& mesh, const Transform& transform);
    void findBounds();
    void addShape(const InstanceDescription& instance);
    void addLimit(const std::shared_ptr<const LimitShape>& shape,
                  const InstanceDescription& instance, ShapeRecord& record);

    // One for all limit surfaces of the scene.
    void shareGroupCache();
    void placeMesh(const std::shared_ptr<const TriangleMesh>& mesh, Transform transform,
                   ShapeRecord& record);

    // Built in the mesh's own space, for all of its instances and for scenes to come.
    std::shared_ptr<const SharedMesh> sharedMesh(const ShapeRecord& record) const;
    void addMesh(const std::shared_ptr<const TriangleMesh>& mesh, const Transform& transform,
                 ShapeRecord& record);

    // Calls visit(shape, triangle, its longest edge) for all triangles but instanced ones,
    // visit(shape, 0, diameter) for spheres; of groups once each, with about their triangles' size.
    template <typename Visit>
    void forEachSize(const Visit& visit);

    // Triangles beside which all else is small are intersected in double where rays would otherwise
    // start farther off them than would do for what is small. Their vertices aren't rounded.
    void findHuge();
    static double triangleArea(const ShapeRecord& record, std::uint32_t primitive);
    FaceKind kindOf(const ShapeRecord& record, std::uint32_t primitive) const;
    void leaveOutCopies();
    void addToTracer();
    void lookForCloseSpheres();

    // Lamps are met by sampled lobes and looked for by shadow rays.
    bool findViewers() const;
    Viewers seenBy(std::uint32_t shape) const;
    bool findSheets() const;
    void findLights(std::uint32_t shape);
    void addEnvironment(const SceneBox& box);
    void addLightTriangles();

    // Bytes; a render divides its memory anew.
    static constexpr std::uint64_t kUsualGroupBudget = std::uint64_t{512} << 20;
    static constexpr double kPiDouble = 3.14159265358979323846;
    Scene& m_scene;
    CancelCheck m_cancel;
    std::uint32_t m_steps = 0;
    std::unordered_map<const TriangleMesh*, std::size_t> m_uses;
    std::unordered_set<const TriangleMesh*> m_placed;  // in the scene's own coordinates already
    // Of instanced ones, in their own space.
    std::unordered_map<const TriangleMesh*, double> m_areas, m_margins;
    std::size_t m_groupCount = 0;
    std::uint64_t m_triangleCountOfGroups = 0;
};

}  // namespace pm
