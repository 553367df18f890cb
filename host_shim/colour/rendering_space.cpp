// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <fmt/format.h>

#include <algorithm>

#include "host_shim/colour/pipeline_state.h"
#include "host_shim/colour/primaries.h"

namespace pm::host {
namespace {

[[noreturn]] void refuse(const ColourConfig& config, const std::string& text) {
    const auto linear = [&](const auto& space) { return canRender(config, space); };
    throw HostError(
        ExitCode::kBadInput,
        fmt::format("--rendering-space: {}; allowed are the scene-linear spaces of {}: {}", text,
                    config.name, spaceNames(config, linear)));
}

// The matrix that a linear conversion is; column by column.
Matrix3 matrixOf(const SpaceConversion& conversion) {
    Matrix3 matrix{};
    for (std::size_t column = 0; column < 3; ++column) {
        Rgb3 unit{};
        unit[column] = 1.0f;
        conversion.apply(unit, 3);
        for (std::size_t row = 0; row < 3; ++row) matrix[row * 3 + column] = unit[row];
    }
    return matrix;
}

}  // namespace

void chooseRenderingSpace(ColourPipeline::State& state) {
    const ColourConfig& config = state.config;
    const std::string& asked = state.options.renderingSpace;
    if (asked.empty() && !config.config->hasRole(OCIO::ROLE_SCENE_LINEAR)) {
        refuse(config,
               fmt::format("the config {} has no role scene_linear, so a space must be named",
                           config.name));
    }
    const std::string name = asked.empty() ? OCIO::ROLE_SCENE_LINEAR : asked;
    const auto space = findSpace(config, name);
    if (!space) refuse(config, fmt::format("unknown colour space '{}'", name));
    const std::string shown = asked.empty()
                                  ? fmt::format("'{}' (role scene_linear)", space->getName())
                                  : fmt::format("'{}'", name);
    if (isData(space)) refuse(config, shown + " is data");
    if (!canRender(config, space)) refuse(config, shown + " is not scene-linear");
    state.renderingSpace = space->getName();
}

void identifyRenderingSpace(ColourPipeline::State& state) {
    const ColourConfig& config = state.config;
    if (!config.config->hasRole(OCIO::ROLE_INTERCHANGE_SCENE)) {
        state.warnings.push_back(
            fmt::format("the config {} has no role {}: luminance is weighed as in Rec.709, and EXR "
                        "files get no chromaticities",
                        config.name, OCIO::ROLE_INTERCHANGE_SCENE));
        return;
    }
    const auto toAces = guarded("role aces_interchange of " + config.name, [&] {
        return makeSpaceConversion(config.config->getProcessor(
            config.context, state.renderingSpace.c_str(), OCIO::ROLE_INTERCHANGE_SCENE));
    });
    state.toXyz = multiply(acesToXyzD65(), matrixOf(toAces));
    std::optional<Chromaticities> figures;
    if (const auto known = recognise(*state.toXyz)) {
        state.interopId = known->interopId;
        figures = known->chromaticities;
    } else {
        figures = derivedChromaticities(*state.toXyz);
    }
    if (!figures) return;
    state.chromaticities.emplace();
    std::transform(figures->begin(), figures->end(), state.chromaticities->begin(),
                   [](double value) { return static_cast<float>(value); });
}

}  // namespace pm::host
