// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>

namespace pm {

// How far a surface is displaced along its normal. Threads: const functions from any.
class HeightField {
  public:
    virtual ~HeightField() = default;
    // Scene units; a function of the texture coordinates alone, within range().
    virtual double at(const std::array<double, 2>& texcoord) const = 0;
    // The least and the largest height, scene units.
    virtual std::array<double, 2> range() const = 0;
};

}  // namespace pm
