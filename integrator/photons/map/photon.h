// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "integrator/values/rgb.h"
#include "integrator/values/vec.h"

namespace pm {

// Of which group of lights a photon is, and in which slice of the shutter's time.
struct PhotonClass {
    static constexpr unsigned kGroups = 16, kSlices = 8;
    std::uint8_t group = 0;  // below kGroups
    std::uint8_t slice = 0;  // below kSlices

    bool operator==(const PhotonClass&) const = default;
};

// A unit normal to within half a degree, enough to tell one surface from another.
struct PackedNormal {
    std::array<std::int8_t, 4> components{};  // x, y, z, and marks: see below

    static constexpr float kScale = 1.0f / 127.0f;

    PackedNormal() = default;
    explicit PackedNormal(const Vec3f& n) : components{pack(n.x), pack(n.y), pack(n.z), 0} {}
    bool isNull() const { return components[0] == 0 && components[1] == 0 && components[2] == 0; }
    // A mark that whoever stores the normal gives a meaning.
    void mark() { setBits(bits() | kMark); }
    void unmark() { setBits(bits() & ~kMark); }
    bool isMarked() const { return (bits() & kMark) != 0; }
    // Which lights a photon is of, and when it was met.
    void setClass(const PhotonClass& of) {
        setBits((bits() & kMark) | static_cast<unsigned>(of.group) << 1 |
                static_cast<unsigned>(of.slice) << 5);
    }
    PhotonClass photonClass() const {
        return {static_cast<std::uint8_t>(bits() >> 1 & (PhotonClass::kGroups - 1)),
                static_cast<std::uint8_t>(bits() >> 5 & (PhotonClass::kSlices - 1))};
    }
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
    static constexpr unsigned kMark = 1;
    unsigned bits() const { return static_cast<std::uint8_t>(components[3]); }
    void setBits(unsigned bits) { components[3] = static_cast<std::int8_t>(bits); }
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

// A unit vector to within 1e-4 radians: on an octahedron whose lower half is folded outwards.
// Source: Meyer et al. 2010, "On floating-point normal vectors".
struct PackedDirection {
    std::array<std::int16_t, 2> components{};

    PackedDirection() = default;
    explicit PackedDirection(const Vec3f& v) {
        const float sum = std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
        const float x = v.x / sum, y = v.y / sum;
        components = v.z >= 0.0f ? std::array{pack(x), pack(y)}
                                 : std::array{pack(folded(x, y)), pack(folded(y, x))};
    }
    Vec3f unpack() const {
        const float x = static_cast<float>(components[0]) / kLargest;
        const float y = static_cast<float>(components[1]) / kLargest;
        const float z = 1.0f - std::abs(x) - std::abs(y);
        return normalize(z >= 0.0f ? Vec3f{x, y, z} : Vec3f{folded(x, y), folded(y, x), z});
    }

  private:
    static constexpr float kLargest = 32767.0f;
    static float folded(float a, float b) {
        return a < 0.0f ? std::abs(b) - 1.0f : 1.0f - std::abs(b);
    }
    static std::int16_t pack(float v) {
        return static_cast<std::int16_t>(v * kLargest + (v < 0.0f ? -0.5f : 0.5f));
    }
};

// A photon where it met a lobe that is glossy or broad. Its flux is as it arrived, with no regard
// to normals; marked: no path from the camera finds its like, see PhotonTraceResult.
struct ReceivedPhoton {
    Photon photon;
    PackedDirection from;  // away from the surface, to where it came from
};
static_assert(sizeof(ReceivedPhoton) == 32);

}  // namespace pm
