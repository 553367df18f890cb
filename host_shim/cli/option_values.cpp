// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/cli/option_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <system_error>
#include <vector>

#include "host_shim/formats/scene_url.h"
#include "host_shim/formats/text_lines.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

constexpr std::int64_t kLargestPixel = 1 << 24;
constexpr std::int64_t kLargestSize = 1 << 16;  // the largest frame of the plugin

struct Range {
    std::int64_t low, high;
};

[[noreturn]] void refuse(const std::string& option, std::string_view text,
                         const std::string& allowed) {
    throw HostError(ExitCode::kUsage, fmt::format("{} '{}': {}", option, text, allowed));
}

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    for (;;) {
        const auto end = text.find(separator);
        parts.push_back(trimmed(text.substr(0, end)));
        if (end == std::string_view::npos) return parts;
        text.remove_prefix(end + 1);
    }
}

template <std::size_t N>
std::array<std::int32_t, N> pixels(const std::string& option, std::string_view text, char separator,
                                   Range range, const std::string& allowed) {
    const auto parts = split(text, separator);
    std::array<std::int32_t, N> values{};
    if (parts.size() != N) refuse(option, text, allowed);
    for (std::size_t i = 0; i < N; ++i) {
        std::int64_t value = 0;
        if (!parseInteger(parts[i], value) || value < range.low || value > range.high) {
            refuse(option, text, allowed);
        }
        values[i] = static_cast<std::int32_t>(value);
    }
    return values;
}

// Where a %d or %0Nd begins and ends in name; npos when there is none.
struct Pattern {
    std::size_t begin{std::string::npos};
    std::size_t length{};
    std::size_t digits{};
};

bool isThere(const std::string& name) {
    std::error_code ignored;
    return !isSceneUrl(name) &&
           std::filesystem::exists(std::filesystem::symlink_status(name, ignored));
}

Pattern findPattern(const std::string& name) {
    const auto slash = isSceneUrl(name) ? std::string::npos : name.rfind('/');
    const auto file = slash == std::string::npos ? 0 : slash + 1;
    const auto hash = name.find('#', file);
    if (hash != std::string::npos) {
        const auto end = std::min(name.find_first_not_of('#', hash), name.size());
        return {hash, end - hash, end - hash};
    }
    for (auto percent = name.find('%', file); percent != std::string::npos;
         percent = name.find('%', percent + 1)) {
        auto end = percent + 1;
        while (end < name.size() && name[end] >= '0' && name[end] <= '9') ++end;
        if (end >= name.size() || name[end] != 'd') continue;
        // An address has bytes as "%20" and "%d0"; none of them is a control character.
        if (isSceneUrl(name) && (name[percent + 1] != '0' || end < percent + 3)) continue;
        std::int64_t digits = 0;
        parseInteger(std::string_view(name).substr(percent + 1, end - percent - 1), digits);
        return {percent, end + 1 - percent,
                static_cast<std::size_t>(std::clamp<std::int64_t>(digits, 0, 20))};
    }
    return {};
}

}  // namespace

double numberValue(const std::string& option, std::string_view text, double low, double high,
                   const std::string& orElse) {
    double value = 0;
    if (!parseNumber(text, value) || !(value >= low && value <= high)) {
        refuse(option, text, fmt::format("a number in [{}, {}]{} is wanted", low, high, orElse));
    }
    return value;
}

std::int64_t integerValue(const std::string& option, std::string_view text, std::int64_t low,
                          std::int64_t high) {
    std::int64_t value = 0;
    if (!parseInteger(text, value) || value < low || value > high) {
        refuse(option, text, fmt::format("a whole number in [{}, {}] is wanted", low, high));
    }
    return value;
}

std::array<double, 3> pointValue(const std::string& option, std::string_view text) {
    const auto parts = split(text, ',');
    std::array<double, 3> point{};
    bool good = parts.size() == 3;
    for (std::size_t i = 0; good && i < 3; ++i) {
        good = parseNumber(parts[i], point[i]) && std::abs(point[i]) <= 1e18;
    }
    if (!good)
        refuse(option, text, "x,y,z in scene units, within +-1e18, is wanted, such as 0,1,-2.5");
    return point;
}

std::array<double, 2> sunValue(const std::string& option, std::string_view text) {
    const auto parts = split(text, ',');
    std::array<double, 2> sun{};
    const bool good = parts.size() == 2 && parseNumber(parts[0], sun[0]) &&
                      parseNumber(parts[1], sun[1]) && std::abs(sun[0]) <= 360 && sun[1] > 0 &&
                      sun[1] <= 90;
    if (!good)
        refuse(option, text,
               "AZIMUTH,ELEVATION in degrees, within +-360 and (0, 90], is wanted, such as 135,40");
    return sun;
}

std::array<std::int32_t, 2> sizeValue(const std::string& option, std::string_view text) {
    return pixels<2>(option, text, 'x', {1, kLargestSize},
                     "WIDTHxHEIGHT in whole pixels from 1 to 65536 is wanted, such as 640x480");
}

std::array<std::int32_t, 2> pixelValue(const std::string& option, std::string_view text) {
    return pixels<2>(option, text, ',', {-kLargestPixel, kLargestPixel},
                     "X,Y in pixels is wanted, such as 12,40");
}

PixelRect cropValue(const std::string& option, std::string_view text) {
    const std::string allowed = "x0,y0,x1,y1 in pixels with x0 < x1 and y0 < y1 is wanted";
    const auto v = pixels<4>(option, text, ',', {-kLargestPixel, kLargestPixel}, allowed);
    const PixelRect crop{v[0], v[1], v[2], v[3]};
    if (crop.empty()) refuse(option, text, allowed);
    return crop;
}

std::string withFrame(const std::string& option, const std::string& name,
                      const FrameNumber& frame) {
    if (frame.isFilled) return name;
    std::string filled = name;
    for (Pattern pattern = findPattern(filled); pattern.begin != std::string::npos;
         pattern = findPattern(filled)) {
        if (!frame.number && isThere(name)) return name;
        if (!frame.number)
            refuse(option, name,
                   "a pattern for frame numbers needs --frame N (and there is no file of that very "
                   "name)");
        filled.replace(pattern.begin, pattern.length,
                       fmt::format("{:0{}}", *frame.number, pattern.digits));
    }
    return filled;
}

std::string withFrameOfInput(const std::string& option, const std::string& name,
                             const FrameNumber& frame) {
    return isThere(name) ? name : withFrame(option, name, frame);
}

}  // namespace pm::host
