// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <optional>

#include "host_shim/formats/pov/values/value.h"

namespace pm::host::pov {

// Rows of 3 x 4: p' = M[:, 0:3] p + M[:, 3].
using Matrix = std::array<double, 12>;
inline constexpr Matrix kIdentityMatrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

// a after b.
Matrix after(const Matrix& a, const Matrix& b);
std::array<double, 3> transformed(const Matrix& by, const std::array<double, 3>& point);
// None of a matrix without one.
std::optional<Matrix> inverse(const Matrix& of);

// Degrees; about x first, then y, then z, in the left-handed sense of POV-Ray's space.
Matrix rotation(const std::array<double, 3>& degrees);

// What translate, rotate, scale, matrix, transform { ... } and transform NAME do; none of another
// item. A scale of 0 counts as 1, as POV-Ray has it.
std::optional<Matrix> transformOf(const Node& item);
// Of all such items of a node, one after the other; `inverse` turns what was before it around.
Matrix transformOfItems(const Node& node);

}  // namespace pm::host::pov
