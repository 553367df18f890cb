// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Casters are found by dividing all casting surfaces by place, always the largest part next, and by
// taking divisions back where they gain nothing: the whole of a ball is better than its pieces,
// whose bounds would overlap; of many small balls far apart only each alone is good.
#include "integrator/photons/emission/caustic_casters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "integrator/photons/emission/aim_mixture.h"

namespace pm {

namespace {

// What differs by less is alike, and the first is taken: rounding is not to choose between sides of
// what is symmetric, nor to divide what lies in one place.
constexpr double kAlike = 1e-5;
// A division stays when it leaves at most this share of the solid angle.
constexpr double kWorthDividing = 0.9;
constexpr std::size_t kBins = 16;
// Where to divide is judged by about so many items, however many there are.
constexpr std::size_t kJudges = 4096;

// A triangle, or a sphere: three times its centre, and a radius.
struct Item {
    std::array<Vec3f, 3> corners;
    float radius = 0.0f;
};

struct Box {
    Vec3d lo{std::numeric_limits<double>::infinity()};
    Vec3d hi{-std::numeric_limits<double>::infinity()};

    void grow(const Vec3d& p, double r) {
        for (int axis = 0; axis < 3; ++axis) {
            lo[axis] = std::min(lo[axis], p[axis] - r);
            hi[axis] = std::max(hi[axis], p[axis] + r);
        }
    }
    void grow(const Item& item) {
        for (const Vec3f& corner : item.corners)
            grow(Vec3d(corner), static_cast<double>(item.radius));
    }
    void grow(const Box& box) {
        if (box.lo.x > box.hi.x) return;
        grow(box.lo, 0);
        grow(box.hi, 0);
    }
    Vec3d centre() const { return (lo + hi) * 0.5; }
    double squaredDiagonal() const { return lo.x > hi.x ? 0.0 : lengthSquared(hi - lo); }
};

// Of an item's box; float does, since it only tells sides apart.
float middle(const Item& item, int axis) {
    const auto& [a, b, c] = item.corners;
    return 0.5f * (std::min({a[axis], b[axis], c[axis]}) + std::max({a[axis], b[axis], c[axis]}));
}

Vec3d middle(const Item& item) {
    return Vec3d(Vec3f{middle(item, 0), middle(item, 1), middle(item, 2)});
}

// A box whose corners lie this near to the sphere can be narrower than it: that of a ball can't.
constexpr double kUsefulBox = 1.2;

// Called for every item of what may take long.
void goOn(const CancelCheck& cancel) {
    cancel.throwIfSet("looking for what casts caustics");
}

Caster boundsOf(std::span<const Item> items, const CancelCheck& cancel) {
    Box box;
    for (const Item& item : items) {
        goOn(cancel);
        box.grow(item);
    }
    Caster caster{box.centre(), 0, (box.hi - box.lo) * 0.5, false};
    double squared = 0;  // of triangles alone, so that no root is taken for each
    for (const Item& item : items) {
        goOn(cancel);
        if (item.radius > 0.0f)
            caster.radius = std::max(caster.radius,
                                     length(Vec3d(item.corners[0]) - caster.centre) + item.radius);
        for (const Vec3f& corner : item.corners)
            squared = std::max(squared, lengthSquared(Vec3d(corner) - caster.centre));
    }
    caster.radius = std::max(caster.radius, std::sqrt(squared));
    caster.useBox = length(caster.halfSize) < kUsefulBox * caster.radius;
    return caster;
}

Vec3f toScene(const Transform& m, const Vec3f& point, const Vec3d& centre) {
    const Vec3d p(point);
    return Vec3f(Vec3d{m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3],
                       m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7],
                       m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11]} -
                 centre);
}

void addMesh(const Scene& scene, const InstanceDescription& instance, const TriangleMesh& mesh,
             std::vector<Item>& items, const CancelCheck& cancel) {
    std::vector<bool> casts;
    for (const std::uint32_t material : instance.materials)
        casts.push_back(scene.traits(material).castsCaustics);
    if (std::find(casts.begin(), casts.end(), true) == casts.end()) return;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        goOn(cancel);
        if (!casts[mesh.materials.empty() ? 0 : mesh.materials[i]]) continue;
        Item item;
        for (std::size_t k = 0; k < 3; ++k)
            item.corners[k] =
                toScene(instance.transform, mesh.positions[mesh.triangles[i][k]], scene.centre());
        items.push_back(item);
    }
}

Item itemOf(const SphereShape& sphere) {
    const Vec3f centre(sphere.centre);
    // What rounding to float takes off is given back.
    const double rounding = 0x1p-22 * (maxAbsComponent(sphere.centre) + sphere.radius);
    return {{centre, centre, centre}, static_cast<float>(sphere.radius + rounding)};
}

std::vector<Item> castingItems(const Scene& scene, const CancelCheck& cancel) {
    std::vector<Item> items;
    const auto& instances = scene.description().instances;
    for (std::uint32_t i = 0; i < instances.size(); ++i) {
        if (const auto* mesh =
                std::get_if<std::shared_ptr<const TriangleMesh>>(&instances[i].shape)) {
            addMesh(scene, instances[i], **mesh, items, cancel);
        } else if (std::ranges::any_of(instances[i].materials, [&](std::uint32_t material) {
                       return scene.traits(material).castsCaustics;
                   })) {
            for (std::uint32_t part = 0; part < scene.partCount(i); ++part)
                items.push_back(itemOf(scene.ballAroundPart(i, part)));
        }
    }
    return items;
}

// Where to divide: bins [0, bin] of an axis from the rest. Boxes stand for spheres, their squared
// diagonals for solid angles.
struct Division {
    int axis = 0;
    std::size_t bin = 0;
    double cost = std::numeric_limits<double>::infinity();
};

std::size_t binOf(const Item& item, const Box& middles, int axis) {
    const double extent = middles.hi[axis] - middles.lo[axis];
    // Simple fractions of the extent are not where bins meet.
    constexpr double kShift = 0.37;
    const double place =
        (static_cast<double>(middle(item, axis)) - middles.lo[axis]) / extent * (kBins - 1.0);
    return static_cast<std::size_t>(std::clamp(place + kShift, 0.0, kBins - 1.0));
}

void tryAxis(std::span<const Item> items, const Box& middles, const Box& whole, int axis,
             Division& best) {
    const double extent = middles.hi[axis] - middles.lo[axis];
    if (!(extent * extent > kAlike * kAlike * whole.squaredDiagonal())) return;
    std::array<Box, kBins> bins, after;
    for (std::size_t i = 0; i < items.size(); i += 1 + items.size() / kJudges)
        bins[binOf(items[i], middles, axis)].grow(items[i]);
    for (std::size_t i = kBins - 1; i > 0; --i) {
        after[i - 1] = after[i];
        after[i - 1].grow(bins[i]);
    }
    Box before;
    for (std::size_t i = 0; i + 1 < kBins; ++i) {
        before.grow(bins[i]);
        const double cost = before.squaredDiagonal() + after[i].squaredDiagonal();
        if (best.cost == std::numeric_limits<double>::infinity() ||
            cost < best.cost - kAlike * whole.squaredDiagonal())
            best = {axis, i, cost};
    }
}

// Divides a binary tree of parts and takes back what is not worth it.
class CasterTree {
  public:
    CasterTree(std::vector<Item> items, std::span<const EmissionPoint> viewpoints,
               const CancelCheck& cancel)
        : m_items(std::move(items)), m_viewpoints(viewpoints), m_cancel(cancel) {
        addNode(0, m_items.size());
        for (std::size_t leaves = 1; leaves < kMostFound; ++leaves)
            if (!divideLargest()) break;
    }

    std::vector<Caster> casters() {
        std::vector<Caster> casters;
        chooseCost(0);
        collect(0, casters);
        return casters;
    }

  private:
    struct Node {
        std::size_t begin, end;
        Caster bounds;
        std::size_t firstChild = 0;  // the second follows; 0: a leaf
        bool divisible = true;
    };

    std::span<Item> itemsOf(const Node& node) {
        return std::span(m_items).subspan(node.begin, node.end - node.begin);
    }

    void addNode(std::size_t begin, std::size_t end) {
        Node node{begin, end, {}, 0, end - begin > 1};
        node.bounds = boundsOf(itemsOf(node), m_cancel);
        m_nodes.push_back(node);
    }

    bool divideLargest() {
        for (;;) {
            std::size_t largest = m_nodes.size();
            for (std::size_t i = 0; i < m_nodes.size(); ++i)
                if (m_nodes[i].divisible && m_nodes[i].firstChild == 0 &&
                    (largest == m_nodes.size() ||
                     m_nodes[i].bounds.radius > (1 + kAlike) * m_nodes[largest].bounds.radius))
                    largest = i;
            if (largest == m_nodes.size()) return false;
            if (divide(largest)) return true;
            m_nodes[largest].divisible = false;
        }
    }

    bool divide(std::size_t index) {
        const Node node = m_nodes[index];
        const std::span<Item> items = itemsOf(node);
        Box middles, whole;
        for (std::size_t i = 0; i < items.size(); i += 1 + items.size() / kJudges) {
            middles.grow(middle(items[i]), 0);
            whole.grow(items[i]);
        }
        Division best;
        for (int axis = 0; axis < 3; ++axis) tryAxis(items, middles, whole, axis, best);
        if (best.cost == std::numeric_limits<double>::infinity()) return false;
        const auto split = std::stable_partition(items.begin(), items.end(), [&](const Item& item) {
            goOn(m_cancel);
            return binOf(item, middles, best.axis) <= best.bin;
        });
        const std::size_t at = node.begin + static_cast<std::size_t>(split - items.begin());
        if (at == node.begin || at == node.end) return false;
        m_nodes[index].firstChild = m_nodes.size();
        addNode(node.begin, at);
        addNode(at, node.end);
        return true;
    }

    // Solid angle of a node's best division, over the viewpoints; undoes what is not worth it.
    double chooseCost(std::size_t index) {
        const double whole = solidAngleFrom(m_viewpoints, m_nodes[index].bounds);
        if (m_nodes[index].firstChild == 0) return whole;
        const std::size_t child = m_nodes[index].firstChild;
        const double divided = chooseCost(child) + chooseCost(child + 1);
        if (divided <= kWorthDividing * whole && divided < whole) return divided;
        m_nodes[index].firstChild = 0;
        return whole;
    }

    void collect(std::size_t index, std::vector<Caster>& casters) const {
        const Node& node = m_nodes[index];
        if (node.firstChild == 0) {
            casters.push_back(node.bounds);
            return;
        }
        collect(node.firstChild, casters);
        collect(node.firstChild + 1, casters);
    }

    std::vector<Item> m_items;
    std::span<const EmissionPoint> m_viewpoints;
    const CancelCheck m_cancel;
    std::vector<Node> m_nodes;
};

}  // namespace

std::vector<Caster> findCasters(const Scene& scene, std::span<const EmissionPoint> viewpoints,
                                const CancelCheck& cancel) {
    std::vector<Item> items = castingItems(scene, cancel);
    if (items.empty()) return {};
    return CasterTree(std::move(items), viewpoints, cancel).casters();
}

}  // namespace pm
