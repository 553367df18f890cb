// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string>

#include "integrator/materials/texture_source.h"

namespace pm::plugin {

// A pattern in space: 1 and one half by turns along x. Named stripes:WIDTH, in scene units.
struct Stripes {
    float width = 1.0f;

    Texel at(const TextureContext& context) const {
        const float value =
            std::fmod(std::floor(context.place.x / width), 2.0f) == 0.0f ? 1.0f : 0.5f;
        return {value, value, value, 1.0f};
    }
    static std::optional<Stripes> named(const std::string& name) {
        if (!name.starts_with("stripes:")) return std::nullopt;
        Stripes stripes;
        std::from_chars(name.data() + 8, name.data() + name.size(), stripes.width);
        return stripes;
    }
};

}  // namespace pm::plugin
