// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>

#include "integrator/values/rgb.h"
#include "integrator/values/vec.h"

namespace pm {

// A unit normal to within half a degree, enough to tell one surface from another.
struct PackedNormal {
    std::array<std::int8_t, 4> components{};  // x, y, z, and the mark

    static constexpr float kScale = 1.0f / 127.0f;

    PackedNormal() = default;
    explicit PackedNormal(const Vec3f& n) : components{pack(n.x), pack(n.y), pack(n.z), 0} {}
    bool isNull() const { return components[0] == 0 && components[1] == 0 && components[2] == 0; }
    // A mark that whoever stores the normal gives a meaning.
    void mark() { components[3] = 1; }
    bool isMarked() const { return components[3] != 0; }
    float dotWith(const Vec3f& n) const {
        return (static_cast<float>(components[0]) * n.x + static_cast<float>(components[1]) * n.y +
                static_cast<float>(components[2]) * n.z) *
               kScale;
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
    // Geometric, on the side where the photon came in; marked: refocused, see PhotonTraceResult.
    PackedNormal normal;
};
static_assert(sizeof(Photon) == 28);

}  // namespace pm
