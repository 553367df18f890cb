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

#include "integrator/photons/photon.h"
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
    float planeToleranceSquared = 0.0f;  // what rounding may lift a photon off its plane

    bool isNearPlane(const Vec3f& fromPoint, float distanceSquared) const {
        const float height = dot(fromPoint, normal);
        return height * height <= kFlatness * kFlatness * distanceSquared + planeToleranceSquared;
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
    // distancesSquared[i].
    std::uint32_t findWithin(const PhotonGate& gate, float reach, float* distancesSquared) const;
    // Bit i: distancesSquared[i] <= reach.
    static std::uint32_t compare(const float* distancesSquared, float reach);

    std::array<float, kSize> x, y, z;
    // As PackedNormal has them; of no length where no photon is, which is then never found.
    std::array<std::uint32_t, kSize> normals;
};
static_assert(sizeof(PhotonLeaf) == 256);

#if defined(__SSE2__)

inline std::uint32_t PhotonLeaf::findWithin(const PhotonGate& gate, float reach,
                                            float* distancesSquared) const {
    const __m128 px = _mm_set1_ps(gate.position.x), py = _mm_set1_ps(gate.position.y),
                 pz = _mm_set1_ps(gate.position.z);
    const __m128 nx = _mm_set1_ps(gate.normal.x), ny = _mm_set1_ps(gate.normal.y),
                 nz = _mm_set1_ps(gate.normal.z);
    const auto component = [](__m128i packed, int shift) {
        return _mm_cvtepi32_ps(_mm_srai_epi32(_mm_slli_epi32(packed, shift), 24));
    };
    std::uint32_t found = 0;
    for (std::uint32_t i = 0; i < kSize; i += 4) {
        const __m128 dx = _mm_sub_ps(_mm_load_ps(&x[i]), px),
                     dy = _mm_sub_ps(_mm_load_ps(&y[i]), py),
                     dz = _mm_sub_ps(_mm_load_ps(&z[i]), pz);
        const __m128 d2 =
            _mm_add_ps(_mm_add_ps(_mm_mul_ps(dx, dx), _mm_mul_ps(dy, dy)), _mm_mul_ps(dz, dz));
        const __m128 height =
            _mm_add_ps(_mm_add_ps(_mm_mul_ps(dx, nx), _mm_mul_ps(dy, ny)), _mm_mul_ps(dz, nz));
        const __m128 highest =
            _mm_add_ps(_mm_mul_ps(_mm_set1_ps(PhotonGate::kFlatness * PhotonGate::kFlatness), d2),
                       _mm_set1_ps(gate.planeToleranceSquared));
        const __m128i packed = _mm_load_si128(reinterpret_cast<const __m128i*>(&normals[i]));
        const __m128 cosine =
            _mm_mul_ps(_mm_add_ps(_mm_add_ps(_mm_mul_ps(component(packed, 24), nx),
                                             _mm_mul_ps(component(packed, 16), ny)),
                                  _mm_mul_ps(component(packed, 8), nz)),
                       _mm_set1_ps(PackedNormal::kScale));
        const __m128 passes =
            _mm_and_ps(_mm_and_ps(_mm_cmple_ps(d2, _mm_set1_ps(reach)),
                                  _mm_cmple_ps(_mm_mul_ps(height, height), highest)),
                       _mm_cmpge_ps(cosine, _mm_set1_ps(PhotonGate::kNormalCosine)));
        _mm_storeu_ps(distancesSquared + i, d2);
        found |= static_cast<std::uint32_t>(_mm_movemask_ps(passes)) << i;
    }
    return found;
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

#endif

}  // namespace pm
