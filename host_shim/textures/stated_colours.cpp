// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/textures/stated_colours.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <span>

#include "host_shim/colour/icc_profile.h"
#include "host_shim/textures/png_colour.h"
#include "host_shim/values/letter_case.h"

namespace pm::host {
namespace {

using Values = PictureLayout::Values;

// x,y of red, green, blue, white.
constexpr std::array kRec709{0.64f, 0.33f, 0.30f, 0.60f, 0.15f, 0.06f, 0.3127f, 0.3290f};

// 1/2.2, as PNG's five digits and those of programs that write fewer have it, stands for sRGB's
// curve (W3C, Portable Network Graphics, section 11.3.3.5).
TransferCurve curveOfGamma(double gamma) {
    constexpr double kSrgb = 0.45455, kTolerance = 0.005;
    return std::fabs(gamma - kSrgb) <= kTolerance ? kSrgbCurve : powerCurve(1 / gamma);
}

bool areRec709(const std::array<float, 8>& figures) {
    constexpr float kTolerance = 1.001e-3f;
    return std::ranges::equal(figures, kRec709,
                              [](float a, float b) { return std::fabs(a - b) <= kTolerance; });
}

void takeProfile(const OIIO::ImageSpec& spec, PictureStatement& statement) {
    statement.profile = spec.get_string_attribute("ICCProfile:profile_description");
    const OIIO::ParamValue* found = spec.find_attribute("ICCProfile");
    if (found == nullptr) return;
    if (statement.profile.empty()) statement.profile = "without a name";
    const std::span bytes(static_cast<const std::uint8_t*>(found->data()),
                          static_cast<std::size_t>(found->datasize()));
    const auto colours = readIccProfile(bytes);
    if (!colours) return;
    statement.curve = colours->curve;
    if (!colours->chromaticities) return;
    auto& figures = statement.chromaticities.emplace();
    std::ranges::transform(*colours->chromaticities, figures.begin(),
                           [](double figure) { return static_cast<float>(figure); });
}

void takePngChunks(const std::filesystem::path& file, PictureStatement& statement) {
    const PngColour colour = readPngColour(file);
    if (colour.profileName) {
        // A profile that libpng refuses.
        if (statement.profile.empty())
            statement.profile =
                colour.profileName->empty() ? "without a name" : *colour.profileName;
        return;
    }
    const bool hasGamma = colour.gamma && *colour.gamma > 0;
    if (!colour.isSrgb && !hasGamma && !colour.chromaticities) return;
    statement.curve = colour.isSrgb || !hasGamma ? kSrgbCurve : curveOfGamma(*colour.gamma);
    if (!colour.isSrgb) statement.chromaticities = colour.chromaticities;
}

// OpenImageIO's way to tell a gamma of other formats.
void takeGammaName(const std::string& name, PictureStatement& statement) {
    constexpr std::string_view kPrefix = "Gamma";
    if (!name.starts_with(kPrefix)) return;
    double gamma = 0;
    std::from_chars(name.data() + kPrefix.size(), name.data() + name.size(), gamma);
    if (gamma > 0 && std::isfinite(gamma)) statement.curve = curveOfGamma(1 / gamma);
}

void takeChromaticities(const OIIO::ImageSpec& spec, PictureStatement& statement) {
    const OIIO::ParamValue* found = spec.find_attribute("chromaticities");
    if (found == nullptr || found->type().basetype != OIIO::TypeDesc::FLOAT ||
        found->type().numelements() * found->type().aggregate != 8)
        return;
    std::array<float, 8> values{};
    std::memcpy(values.data(), found->data(), sizeof values);
    statement.chromaticities = values;
}

}  // namespace

PictureStatement statedColours(const std::string& format, const std::filesystem::path& file,
                               const OIIO::ImageSpec& spec, const PictureLayout& layout) {
    PictureStatement statement;
    const auto take = [&](const std::string& name) {
        if (!name.empty()) statement.spaces.push_back(name);
    };
    take(spec.get_string_attribute("colorInteropID"));
    const std::string guess = spec.get_string_attribute("oiio:ColorSpace");
    if (format != "png" && lowerCase(guess) != "linear" && lowerCase(guess) != "srgb") take(guess);
    takeProfile(spec, statement);
    if (format == "png")
        takePngChunks(file, statement);
    else if (!statement.curve)
        takeGammaName(guess, statement);
    if (format == "openexr") takeChromaticities(spec, statement);
    statement.isXyz = layout.values == Values::kXyz;
    const bool isGrey = layout.values == Values::kGrey;
    if (statement.curve && statement.chromaticities &&
        (isGrey || areRec709(*statement.chromaticities)))
        statement.chromaticities.reset();
    return statement;
}

}  // namespace pm::host
