// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host_shim/colour/colour_config.h"

namespace pm::host {
namespace {

using Probe = std::array<float, 3>;

Probe converted(const SpaceConversion& conversion, Probe value) {
    conversion.apply(value, 3);
    return value;
}

bool close(const Probe& a, const Probe& b) {
    float largest = 1.0f;
    for (const float value : b) largest = std::max(largest, std::fabs(value));
    for (std::size_t c = 0; c < 3; ++c) {
        // Written so that NaN is not close to anything.
        if (!(std::fabs(a[c] - b[c]) <= 1e-4f * largest)) return false;
    }
    return true;
}

Probe scaled(const Probe& a, float s) {
    return {a[0] * s, a[1] * s, a[2] * s};
}

Probe sum(const Probe& a, const Probe& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

// f(s a) = s f(a) and f(a + b) = f(a) + f(b), over what a picture holds: shadows, highlights and
// the negatives of colours outside the gamut.
bool isLinear(const SpaceConversion& f) {
    const std::array<Probe, 5> probes{
        {{1, 1, 1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-0.3f, 0.5f, -0.1f}}};
    for (const Probe& a : probes) {
        const Probe image = converted(f, a);
        for (const float s : {0.0f, 0.002f, 0.18f, 64.0f}) {
            if (!close(converted(f, scaled(a, s)), scaled(image, s))) return false;
        }
        for (const Probe& b : probes) {
            if (!close(converted(f, sum(a, b)), sum(image, converted(f, b)))) return false;
        }
    }
    return true;
}

// Null when the space is the reference space itself.
OCIO::ConstProcessorRcPtr toReference(const ColourConfig& config,
                                      const OCIO::ConstColorSpaceRcPtr& space) {
    if (const auto forward = space->getTransform(OCIO::COLORSPACE_DIR_TO_REFERENCE)) {
        return config.config->getProcessor(config.context, forward, OCIO::TRANSFORM_DIR_FORWARD);
    }
    if (const auto backward = space->getTransform(OCIO::COLORSPACE_DIR_FROM_REFERENCE)) {
        return config.config->getProcessor(config.context, backward, OCIO::TRANSFORM_DIR_INVERSE);
    }
    return nullptr;
}

}  // namespace

OCIO::ConstColorSpaceRcPtr findSpace(const ColourConfig& config, const std::string& name) {
    return config.config->getColorSpace(name.c_str());
}

bool isData(const OCIO::ConstColorSpaceRcPtr& space) {
    return space->isData();
}

bool canRender(const ColourConfig& config, const OCIO::ConstColorSpaceRcPtr& space) {
    if (isData(space)) return false;
    if (space->getReferenceSpaceType() != OCIO::REFERENCE_SPACE_SCENE) return false;
    const std::string encoding = space->getEncoding();
    if (!encoding.empty() && encoding != "scene-linear") return false;
    try {
        const auto processor = toReference(config, space);
        return processor == nullptr || isLinear(makeSpaceConversion(processor));
    } catch (const OCIO::Exception&) {
        return false;  // what can't be converted can't be rendered in
    }
}

std::string spaceNames(const ColourConfig& config,
                       const std::function<bool(const OCIO::ConstColorSpaceRcPtr&)>& keep) {
    std::vector<std::string> names;
    for (int i = 0; i < config.config->getNumColorSpaces(); ++i) {
        const std::string name = config.config->getColorSpaceNameByIndex(i);
        if (keep(findSpace(config, name))) names.push_back(name);
    }
    return quotedList(names);
}

std::string quotedList(const std::vector<std::string>& names) {
    if (names.empty()) return "none";
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "'" : ", '") + name + "'";
    return text;
}

}  // namespace pm::host
