// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/shapes/curved_shape.h"

#include <fmt/format.h>

#include <cmath>
#include <type_traits>
#include <variant>

#include "integrator/values/error.h"

namespace pm {

void refuseFlat(const Transform& toWorld, const char* kind, const std::string& name) {
    // Over the product of the axes' lengths, so little is left of the volume where it is flat.
    constexpr double kFlattest = 1e-9;
    const double lengths =
        length(row(toWorld, 0)) * length(row(toWorld, 1)) * length(row(toWorld, 2));
    if (std::abs(determinant(toWorld)) > kFlattest * lengths) return;
    throw Error(Status::kInvalidScene,
                fmt::format("{} '{}' is under a transform that flattens it", kind, name));
}

namespace {

CurvedKind place(const Shape& shape, const Transform& toWorld, const Vec3d& origin, bool hasTexture,
                 const std::string& name) {
    return std::visit(
        [&](const auto& kind) -> CurvedKind {
            using Given = std::decay_t<decltype(kind)>;
            if constexpr (std::is_same_v<Given, SphereShape>)
                if (uniformScale(toWorld) == 0.0) {
                    kind.check(name);
                    return InObjectSpace<SphereShape>(kind, toWorld, origin, hasTexture, name);
                }
            if constexpr (requires { typename Given::Placed; })
                return typename Given::Placed(kind, toWorld, origin, hasTexture, name);
            else
                throw Error(Status::kInternal, "a mesh is no curved shape");
        },
        shape);
}

}  // namespace

CurvedShape::CurvedShape(const Shape& shape, const Transform& toWorld, const Vec3d& origin,
                         bool hasTexture, const std::string& name)
    : m_kind(place(shape, toWorld, origin, hasTexture, name)) {}

}  // namespace pm
