// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/colour/picture_compare.h"

#include <fmt/format.h>

#include <cmath>

#include "host_shim/pictures/picture_io.h"

namespace pm::host::test {
namespace {

using Result = testing::AssertionResult;

Result allFinite(const Picture& picture, const char* which) {
    std::string text;
    for (const Channel& channel : picture.channels) {
        std::size_t bad = 0;
        for (const float value : channel.values) bad += std::isfinite(value) ? 0u : 1u;
        if (bad > 0) text += fmt::format(" {} in {}", bad, channel.name);
    }
    if (text.empty()) return testing::AssertionSuccess();
    return testing::AssertionFailure() << "NaN or infinity in the " << which << ":" << text;
}

std::string windows(const Picture& picture) {
    const PixelRect& d = picture.dataWindow;
    return fmt::format("{} x {} with data {},{},{},{}", picture.width, picture.height, d.x0, d.y0,
                       d.x1, d.y1);
}

std::set<std::string> channelNames(const Picture& picture) {
    std::set<std::string> names;
    for (const Channel& channel : picture.channels) names.insert(channel.name);
    return names;
}

std::string joined(const std::set<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += " " + name;
    return text;
}

Result sameAttributes(const Picture& golden, const Picture& picture,
                      const std::set<std::string>& free) {
    std::set<std::string> names;
    for (const auto& [name, value] : golden.attributes) names.insert(name);
    for (const auto& [name, value] : picture.attributes) names.insert(name);
    for (const std::string& name : names) {
        if (free.contains(name)) continue;
        const auto g = golden.attributes.find(name), p = picture.attributes.find(name);
        const bool both = g != golden.attributes.end() && p != picture.attributes.end();
        if (both && g->second == p->second) continue;
        return testing::AssertionFailure()
               << "attribute " << name << (both ? " differs" : " is in one of the two only");
    }
    return testing::AssertionSuccess();
}

double variance(const Picture* errors, const std::string& channel, std::size_t pixel) {
    const Channel* found = errors != nullptr ? errors->find(channel) : nullptr;
    if (found == nullptr || pixel >= found->values.size()) return 0.0;
    return static_cast<double>(found->values[pixel]) * static_cast<double>(found->values[pixel]);
}

Result sameValues(const Channel& golden, const Channel& picture, const PixelRect& window,
                  const PictureTolerance& tolerance) {
    std::size_t worst = 0, count = 0;
    double worstExcess = 0.0;
    for (std::size_t i = 0; i < golden.values.size(); ++i) {
        const double g = golden.values[i], p = picture.values[i];
        const double spread = std::sqrt(variance(tolerance.goldenErrors, golden.name, i) +
                                        variance(tolerance.pictureErrors, golden.name, i));
        const double excess = std::fabs(g - p) - tolerance.absolute -
                              tolerance.relative * std::fabs(g) - tolerance.sigmas * spread;
        if (!(excess > 0.0)) continue;
        ++count;
        if (excess > worstExcess) {
            worstExcess = excess;
            worst = i;
        }
    }
    if (count == 0) return testing::AssertionSuccess();
    const auto width = static_cast<std::size_t>(window.width());
    return testing::AssertionFailure() << fmt::format(
               "{} pixels of {} are too far off; the worst at {},{} of the data window: {} instead "
               "of {}",
               count, golden.name, worst % width, worst / width, picture.values[worst],
               golden.values[worst]);
}

}  // namespace

Result samePicture(const Picture& golden, const Picture& picture,
                   const PictureTolerance& tolerance) {
    clearColourEnvironment();
    if (Result finite = allFinite(golden, "golden picture"); !finite) return finite;
    if (Result finite = allFinite(picture, "picture"); !finite) return finite;
    if (windows(golden) != windows(picture)) {
        return testing::AssertionFailure()
               << "the golden picture is " << windows(golden) << ", the other " << windows(picture);
    }
    if (channelNames(golden) != channelNames(picture)) {
        return testing::AssertionFailure()
               << "the golden picture has channels" << joined(channelNames(golden)) << ", the other"
               << joined(channelNames(picture));
    }
    if (Result same = sameAttributes(golden, picture, tolerance.freeAttributes); !same) return same;
    for (const Channel& channel : golden.channels) {
        Result same =
            sameValues(channel, *picture.find(channel.name), golden.dataWindow, tolerance);
        if (!same) return same;
    }
    return testing::AssertionSuccess();
}

Result sameExr(const std::string& golden, const std::string& picture,
               const PictureTolerance& tolerance) {
    clearColourEnvironment();
    return samePicture(readExr(golden), readExr(picture), tolerance);
}

}  // namespace pm::host::test
