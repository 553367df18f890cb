// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cmath>
#include <concepts>
#include <string>

#include "integrator/shapes/instance_transform.h"
#include "integrator/shapes/roots.h"
#include "integrator/shapes/surface.h"
#include "integrator/values/box.h"
#include "integrator/values/transform.h"
#include "integrator/values/vec.h"

namespace pm {

// A curved shape in its own space, where its description stands, as that is there: roots() as
// CurvedShape has them; onto(): the point of it nearest to one that is on it to rounding;
// normalAt(): out of its front, of any length; uvAt(): of a texture. areaUnder(): where a transform
// takes it, to a thousandth.
template <typename T>
concept ObjectShape = requires(const T& shape, const Vec3d& point, const Transform& transform) {
    { shape.roots(point, point) } -> std::same_as<RayRoots>;
    { shape.onto(point) } -> std::same_as<Vec3d>;
    { shape.normalAt(point) } -> std::same_as<Vec3d>;
    { shape.uvAt(point) } -> std::same_as<Vec2f>;
    { shape.boundsUnder(transform) } -> std::same_as<Box3d>;
    { shape.areaUnder(transform) } -> std::same_as<double>;
};

// Throws Error(kInvalidScene) where a transform leaves nothing of one axis. kind, name: of what is
// under it.
void refuseFlat(const Transform& toWorld, const char* kind, const std::string& name);

// The same under any placement that can be undone, in the scene's own coordinates: rays are taken
// to its space in double precision, and what they meet back. t is the same in both.
template <ObjectShape Kind>
class InObjectSpace {
  public:
    // origin: of the scene's own coordinates, world. Throws Error(kInvalidScene) where nothing is
    // left of one axis.
    InObjectSpace(const Kind& kind, const Transform& toWorld, const Vec3d& origin, bool hasTexture,
                  const std::string& name)
        : m_kind(kind), m_toScene(toWorld), m_normals(toWorld), m_hasTexture(hasTexture) {
        for (std::size_t i = 0; i < 3; ++i)
            m_toScene[4 * i + 3] -= i == 0 ? origin.x : i == 1 ? origin.y : origin.z;
        const double determinant = std::abs(pm::determinant(toWorld));
        refuseFlat(toWorld, Kind::kName, name);
        // Rows of the normals' transform are columns of the inverse, times the determinant.
        for (std::size_t i = 0; i < 3; ++i) m_inverse[i] = m_normals.rows[i] / determinant;
    }

    Box3d bounds() const { return m_kind.boundsUnder(m_toScene); }
    double size() const { return length(bounds().size()); }
    double area() const { return m_kind.areaUnder(m_toScene); }
    RayRoots roots(const Vec3d& origin, const Vec3d& direction) const {
        return m_kind.roots(toObject(origin - translation()), toObject(direction));
    }
    void surfaceNear(const Vec3d& point, Surface& surface) const {
        const Vec3d own = m_kind.onto(toObject(point - translation()));
        surface.position = Vec3f(transformPoint(m_toScene, own));
        // It is intersected in double from a float origin, so that only roundings to float count.
        surface.offset = 2.0f * surfaceOffset(surface.position, 0.0f);
        surface.geometricNormal = surface.shadingNormal =
            m_normals.apply(Vec3f(normalize(m_kind.normalAt(own))));
        surface.uv = m_hasTexture ? m_kind.uvAt(own) : Vec2f{};
    }

  private:
    Vec3d translation() const { return {m_toScene[3], m_toScene[7], m_toScene[11]}; }
    Vec3d toObject(const Vec3d& v) const {
        return m_inverse[0] * v.x + m_inverse[1] * v.y + m_inverse[2] * v.z;
    }

    Kind m_kind;
    Transform m_toScene;
    NormalTransform m_normals;
    Vec3d m_inverse[3];  // columns, of the linear part
    bool m_hasTexture;
};

}  // namespace pm
