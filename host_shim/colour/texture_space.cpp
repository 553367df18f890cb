// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// ColourPipeline: which space a texture is in, and the way from there.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host_shim/colour/built_in_config.h"
#include "host_shim/colour/pipeline_state.h"
#include "host_shim/colour/primaries.h"
#include "host_shim/colour/transfer_curve.h"

namespace pm::host {
namespace {

constexpr const char* kByTheFile = "the file";

// A name or alias of a space, the user's config first; files name what they like.
std::optional<TextureSpace> spaceOfName(const ColourPipeline::State& state,
                                        const std::string& name) {
    for (const ColourConfig* config : {&state.config, &state.builtIn})
        if (const auto space = findSpace(*config, name))
            return TextureSpace{
                space->getName(), isData(space), config == &state.builtIn, kByTheFile, {}};
    return std::nullopt;
}

bool areUsable(const std::array<float, 8>& chromaticities) {
    const bool finite = std::ranges::all_of(
        chromaticities, [](float v) { return std::isfinite(v) && std::fabs(v) < 10.0f; });
    // Primaries on one line span no colours, and y = 0 has no luminance.
    const auto& c = chromaticities;
    const float area = (c[2] - c[0]) * (c[5] - c[1]) - (c[4] - c[0]) * (c[3] - c[1]);
    return finite && std::fabs(area) > 1e-3f && c[7] > 1e-3f;
}

std::optional<Matrix3> inverted(const Matrix3& m) {
    const auto minor = [&](std::size_t a, std::size_t b, std::size_t c, std::size_t d) {
        return m[a] * m[d] - m[b] * m[c];
    };
    const Matrix3 adjugate{minor(4, 5, 7, 8),  -minor(1, 2, 7, 8), minor(1, 2, 4, 5),
                           -minor(3, 5, 6, 8), minor(0, 2, 6, 8),  -minor(0, 2, 3, 5),
                           minor(3, 4, 6, 7),  -minor(0, 1, 6, 7), minor(0, 1, 3, 4)};
    const double determinant = m[0] * adjugate[0] + m[1] * adjugate[3] + m[2] * adjugate[6];
    if (!(std::fabs(determinant) > 1e-12)) return std::nullopt;
    Matrix3 result = adjugate;
    for (double& value : result) value /= determinant;
    return result;
}

SpaceConversion matrixConversion(const Matrix3& matrix) {
    std::array<double, 16> m44{};
    for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t column = 0; column < 3; ++column)
            m44[row * 4 + column] = matrix[row * 3 + column];
    m44[15] = 1.0;
    const auto transform = OCIO::MatrixTransform::Create();
    transform->setMatrix(m44.data());
    return makeSpaceConversion(OCIO::Config::CreateRaw()->getProcessor(transform));
}

TextureSpace spaceOfMatrix(const Matrix3& toXyz) {
    return {"", false, false, kByTheFile, toXyz};
}

// Of linear light, by its primaries. tolerance: see recognise().
std::optional<TextureSpace> spaceOfLight(const ColourPipeline::State& state,
                                         const PictureStatement& statement, double tolerance) {
    if (!statement.chromaticities || !areUsable(*statement.chromaticities)) return std::nullopt;
    Chromaticities figures{};
    std::ranges::copy(*statement.chromaticities, figures.begin());
    const Matrix3 toXyz = rgbToXyzD65(figures);
    if (const auto known = recognise(toXyz, tolerance))
        if (auto space = spaceOfName(state, known->interopId)) return space;
    // Without a matrix there is no way from here to the rendering space.
    return state.toXyz ? std::optional(spaceOfMatrix(toXyz)) : std::nullopt;
}

// Of codes, by curve and primaries; Rec.709's where no others are told.
std::optional<TextureSpace> spaceOfCodes(const ColourPipeline::State& state,
                                         const PictureStatement& statement) {
    // Profiles round their matrices.
    constexpr double kOfProfiles = 2e-3;
    auto light = spaceOfLight(state, statement, kOfProfiles);
    if (!light) light = resolveSpace(state, kLinearRec709, kByTheFile);
    const bool isSrgb = areAlike(*statement.curve, kSrgbCurve);
    const bool isRec709 =
        !light->toXyz && light->name == resolveSpace(state, kLinearRec709, kByTheFile).name;
    if (isSrgb && isRec709)
        light = resolveSpace(state, kSrgbTexture, kByTheFile);
    else
        light->curve = isSrgb ? kSrgbCurve : *statement.curve;
    // What can't be reached decides nothing.
    const bool isFar = light->fromBuiltIn && !state.config.isBuiltIn && !state.toXyz;
    return isFar ? std::nullopt : light;
}

std::optional<TextureSpace> ruledSpace(const ColourPipeline::State& state,
                                       const std::filesystem::path& file, bool byDefaultRule) {
    const auto& config = state.config.config;
    const std::string path = file.string();
    if (state.config.isBuiltIn) return std::nullopt;
    const bool isDefault = config->filepathOnlyMatchesDefaultRule(path.c_str());
    // OpenColorIO: with strict parsing, an application decides where only the Default rule matches.
    if (isDefault && (!byDefaultRule || config->isStrictParsingEnabled())) return std::nullopt;
    return resolveSpace(state, config->getColorSpaceFromFilepath(path.c_str()), "file rules");
}

}  // namespace

std::optional<TextureSpace> statedSpace(const ColourPipeline::State& state, bool isFloatFile,
                                        const PictureStatement& statement) {
    if (statement.isXyz) return spaceOfMatrix({1, 0, 0, 0, 1, 0, 0, 0, 1});
    for (const std::string& name : statement.spaces)
        if (auto space = spaceOfName(state, name)) return space;
    if (isFloatFile) return spaceOfLight(state, statement, 1e-4);
    if (!statement.profile.empty())
        if (auto space = spaceOfName(state, statement.profile)) return space;
    return statement.curve ? spaceOfCodes(state, statement) : std::nullopt;
}

TextureSpace ColourPipeline::textureSpace(const std::filesystem::path& file, bool isFloatFile,
                                          const std::string& colorspaceOfMapLine,
                                          const PictureStatement& statement) const {
    const State& state = *m_state;
    if (!colorspaceOfMapLine.empty())
        return resolveSpace(state, colorspaceOfMapLine, "-colorspace");
    if (!state.options.textureSpace.empty())
        return resolveSpace(state, state.options.textureSpace, "--texture-space");
    if (auto ruled = ruledSpace(state, file, false)) return *ruled;
    if (auto stated = statedSpace(state, isFloatFile, statement)) return *stated;
    if (auto ruled = ruledSpace(state, file, true)) return *ruled;
    TextureSpace space =
        resolveSpace(state, isFloatFile ? kLinearRec709 : kSrgbTexture, "--texture-space");
    space.decidedBy = "default";
    return space;
}

SpaceConversion ColourPipeline::textureToRendering(const TextureSpace& space) const {
    const std::string what = space.decidedBy == "-colorspace" || space.decidedBy == "file rules"
                                 ? space.decidedBy
                                 : "--texture-space";
    const auto finished = [&](const SpaceConversion& ofLight) {
        return space.curve ? ofLight.ofCodes(*space.curve) : ofLight;
    };
    if (!space.toXyz) return finished(convertToRendering(*m_state, space, what));
    const auto fromXyz = m_state->toXyz ? inverted(*m_state->toXyz) : std::nullopt;
    if (!fromXyz)
        throw HostError(ExitCode::kBadInput,
                        fmt::format("{}: the file names its primaries, and the rendering space "
                                    "'{}' has no matrix to reach it by; name a space",
                                    what, m_state->renderingSpace));
    return finished(
        guarded(what, [&] { return matrixConversion(multiply(*fromXyz, *space.toXyz)); }));
}

}  // namespace pm::host
