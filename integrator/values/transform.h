// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>

namespace pm {

// Object to world, 3 x 4, row-major: p' = M[:, 0:3] p + M[:, 3].
using Transform = std::array<double, 12>;
inline constexpr Transform kIdentityTransform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

}  // namespace pm
