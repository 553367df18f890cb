// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/colour/colour_config.h"
#include "host_shim/colour/colour_pipeline.h"

namespace pm::host {

struct ColourPipeline::State {
    ColourOptions options;
    ColourConfig config;
    ColourConfig builtIn;  // the same as config when no config was given
    std::string renderingSpace;
    std::string display, view;
    std::string interopId;
    std::optional<Matrix3> toXyz;
    std::optional<std::array<float, 8>> chromaticities;
    SpaceConversion material;
    std::vector<std::string> warnings;
};

// A name looked up in the user's config, then in the built-in one. Errors: kBadInput with the
// option and what is allowed. decidedBy is copied into the result.
TextureSpace resolveSpace(const ColourPipeline::State& state, const std::string& name,
                          const std::string& option);
// Into the rendering space. Errors: kBadInput, naming the option and the role that is missing.
SpaceConversion convertToRendering(const ColourPipeline::State& state, const TextureSpace& space,
                                   const std::string& option);

// What a file states of its colours, as a space; none where it says nothing that can be understood.
std::optional<TextureSpace> statedSpace(const ColourPipeline::State& state, bool isFloatFile,
                                        const PictureStatement& statement);

// These check state.options against the config and fill in the fields they are named after.
void chooseRenderingSpace(ColourPipeline::State& state);
void chooseView(ColourPipeline::State& state);
// XYZ matrix, chromaticities and interop ID.
void identifyRenderingSpace(ColourPipeline::State& state);

}  // namespace pm::host
