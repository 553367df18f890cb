// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>

#include "integrator/scene/scene_description.h"

namespace pm::plugin {

// The one time sample of a host's array of transforms; null is the identity. `what` names the thing
// it belongs to. Throws CallError: UNSUPPORTED for more than one sample, ARGUMENT for numbers that
// are not finite, a matrix without an inverse, or a count that does not fit the pointer.
Transform readTransform(const double* transforms, std::uint64_t count, const char* what);

// The determinant of the 3 x 3 part.
double determinant(const Transform& transform);

}  // namespace pm::plugin
