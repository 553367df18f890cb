// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/shapes/curved_shape.h"

#include <type_traits>
#include <variant>

#include "integrator/values/error.h"

namespace pm {

namespace {

CurvedKind place(const Shape& shape, const Transform& toWorld, const Vec3d& origin, bool hasTexture,
                 const std::string& name) {
    return std::visit(
        [&](const auto& kind) -> CurvedKind {
            using Given = std::decay_t<decltype(kind)>;
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
