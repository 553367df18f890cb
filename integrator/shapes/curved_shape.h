// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>
#include <variant>

#include "integrator/shapes/roots.h"
#include "integrator/shapes/shape.h"
#include "integrator/shapes/surface.h"
#include "integrator/values/box.h"

namespace pm {

// What is no mesh, in the scene's own coordinates: all that rays and the scene ask of it, whichever
// kind it is. A kind answers the same questions in a file of its own.
class CurvedShape {
  public:
    // shape: one that is no mesh; the other arguments and errors as PlacedSphere's.
    CurvedShape(const Shape& shape, const Transform& toWorld, const Vec3d& origin, bool hasTexture,
                const std::string& name);

    Box3d bounds() const {
        return std::visit([](const auto& kind) { return kind.bounds(); }, m_kind);
    }
    // Across, at most; scene units.
    double size() const {
        return std::visit([](const auto& kind) { return kind.size(); }, m_kind);
    }
    double area() const {
        return std::visit([](const auto& kind) { return kind.area(); }, m_kind);
    }
    // A ball that holds it; of a sphere that itself.
    SphereShape ball() const {
        if (const PlacedSphere* own = sphere()) return own->sphere();
        const Box3d box = bounds();
        return {box.middle(), 0.5 * length(box.size())};
    }
    // All of a line's, of which the first behind the origin of a ray is what it meets.
    RayRoots roots(const Vec3d& origin, const Vec3d& direction) const {
        return std::visit([&](const auto& kind) { return kind.roots(origin, direction); }, m_kind);
    }
    // Position, offset, normals and uv at a point that was found on it, to rounding.
    void surfaceNear(const Vec3d& point, Surface& surface) const {
        std::visit([&](const auto& kind) { kind.surfaceNear(point, surface); }, m_kind);
    }
    // Null where it is another kind. Lights that are spheres are sampled by what can be seen of
    // them.
    const PlacedSphere* sphere() const { return std::get_if<PlacedSphere>(&m_kind); }

  private:
    CurvedKind m_kind;
};

}  // namespace pm
