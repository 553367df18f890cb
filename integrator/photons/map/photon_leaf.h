// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include "integrator/photons/map/photon.h"
#include "integrator/values/rgb.h"
#include "integrator/values/vec.h"

namespace pm {

// Which photons count for a point on a surface: those of the side its normal points to, of about
// the same normal, near the plane through the point.
struct PhotonGate {
    // A photon counts when its surface's normal is within 25 degrees of the point's ...
    static constexpr float kNormalCosine = 0.9f;
    // ... and it lies at most this far off the point's plane, relative to its distance: a ball
    // becomes a disc, yet a curved surface (height d^2/2R at distance d) stays inside up to 0.4 R.
    static constexpr float kFlatness = 0.2f;

    // Positions are rounded to within this share of the largest coordinate, with room to spare.
    static constexpr float kRounding = 8.0f * 0x1p-24f;

    Vec3f position, normal;
    float planeToleranceSquared = 0.0f;             // what rounding may lift a photon off its plane
    float flatnessSquared = kFlatness * kFlatness;  // 0: of photons in the plane alone

    bool isInPlane(const Vec3f& fromPoint) const {
        const float height = dot(fromPoint, normal);
        return height * height <= planeToleranceSquared;
    }
    // Whether something `fromPoint` from the gate's point, of this normal, lies in a plane beside
    // the point's: of two sheets as close as can be, one knows nothing of the other.
    bool isBesidePlane(const Vec3f& fromPoint, const Vec3f& surfaceNormal) const {
        constexpr float kSameNormal = 0.99999f;
        return dot(surfaceNormal, normal) > kSameNormal && !isInPlane(fromPoint);
    }
    bool isNearPlane(const Vec3f& fromPoint, float distanceSquared) const {
        const float height = dot(fromPoint, normal);
        return height * height <= flatnessSquared * distanceSquared + planeToleranceSquared;
    }
    // Whether photons `fromPoint` from the gate's point, on a surface of this normal, count.
    bool accepts(const Vec3f& fromPoint, const Vec3f& surfaceNormal) const {
        return dot(surfaceNormal, normal) >= kNormalCosine &&
               isNearPlane(fromPoint, lengthSquared(fromPoint));
    }
    bool accepts(const Photon& photon) const {
        const Vec3f fromPoint = photon.position - position;
        return isNearPlane(fromPoint, lengthSquared(fromPoint)) &&
               photon.normal.dotWith(normal) >= kNormalCosine;
    }
};

// Sums of flux, W, in double: of all photons counted, and of the nearer ones among them.
struct FluxSums {
    std::array<double, 3> wide{}, narrow{};
};

// The flux of up to 16 photons, W, side by side; 0 where no photon is.
struct alignas(64) LeafFluxes {
    std::array<float, 16> r, g, b;

    Rgb at(std::uint32_t i) const { return {r[i], g[i], b[i]}; }
    void set(std::uint32_t i, const Rgb& flux) {
        r[i] = flux.r;
        g[i] = flux.g;
        b[i] = flux.b;
    }
    // Adds that of the photons whose bits are set; narrow: of those, the nearer ones. In four sums
    // of each fourth photon, then those together.
    void add(std::uint32_t wide, std::uint32_t narrow, FluxSums& sums) const;
};

// The places of up to 16 photons side by side, so that four can be tested at once; not initialised.
// The operations and their order are the same in both versions below, and so are the bits of what
// they return.
struct alignas(64) PhotonLeaf {
    static constexpr std::uint32_t kSize = 16;

    Vec3f position(std::uint32_t i) const { return {x[i], y[i], z[i]}; }
    void set(std::uint32_t i, const Vec3f& position, PackedNormal normal) {
        x[i] = position.x;
        y[i] = position.y;
        z[i] = position.z;
        normals[i] = std::bit_cast<std::uint32_t>(normal);
    }
    PackedNormal normal(std::uint32_t i) const { return std::bit_cast<PackedNormal>(normals[i]); }

    // Asks for the leaf to be at hand soon.
    void prefetch() const {
        for (const auto* line : {x.data(), y.data(), z.data()}) __builtin_prefetch(line);
        __builtin_prefetch(normals.data());
    }

    // Bit i: photon i passes the gate and lies within `reach` (squared) of its point, at
    // distancesSquared[i]. Where there is none, these may be left as they are.
    std::uint32_t findWithin(const PhotonGate& gate, float reach, float* distancesSquared) const;
    // Bit i: distancesSquared[i] <= reach.
    static std::uint32_t compare(const float* distancesSquared, float reach);
    // Adds the flux of those that findWithin finds; the nearer ones are those within half of
    // `reach`.
    void addWithin(const PhotonGate& gate, float reach, const LeafFluxes& fluxes,
                   FluxSums& sums) const;

    std::array<float, kSize> x, y, z;
    // As PackedNormal has them; of no length where no photon is, which is then never found.
    std::array<std::uint32_t, kSize> normals;
};
static_assert(sizeof(PhotonLeaf) == 256);

inline void LeafFluxes::add(std::uint32_t wide, std::uint32_t narrow, FluxSums& sums) const {
    const std::array<const float*, 3> channels = {r.data(), g.data(), b.data()};
    for (std::size_t c = 0; c < 3; ++c) {
        std::array<float, 4> all{}, near{};
        for (std::uint32_t i = 0; i < PhotonLeaf::kSize; ++i) {
            all[i % 4] += (wide >> i & 1) != 0 ? channels[c][i] : 0.0f;
            near[i % 4] += (narrow >> i & 1) != 0 ? channels[c][i] : 0.0f;
        }
        sums.wide[c] += static_cast<double>((all[0] + all[1]) + (all[2] + all[3]));
        sums.narrow[c] += static_cast<double>((near[0] + near[1]) + (near[2] + near[3]));
    }
}

#if defined(__SSE2__)

// Tests photons by fours.
class LeafTest {
  public:
    LeafTest(const PhotonGate& gate, float reach)
        : m_px(_mm_set1_ps(gate.position.x)),
          m_py(_mm_set1_ps(gate.position.y)),
          m_pz(_mm_set1_ps(gate.position.z)),
          m_nx(_mm_set1_ps(gate.normal.x)),
          m_ny(_mm_set1_ps(gate.normal.y)),
          m_nz(_mm_set1_ps(gate.normal.z)),
          m_tolerance(_mm_set1_ps(gate.planeToleranceSquared)),
          m_flatness(_mm_set1_ps(gate.flatnessSquared)),
          m_reach(_mm_set1_ps(reach)) {}

    // Which photons lie near the plane and within reach, and their squared distances.
    __m128 isNear(const PhotonLeaf& leaf, std::uint32_t i, __m128& d2) const {
        const __m128 dx = _mm_sub_ps(_mm_load_ps(&leaf.x[i]), m_px),
                     dy = _mm_sub_ps(_mm_load_ps(&leaf.y[i]), m_py),
                     dz = _mm_sub_ps(_mm_load_ps(&leaf.z[i]), m_pz);
        d2 = _mm_add_ps(_mm_add_ps(_mm_mul_ps(dx, dx), _mm_mul_ps(dy, dy)), _mm_mul_ps(dz, dz));
        const __m128 height = _mm_add_ps(_mm_add_ps(_mm_mul_ps(dx, m_nx), _mm_mul_ps(dy, m_ny)),
                                         _mm_mul_ps(dz, m_nz));
        const __m128 highest = _mm_add_ps(_mm_mul_ps(m_flatness, d2), m_tolerance);
        return _mm_and_ps(_mm_cmple_ps(d2, m_reach),
                          _mm_cmple_ps(_mm_mul_ps(height, height), highest));
    }
    // Which photons' normals are about the gate's.
    __m128 faces(const PhotonLeaf& leaf, std::uint32_t i) const {
        const auto component = [](__m128i packed, int shift) {
            return _mm_cvtepi32_ps(_mm_srai_epi32(_mm_slli_epi32(packed, shift), 24));
        };
        const __m128i packed = load(leaf, i);
        const __m128 cosine =
            _mm_mul_ps(_mm_add_ps(_mm_add_ps(_mm_mul_ps(component(packed, 24), m_nx),
                                             _mm_mul_ps(component(packed, 16), m_ny)),
                                  _mm_mul_ps(component(packed, 8), m_nz)),
                       _mm_set1_ps(PackedNormal::kScale));
        return _mm_cmpge_ps(cosine, _mm_set1_ps(PhotonGate::kNormalCosine));
    }
    // Most leaves lie on one flat surface, and one normal tells of all.
    static bool hasOneNormal(const PhotonLeaf& leaf) {
        const __m128i first = _mm_set1_epi32(
            std::bit_cast<std::int32_t>(static_cast<std::uint32_t>(leaf.normals[0])));
        const __m128i same = _mm_and_si128(_mm_and_si128(_mm_cmpeq_epi32(load(leaf, 0), first),
                                                         _mm_cmpeq_epi32(load(leaf, 4), first)),
                                           _mm_and_si128(_mm_cmpeq_epi32(load(leaf, 8), first),
                                                         _mm_cmpeq_epi32(load(leaf, 12), first)));
        return _mm_movemask_epi8(same) == 0xffff;
    }

  private:
    static __m128i load(const PhotonLeaf& leaf, std::uint32_t i) {
        return _mm_load_si128(reinterpret_cast<const __m128i*>(&leaf.normals[i]));
    }

    __m128 m_px, m_py, m_pz, m_nx, m_ny, m_nz, m_tolerance, m_flatness, m_reach;
};

inline std::uint32_t PhotonLeaf::findWithin(const PhotonGate& gate, float reach,
                                            float* distancesSquared) const {
    const bool hasOneNormal = LeafTest::hasOneNormal(*this);
    if (hasOneNormal && !(normal(0).dotWith(gate.normal) >= PhotonGate::kNormalCosine)) return 0;
    const LeafTest test(gate, reach);
    std::uint32_t found = 0;
    for (std::uint32_t i = 0; i < kSize; i += 4) {
        __m128 d2;
        __m128 passes = test.isNear(*this, i, d2);
        if (!hasOneNormal) passes = _mm_and_ps(passes, test.faces(*this, i));
        _mm_storeu_ps(distancesSquared + i, d2);
        found |= static_cast<std::uint32_t>(_mm_movemask_ps(passes)) << i;
    }
    return found;
}

inline void PhotonLeaf::addWithin(const PhotonGate& gate, float reach, const LeafFluxes& fluxes,
                                  FluxSums& sums) const {
    const bool hasOneNormal = LeafTest::hasOneNormal(*this);
    if (hasOneNormal && !(normal(0).dotWith(gate.normal) >= PhotonGate::kNormalCosine)) return;
    const LeafTest test(gate, reach);
    __m128 wide[kSize / 4], narrow[kSize / 4];
    for (std::uint32_t i = 0; i < kSize; i += 4) {
        __m128 d2;
        __m128 passes = test.isNear(*this, i, d2);
        if (!hasOneNormal) passes = _mm_and_ps(passes, test.faces(*this, i));
        wide[i / 4] = passes;
        narrow[i / 4] = _mm_and_ps(passes, _mm_cmple_ps(d2, _mm_set1_ps(0.5f * reach)));
    }
    if (_mm_movemask_ps(_mm_or_ps(_mm_or_ps(wide[0], wide[1]), _mm_or_ps(wide[2], wide[3]))) == 0)
        return;
    const auto sum = [](const float* of, const __m128* which) {
        __m128 lanes = _mm_and_ps(which[0], _mm_load_ps(of));
        for (std::uint32_t k = 1; k < 4; ++k)
            lanes = _mm_add_ps(lanes, _mm_and_ps(which[k], _mm_load_ps(of + std::size_t{4} * k)));
        const __m128 pairs =
            _mm_add_ps(lanes, _mm_shuffle_ps(lanes, lanes, _MM_SHUFFLE(2, 3, 0, 1)));
        return static_cast<double>(_mm_cvtss_f32(_mm_add_ss(pairs, _mm_movehl_ps(pairs, pairs))));
    };
    const std::array<const float*, 3> channels = {fluxes.r.data(), fluxes.g.data(),
                                                  fluxes.b.data()};
    for (std::size_t c = 0; c < 3; ++c) {
        sums.wide[c] += sum(channels[c], wide);
        sums.narrow[c] += sum(channels[c], narrow);
    }
}

inline std::uint32_t PhotonLeaf::compare(const float* distancesSquared, float reach) {
    std::uint32_t found = 0;
    for (std::uint32_t i = 0; i < kSize; i += 4)
        found |= static_cast<std::uint32_t>(_mm_movemask_ps(
                     _mm_cmple_ps(_mm_loadu_ps(distancesSquared + i), _mm_set1_ps(reach))))
                 << i;
    return found;
}

#else

inline std::uint32_t PhotonLeaf::findWithin(const PhotonGate& gate, float reach,
                                            float* distancesSquared) const {
    std::uint32_t found = 0;
    for (std::uint32_t i = 0; i < kSize; ++i) {
        const Vec3f d = position(i) - gate.position;
        distancesSquared[i] = lengthSquared(d);
        const bool passes = distancesSquared[i] <= reach &&
                            gate.isNearPlane(d, distancesSquared[i]) &&
                            normal(i).dotWith(gate.normal) >= PhotonGate::kNormalCosine;
        found |= static_cast<std::uint32_t>(passes) << i;
    }
    return found;
}

inline std::uint32_t PhotonLeaf::compare(const float* distancesSquared, float reach) {
    std::uint32_t found = 0;
    for (std::uint32_t i = 0; i < kSize; ++i)
        found |= static_cast<std::uint32_t>(distancesSquared[i] <= reach) << i;
    return found;
}

inline void PhotonLeaf::addWithin(const PhotonGate& gate, float reach, const LeafFluxes& fluxes,
                                  FluxSums& sums) const {
    std::array<float, kSize> distances;
    const std::uint32_t found = findWithin(gate, reach, distances.data());
    if (found != 0) fluxes.add(found, found & compare(distances.data(), 0.5f * reach), sums);
}

#endif

}  // namespace pm
