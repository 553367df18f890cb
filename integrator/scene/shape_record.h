// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <memory>
#include <optional>

#include "integrator/materials/material_description.h"
#include "integrator/scene/scene.h"
#include "integrator/shapes/curved_shape.h"
#include "integrator/shapes/placement.h"
#include "integrator/shapes/tangents.h"
#include "integrator/tessellation/limit_groups.h"

namespace pm {

// What is the same all over a triangle.
struct Scene::Facet {
    Vec3f normal;  // geometric, unit, out of the front
    // What surfaceOffset takes for the farthest vertex's distance: the longest edge, which no point
    // has farther to a vertex, and more of slivers; less where the triangle's box is flat; scene
    // units.
    float reach;

    // exact: intersected in double.
    Facet(const Corner& corner, bool mirrored, bool exact = false);
};

// What a triangle's corners have, in the scene's own coordinates.
struct Scene::Attributes {
    std::array<Vec3f, 3> normals{};
    std::array<Vec2f, 3> texcoords{};
    std::array<Vec3f, 3> tangents{};  // of limit surfaces; where u grows
    bool hasNormals = false, hasTexcoords = false;

    // Whether the texture is seen mirrored from the front, as the winding says.
    bool isMirrored() const {
        const auto& [a, b, c] = texcoords;
        return (b.x - a.x) * (c.y - a.y) < (b.y - a.y) * (c.x - a.x);
    }
};

// One instance made ready: vertices in the scene's own coordinates.
struct Scene::ShapeRecord {
    std::shared_ptr<const TriangleMesh> mesh;  // null for what is curved or cut on demand
    std::unique_ptr<LimitGroups> groups;       // of what is cut on demand
    // Of a mesh that rays meet where its instances have it; else its vertices and all that follows
    // of them are kept, moved to the scene.
    std::optional<Placement> placement;
    float reachOfPlacement = 0.0f;     // added to a facet's reach, scene units
    std::vector<Vec3f> positions;      // one spare element at the end, for Embree
    std::vector<Vec3f> normals;        // transformed, unit
    std::vector<Facet> facets;         // of each triangle
    std::vector<ExactTriangle> exact;  // huge ones, by their numbers
    // The triangles, without area those that no ray is to meet; empty where rays meet all there is.
    std::vector<TriangleMesh::Corners> visible;
    bool mirrored = false;                       // the transform turns the winding round
    std::optional<CurvedShape> curved;           // without a mesh or groups
    std::vector<std::uint32_t> materials;        // of each slot
    std::vector<std::int32_t> lightOfPrimitive;  // empty when nothing here emits
    std::uint32_t instanceId = 0;
    bool hasMaps = false;                      // some material has what applyMaps is for
    std::shared_ptr<const Tangents> tangents;  // in the mesh's space; null where none asks for them

    std::uint32_t materialOf(std::uint32_t primitive) const {
        if (groups && groups->groupCount() > 0)
            return materials[groups->slot(groups->groupOf(primitive))];
        return mesh ? materials[mesh->materials.empty() ? 0 : mesh->materials[primitive]]
                    : materials[0];
    }
    // Null where it is not intersected in double.
    const ExactTriangle* exactOf(std::uint32_t primitive) const {
        if (exact.empty()) return nullptr;
        const auto found =
            std::ranges::lower_bound(exact, primitive, {}, &ExactTriangle::primitive);
        return found != exact.end() && found->primitive == primitive ? &*found : nullptr;
    }
    // Calls visit(group, triangle's number in it) with a primitive of groups held.
    template <typename Visit>
    auto inGroup(std::uint32_t primitive, const Visit& visit) const {
        const std::uint32_t group = groups->groupOf(primitive);
        return visit(*groups->pin(group), primitive - groups->firstTriangle(group));
    }
    Corner corner(std::uint32_t primitive) const {
        if (groups)
            return inGroup(primitive, [](const TriangleGroup& group, std::uint32_t triangle) {
                const Vec3d v0(group.point(triangle, 0).position);
                return Corner{v0, Vec3d(group.point(triangle, 1).position) - v0,
                              Vec3d(group.point(triangle, 2).position) - v0};
            });
        if (const ExactTriangle* const found = exactOf(primitive))
            return {found->corners[0], found->corners[1] - found->corners[0],
                    found->corners[2] - found->corners[0]};
        const auto& triangle = mesh->triangles[primitive];
        const Vec3d v0 = vertex(triangle[0]);
        return {v0, vertex(triangle[1]) - v0, vertex(triangle[2]) - v0};
    }
    Vec3d vertex(std::uint32_t index) const {
        return placement ? transformPoint(placement->toScene, Vec3d(mesh->positions[index]))
                         : Vec3d(positions[index]);
    }
    Vec3f normal(std::uint32_t index) const {
        return placement ? placement->normals.apply(mesh->normals[index]) : normals[index];
    }
    Attributes attributes(std::uint32_t primitive) const {
        Attributes found;
        if (groups)
            return inGroup(primitive, [&](const TriangleGroup& group, std::uint32_t triangle) {
                found.hasNormals = true;
                found.hasTexcoords = groups->hasTexcoords();
                for (std::size_t i = 0; i < 3; ++i) {
                    const TriangleGroup::Point& point = group.point(triangle, i);
                    found.normals[i] = point.normal;
                    found.texcoords[i] = point.texcoord;
                    found.tangents[i] = point.tangent;
                }
                return found;
            });
        found.hasNormals = !mesh->normals.empty();
        found.hasTexcoords = !mesh->texcoords.empty();
        for (std::size_t i = 0; i < 3; ++i) {
            if (found.hasNormals) found.normals[i] = normal(mesh->normalIndices[primitive][i]);
            if (found.hasTexcoords)
                found.texcoords[i] = mesh->texcoords[mesh->texcoordIndices[primitive][i]];
        }
        return found;
    }
    // The corners' texture coordinates alone; false where there are none.
    bool texcoords(std::uint32_t primitive, std::array<Vec2f, 3>& found) const {
        if (groups) {
            found = attributes(primitive).texcoords;
            return groups->hasTexcoords();
        }
        if (mesh->texcoords.empty()) return false;
        for (std::size_t i = 0; i < 3; ++i)
            found[i] = mesh->texcoords[mesh->texcoordIndices[primitive][i]];
        return true;
    }
    Facet facet(std::uint32_t primitive) const { return facet(primitive, corner(primitive)); }
    // of: its corner.
    Facet facet(std::uint32_t primitive, const Corner& of) const {
        if (!placement && !groups) return facets[primitive];
        Facet facet(of, mirrored);
        facet.reach += reachOfPlacement;
        return facet;
    }
    // Of a triangle, the group that it is in, or the sphere.
    void bounds(std::uint32_t primitive, Vec3d& lo, Vec3d& hi) const {
        if (groups) {
            const Box3d& box = groups->box(groups->groupOf(primitive));
            lo = box.lo;
            hi = box.hi;
            return;
        }
        if (!mesh) {
            const Box3d box = curved->bounds();
            lo = box.lo;
            hi = box.hi;
            return;
        }
        const auto& triangle = mesh->triangles[primitive];
        lo = hi = vertex(triangle[0]);
        for (const Vec3d& v : {vertex(triangle[1]), vertex(triangle[2])})
            for (int axis = 0; axis < 3; ++axis) {
                lo[axis] = std::min(lo[axis], v[axis]);
                hi[axis] = std::max(hi[axis], v[axis]);
            }
    }
    // Fills `visible`.
    void leaveOutInvisible(const Scene& scene) {
        if (groups) return;  // what of them has such a material is a mesh
        const auto isOne = [&](std::uint32_t index) { return scene.traits(index).isInvisible; };
        if (std::ranges::none_of(materials, isOne)) return;
        if (mesh)
            visible = mesh->triangles;
        else
            visible.resize(1);
        if (!mesh) positions.resize(2);
        // Embree passes over triangles without area.
        for (std::uint32_t i = 0; i < visible.size(); ++i)
            if (isOne(materialOf(i))) visible[i].fill(visible[i][0]);
        std::erase_if(exact,
                      [&](const ExactTriangle& e) { return isOne(materialOf(e.primitive)); });
    }
    // Of a mesh.
    void leaveOut(std::uint32_t primitive) {
        if (visible.empty()) visible = mesh->triangles;
        visible[primitive].fill(visible[primitive][0]);
    }
    // After that, for each that was left out.
    void leaveOutExact() {
        std::erase_if(exact, [&](const ExactTriangle& e) {
            const TriangleMesh::Corners& t = visible[e.primitive];
            return t[0] == t[1] && t[1] == t[2];
        });
    }
    std::int32_t lightOf(std::uint32_t primitive) const {
        return lightOfPrimitive.empty() ? kNoLight : lightOfPrimitive[primitive];
    }
};

}  // namespace pm
