// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "integrator/caches/bounded_cache.h"
#include "integrator/tessellation/edge_rates.h"
#include "integrator/tessellation/limit_points.h"
#include "integrator/tessellation/triangle_group.h"
#include "integrator/values/box.h"

namespace pm {

using GroupCache = BoundedCache<TriangleGroup>;

// A displaced limit surface that stands in a scene as groups of triangles, each made when a ray
// first meets its box. What the triangles of a group are follows from the group alone. Triangles
// are numbered group by group, so that a number tells both. Constant. Threads: any.
class LimitGroups {
  public:
    // toScene: object to the scene's own coordinates. heights: of each slot of the cage, or empty.
    // slotsLeftOut: whose faces are not in it, though the others are where they would be with them;
    // of each slot, or empty. Looks at every face for its box; in parallel in the calling TBB
    // arena. Throws Error(kInvalidScene) for more than 2^32 - 1 triangles or a surface beyond
    // kMaxCoordinate; kCancelled.
    LimitGroups(std::shared_ptr<const LimitShape> shape, const Transform& toScene,
                std::vector<const HeightField*> heights, const TessellationRule& rule,
                const CancelCheck& cancel, std::vector<bool> slotsLeftOut = {});

    std::uint32_t groupCount() const { return static_cast<std::uint32_t>(m_groups.size()); }
    std::uint64_t triangleCount() const { return m_triangleCount; }
    // Holds all of its triangles.
    const Box3d& box(std::uint32_t group) const { return m_groups[group].box; }
    const Box3d& box() const { return m_box; }
    std::uint32_t firstTriangle(std::uint32_t group) const { return m_groups[group].firstTriangle; }
    std::uint32_t trianglesOf(std::uint32_t group) const;
    std::uint32_t groupOf(std::uint32_t triangle) const;
    // The material slot of all of a group's triangles.
    std::uint32_t slot(std::uint32_t group) const { return m_groups[group].slot; }
    bool hasTexcoords() const { return m_placed.shape.surface().hasTexcoords(); }
    const LimitShape& shape() const { return m_placed.shape; }

    std::unique_ptr<const TriangleGroup> make(std::uint32_t group) const;

    // Where the groups are kept: keys from firstKey on are theirs. Before pin().
    void keepIn(GroupCache& cache, std::size_t firstKey) {
        m_cache = &cache;
        m_firstKey = firstKey;
    }
    GroupCache::Pin pin(std::uint32_t group) const {
        return m_cache->get(m_firstKey + group, [&](std::size_t) {
            auto made = make(group);
            m_met[group].note(*made);
            return made;
        });
    }
    // The same, or nothing where the ray meets no triangle of the group between the two, as is
    // known since the group was first made: box() has to be as wide as the displacement may be
    // anywhere, and most rays in it pass by.
    GroupCache::Pin pinFor(std::uint32_t group, const ShearedRay& ray, double tNear,
                           double tFar) const {
        return m_met[group].mayMeet(ray, tNear, tFar) ? pin(group) : GroupCache::Pin();
    }

    // Calls visit for the triangles of the cage itself that are of a slot and have a surface, in
    // the scene's own coordinates and the cage's winding.
    void forEachCageTriangle(std::uint32_t slot,
                             const std::function<void(const std::array<Vec3d, 3>&)>& visit) const;

    // Without what the cache holds.
    std::uint64_t memoryBytes() const;

  private:
    struct Item {
        std::uint32_t face, part;
    };
    struct Group {
        std::uint32_t firstItem, firstTriangle, slot;
        Box3d box;
    };
    // The box of a group's triangles, from when it is first made on.
    class MetBox {
      public:
        // One thread at a time.
        void note(const TriangleGroup& made) {
            if (m_isKnown.load(std::memory_order_relaxed)) return;
            m_lo = made.lo();
            m_hi = made.hi();
            m_isKnown.store(true, std::memory_order_release);
        }
        bool mayMeet(const ShearedRay& ray, double tNear, double tFar) const {
            double in;
            return !m_isKnown.load(std::memory_order_acquire) ||
                   ray.meetsBox(m_lo, m_hi, tNear, tFar, in);
        }

      private:
        Vec3f m_lo, m_hi;
        std::atomic<bool> m_isKnown{false};
    };
    void listGroups(const CancelCheck& cancel);
    std::vector<std::uint32_t> facesInOrder(const CancelCheck& cancel) const;
    std::uint32_t slotOf(std::uint32_t face) const;
    bool isLeftOut(std::uint32_t slot) const {
        return !m_slotsLeftOut.empty() && m_slotsLeftOut[slot];
    }
    void findBoxes(const CancelCheck& cancel);
    Box3d boxOf(const Item& item, LimitPoints& points) const;

    std::shared_ptr<const LimitShape> m_shape;
    PlacedLimit m_placed;
    std::vector<bool> m_slotsLeftOut;
    std::vector<Item> m_items;
    std::vector<Group> m_groups;
    mutable std::vector<MetBox> m_met;  // of each
    Box3d m_box;
    std::uint64_t m_triangleCount = 0;
    GroupCache* m_cache = nullptr;
    std::size_t m_firstKey = 0;
};

}  // namespace pm
