// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "integrator/values/rgb.h"
#include "integrator/values/vec.h"

namespace pm {

// A unit normal to within half a degree, enough to tell one surface from another.
struct PackedNormal {
    std::array<std::int8_t, 4> components{};

    PackedNormal() = default;
    explicit PackedNormal(const Vec3f& n) : components{pack(n.x), pack(n.y), pack(n.z), 0} {}
    float dotWith(const Vec3f& n) const {
        return (static_cast<float>(components[0]) * n.x + static_cast<float>(components[1]) * n.y +
                static_cast<float>(components[2]) * n.z) *
               (1.0f / 127.0f);
    }

    Vec3f unpack() const {
        return normalize(Vec3f{static_cast<float>(components[0]), static_cast<float>(components[1]),
                               static_cast<float>(components[2])});
    }

  private:
    static std::int8_t pack(float v) {
        return static_cast<std::int8_t>(v * 127.0f + (v < 0.0f ? -0.5f : 0.5f));
    }
};

// A photon where it met a diffuse surface, before it was scattered or absorbed.
struct Photon {
    Vec3f position;  // scene's own coordinates
    Rgb flux;  // W; times |cos| to the shading normal over |cos| to the geometric one, so that
               // its share of a flux density is irradiance as the camera's side has it
    PackedNormal normal;  // geometric, on the side where the photon came in
};
static_assert(sizeof(Photon) == 28);

// The k photons found for a point, with the working memory of a query; one for each thread.
class NearestPhotons {
  public:
    struct Found {
        float distanceSquared;
        std::uint32_t index;
        // Nearer first; of equals the lower index, so that the set found never depends on the order
        // of the search.
        friend bool operator<(const Found& a, const Found& b) {
            return a.distanceSquared < b.distanceSquared ||
                   (a.distanceSquared == b.distanceSquared && a.index < b.index);
        }
    };
    // In no particular order, unless full(): then the farthest is first.
    const std::vector<Found>& found() const { return m_found; }

  private:
    friend class PhotonMap;
    std::vector<Found> m_found;
};

// What a query looks for.
struct PhotonQuery {
    Vec3f position;
    Vec3f normal;                  // unit, on the side whose photons count
    std::uint32_t count = 50;      // k
    float maxRadius = 0.0f;        // scene units
    std::uint32_t leaveOut = ~0u;  // index of a photon not to be found: the one a query stands on
};

// Photons in a balanced, pointer-free kd-tree (medians in an implicit heap, leaves of at most 16
// photons side by side). The same photons give the same tree for any number of threads.
// Threads: all const functions from any, at once.
// Source: Jensen 2001, section 6.1 (the tree).
class PhotonMap {
  public:
    // Builds in parallel in the calling TBB arena. Photons whose position is not finite must not be
    // among them.
    explicit PhotonMap(std::vector<Photon> photons);

    // While it is built: the photons twice, and an entry of the tree each.
    static constexpr std::uint64_t kBytesPerPhoton = 2 * sizeof(Photon) + 16;

    bool empty() const { return m_photons.empty(); }
    std::size_t size() const { return m_photons.size(); }
    const Photon& photon(std::uint32_t index) const { return m_photons[index]; }
    std::uint64_t memoryBytes() const;

    // Finds the query.count nearest accepted photons within query.maxRadius: those of the side the
    // normal points to, of about the same normal, near the plane through the point. Ties go to the
    // lower index.
    void findNearest(const PhotonQuery& query, NearestPhotons& nearest) const;

    // The flux, W, of the accepted photons within radius: over pi radius^2 it is irradiance,
    // without bias where that is constant and the surface fills the disc, however the photons are
    // spread. (An estimate from the k nearest is unbiased for independent photons alone; these are
    // stratified.) Summed in double in the order of the tree.
    Rgb fluxWithin(const Vec3f& position, const Vec3f& normal, float radius) const {
        return fluxWithin(position, normal, radius, [](const Photon&) { return true; });
    }
    template <typename Accept>
    Rgb fluxWithin(const Vec3f& position, const Vec3f& normal, float radius,
                   const Accept& accept) const;

    // Whether a photon at `fromPoint` from a point with `normal`, on a surface with
    // `surfaceNormal`, would be counted there; distance aside.
    bool accepts(const Vec3f& fromPoint, const Vec3f& surfaceNormal, const Vec3f& normal) const {
        return dot(surfaceNormal, normal) >= kNormalCosine &&
               isNearPlane(fromPoint, lengthSquared(fromPoint), normal);
    }

    // The radius within which half of the photons find count others; of fewer photons, the size of
    // what they cover. Scene units, > 0.
    float typicalRadius(std::uint32_t count) const;

  private:
    struct Node {
        float split;
        std::uint32_t axis;
    };
    struct Entry;
    // A photon counts when its surface's normal is within 25 degrees of the query's ...
    static constexpr float kNormalCosine = 0.9f;
    // ... and it lies at most this far off the query's plane, relative to its distance: a ball
    // becomes a disc, yet a curved surface (height d^2/2R at distance d) stays inside up to 0.4 R.
    static constexpr float kFlatness = 0.2f;

    void buildNode(std::vector<Entry>& entries, std::size_t node, std::size_t begin,
                   std::size_t end, std::uint32_t level);
    bool matches(const Photon& photon, const Vec3f& d, float d2, const Vec3f& normal) const {
        return photon.normal.dotWith(normal) >= kNormalCosine && isNearPlane(d, d2, normal);
    }
    bool isNearPlane(const Vec3f& d, float d2, const Vec3f& normal) const {
        const float height = dot(d, normal);
        return height * height <= kFlatness * kFlatness * d2 + m_planeTolerance * m_planeTolerance;
    }
    // Calls leaf(begin, end) for every leaf within `reach` (squared, may shrink meanwhile), nearer
    // halves first.
    template <typename Leaf>
    void visitLeaves(const Vec3f& position, const float& reach, const Leaf& leaf) const;

    std::vector<Photon> m_photons;  // leaf after leaf
    std::vector<Node> m_nodes;      // children of i at 2i+1, 2i+2
    std::uint32_t m_levels = 0;
    float m_planeTolerance = 0.0f;  // scene units; what rounding may lift a photon off its plane
};

template <typename Leaf>
void PhotonMap::visitLeaves(const Vec3f& position, const float& reach, const Leaf& leaf) const {
    struct Pending {
        std::size_t node, begin, end;
        std::uint32_t level;
        float planeDistanceSquared;
    };
    std::array<Pending, 64> stack;
    std::size_t depth = 0;
    stack[depth++] = {0, 0, m_photons.size(), 0, 0.0f};
    while (depth > 0) {
        Pending at = stack[--depth];
        if (at.planeDistanceSquared > reach) continue;
        while (at.level < m_levels) {
            const Node& node = m_nodes[at.node];
            const float side = position[static_cast<int>(node.axis)] - node.split;
            const std::size_t middle = at.begin + (at.end - at.begin) / 2;
            const Pending left{2 * at.node + 1, at.begin, middle, at.level + 1, side * side};
            const Pending right{2 * at.node + 2, middle, at.end, at.level + 1, side * side};
            stack[depth++] = side < 0.0f ? right : left;
            at = side < 0.0f ? left : right;
        }
        leaf(at.begin, at.end);
    }
}

template <typename Accept>
Rgb PhotonMap::fluxWithin(const Vec3f& position, const Vec3f& normal, float radius,
                          const Accept& accept) const {
    double r = 0, g = 0, b = 0;
    const float reach = radius * radius;
    visitLeaves(position, reach, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Photon& photon = m_photons[i];
            const Vec3f d = photon.position - position;
            const float d2 = lengthSquared(d);
            if (d2 > reach || !matches(photon, d, d2, normal) || !accept(photon)) continue;
            r += static_cast<double>(photon.flux.r);
            g += static_cast<double>(photon.flux.g);
            b += static_cast<double>(photon.flux.b);
        }
    });
    return {static_cast<float>(r), static_cast<float>(g), static_cast<float>(b)};
}

}  // namespace pm
