// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>

#include "integrator/materials/material_description.h"

namespace pm::test {

// Of two materials of a scene, weight: of the second.
inline MaterialDescription mixture(std::uint32_t first, std::uint32_t second, float weight) {
    MaterialDescription m;
    m.kind = MaterialKind::kMixture;
    m.first = first;
    m.second = second;
    m.weight = weight;
    return m;
}

}  // namespace pm::test
