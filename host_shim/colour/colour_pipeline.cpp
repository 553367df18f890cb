// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/colour/colour_pipeline.h"

#include <fmt/format.h>
#include <xxhash.h>

#include "host_shim/colour/built_in_config.h"
#include "host_shim/colour/pipeline_state.h"

namespace pm::host {

ColourPipeline::ColourPipeline(const ColourOptions& options) : m_state(new State) {
    State& state = *m_state;
    state.options = options;
    state.builtIn = builtInColourConfig();
    state.config = chooseConfig(options);
    state.warnings = state.config.warnings;
    // Names first: an unknown one would come back from OpenColorIO with a text that misleads.
    chooseRenderingSpace(state);
    chooseView(state);
    const bool named = !options.materialSpace.empty();
    const auto material =
        resolveSpace(state, named ? options.materialSpace : kLinearRec709, "--material-space");
    if (!options.textureSpace.empty()) {
        resolveSpace(state, options.textureSpace, "--texture-space");
    }
    identifyRenderingSpace(state);
    state.material = convertToRendering(state, material, "--material-space");
}

ColourPipeline::~ColourPipeline() = default;
ColourPipeline::ColourPipeline(ColourPipeline&&) noexcept = default;
ColourPipeline& ColourPipeline::operator=(ColourPipeline&&) noexcept = default;

bool ColourPipeline::hasBuiltInConfig() const {
    return m_state->config.isBuiltIn;
}

const std::string& ColourPipeline::configName() const {
    return m_state->config.name;
}
const std::string& ColourPipeline::renderingSpace() const {
    return m_state->renderingSpace;
}
const std::string& ColourPipeline::colorInteropId() const {
    return m_state->interopId;
}
const std::string& ColourPipeline::display() const {
    return m_state->display;
}
const std::string& ColourPipeline::view() const {
    return m_state->view;
}
const std::vector<std::string>& ColourPipeline::warnings() const {
    return m_state->warnings;
}
std::optional<Matrix3> ColourPipeline::renderingToXyzD65() const {
    return m_state->toXyz;
}

std::optional<std::array<float, 8>> ColourPipeline::chromaticities() const {
    return m_state->chromaticities;
}

std::string ColourPipeline::cacheId() const {
    const ColourConfig& config = m_state->config;
    // With a context, OpenColorIO puts in the inode numbers of the config's LUT files, which are
    // other ones on another machine. So: the config's text, the variables it declares or was given,
    // and what the material conversion came out as.
    std::string text = config.config->getCacheID(OCIO::ConstContextRcPtr());
    for (int i = 0; i < config.config->getNumEnvironmentVars(); ++i) {
        const char* key = config.config->getEnvironmentVarNameByIndex(i);
        text += fmt::format("\n{}={}", key, config.context->getStringVar(key));
    }
    for (const auto& [key, value] : m_state->options.context) text += "\n" + key + "=" + value;
    text += "\n" + m_state->renderingSpace + "\n" + m_state->material.cacheId();
    const XXH128_hash_t hash = XXH3_128bits(text.data(), text.size());
    return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

std::array<double, 3> ColourPipeline::luminanceWeights() const {
    if (!m_state->toXyz) return {0.2126, 0.7152, 0.0722};
    const Matrix3& matrix = *m_state->toXyz;
    return {matrix[3], matrix[4], matrix[5]};
}

Rgb3 ColourPipeline::materialToRendering(const Rgb3& colour) const {
    Rgb3 result = colour;
    m_state->material.apply(result, 3);
    return result;
}

TextureSpace resolveSpace(const ColourPipeline::State& state, const std::string& name,
                          const std::string& option) {
    for (const ColourConfig* config : {&state.config, &state.builtIn}) {
        const auto space = findSpace(*config, name);
        if (!space) continue;
        return {space->getName(), isData(space), config == &state.builtIn, option};
    }
    const auto all = [](const OCIO::ConstColorSpaceRcPtr&) { return true; };
    std::string allowed = spaceNames(state.config, all);
    if (!state.config.isBuiltIn) {
        allowed += ", and pm's own " + spaceNames(state.builtIn, all);
    }
    throw HostError(
        ExitCode::kBadInput,
        fmt::format("{}: unknown colour space '{}'; allowed are {}", option, name, allowed));
}

SpaceConversion convertToRendering(const ColourPipeline::State& state, const TextureSpace& space,
                                   const std::string& option) {
    if (space.isData) return SpaceConversion();
    const ColourConfig& user = state.config;
    const std::string what =
        fmt::format("{}: from '{}' to '{}'", option, space.name, state.renderingSpace);
    if (!space.fromBuiltIn || user.isBuiltIn) {
        return guarded(what, [&] {
            return makeSpaceConversion(user.config->getProcessor(user.context, space.name.c_str(),
                                                                 state.renderingSpace.c_str()));
        });
    }
    const bool isScene = findSpace(state.builtIn, space.name)->getReferenceSpaceType() ==
                         OCIO::REFERENCE_SPACE_SCENE;
    const char* role = isScene ? OCIO::ROLE_INTERCHANGE_SCENE : OCIO::ROLE_INTERCHANGE_DISPLAY;
    if (!user.config->hasRole(role)) {
        const auto all = [](const OCIO::ConstColorSpaceRcPtr&) { return true; };
        throw HostError(
            ExitCode::kBadInput,
            fmt::format("{}: '{}' is pm's own and the config {} has no role {} to reach it by; "
                        "name a space of the config, allowed are {}",
                        option, space.name, user.name, role, spaceNames(user, all)));
    }
    return guarded(what, [&] {
        return makeSpaceConversion(OCIO::Config::GetProcessorFromConfigs(
            state.builtIn.context, state.builtIn.config, space.name.c_str(), user.context,
            user.config, state.renderingSpace.c_str()));
    });
}

}  // namespace pm::host
