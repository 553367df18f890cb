// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/check/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>

namespace pm::host {
namespace {

// Both pictures come to the same bits where these and the scene agree.
constexpr std::array<const char*, 4> kSameBuild{"pm:build", "pm:isa", "pm:settingsHash",
                                                "pm:passesDone"};
constexpr const char* kScene = "pm:sceneHash";
constexpr std::size_t kChangedRegions = 3;  // that are told
constexpr std::array<const char*, 4> kColourMetadata{"chromaticities", "colorInteropID",
                                                     "pm:renderingSpace", "pm:complete"};
constexpr std::array<const char*, 3> kErrorChannels{"stderr.X", "stderr.Y", "stderr.Z"};
constexpr double kStoredRounding = 1e-6;  // of the numbers beside the picture

std::string text(const AttributeValue& value) {
    if (const auto* list = std::get_if<std::vector<float>>(&value))
        return fmt::format("{:g}", fmt::join(*list, " "));
    if (const auto* words = std::get_if<std::string>(&value)) return "'" + *words + "'";
    if (const auto* number = std::get_if<float>(&value)) return fmt::format("{:g}", *number);
    return fmt::format("{}", std::get<std::int32_t>(value));
}

std::string attribute(const Picture& picture, const char* name) {
    const auto found = picture.attributes.find(name);
    return found == picture.attributes.end() ? "none" : text(found->second);
}

std::string text(const PixelRect& rect) {
    return fmt::format("{},{} to {},{}", rect.x0, rect.y0, rect.x1, rect.y1);
}

std::string channelList(const Picture& picture) {
    std::string list;
    for (const Channel& channel : picture.channels)
        list += (list.empty() ? "" : ", ") + channel.name;
    return list;
}

bool haveSame(const Picture& a, const Picture& b, const char* name) {
    const auto in = a.attributes.find(name);
    const auto other = b.attributes.find(name);
    return in != a.attributes.end() && other != b.attributes.end() && in->second == other->second;
}

struct Place {
    std::int32_t x{}, y{};
};
Place placeOf(const PixelRect& window, std::size_t pixel) {
    const auto width = static_cast<std::size_t>(window.width());
    return {window.x0 + static_cast<std::int32_t>(pixel % width),
            window.y0 + static_cast<std::int32_t>(pixel / width)};
}

void lookForBadValues(const Picture& picture, std::vector<Finding>& findings) {
    std::int64_t count = 0;
    std::string first;
    for (const Channel& channel : picture.channels) {
        if (!channel.isColour) continue;
        for (std::size_t i = 0; i < channel.values.size(); ++i) {
            if (std::isfinite(channel.values[i])) continue;
            const Place at = placeOf(picture.dataWindow, i);
            if (count++ == 0)
                first =
                    fmt::format("{} at {},{} is {}", channel.name, at.x, at.y, channel.values[i]);
        }
    }
    if (count > 0) findings.push_back({"not finite", fmt::format("{} values; {}", count, first)});
}

void compareShape(const Picture& stored, const Picture& picture, std::vector<Finding>& findings) {
    if (stored.width != picture.width || stored.height != picture.height)
        findings.push_back({"size", fmt::format("{}x{} in place of {}x{}", picture.width,
                                                picture.height, stored.width, stored.height)});
    else if (!(stored.dataWindow == picture.dataWindow))
        findings.push_back(
            {"data window", text(picture.dataWindow) + " in place of " + text(stored.dataWindow)});
    if (channelList(stored) != channelList(picture))
        findings.push_back({"channels", fmt::format("{} in place of {}", channelList(picture),
                                                    channelList(stored))});
    for (const char* name : kColourMetadata)
        if (attribute(stored, name) != attribute(picture, name))
            findings.push_back({"colour metadata",
                                fmt::format("{} is {} in place of {}", name,
                                            attribute(picture, name), attribute(stored, name))});
}

// The stored picture against the numbers beside it: whoever edits one edits both.
void compareWithNumbers(const Picture& stored, const Reference& reference,
                        std::vector<Finding>& findings) {
    if (!(stored.dataWindow == reference.window)) {
        findings.push_back({"reference", "its picture and its .json are of unlike windows"});
        return;
    }
    const Beauty beauty = beautyOf(stored);
    for (const RegionSpread& spread : reference.regions) {
        const auto means = RegionGrid(stored.dataWindow, spread.side).means(beauty);
        const RegionFinding found =
            mostChangedRegion(stored.dataWindow, spread.side, spread.stored, means);
        if (std::abs(found.relative) <= kStoredRounding) continue;  // false for NaN
        findings.push_back(
            {"reference",
             fmt::format("the stored picture was changed since it was made: {}", describe(found))});
        return;
    }
}

std::int64_t countUnlikeBits(const Picture& stored, const Picture& picture, std::string& first) {
    std::int64_t count = 0;
    for (std::size_t c = 0; c < picture.channels.size(); ++c) {
        const Channel &a = stored.channels[c], &b = picture.channels[c];
        for (std::size_t i = 0; i < a.values.size(); ++i) {
            if (std::memcmp(&a.values[i], &b.values[i], sizeof(float)) == 0) continue;
            const Place at = placeOf(picture.dataWindow, i);
            if (count++ == 0)
                first = fmt::format("{} at {},{} is {} in place of {}", b.name, at.x, at.y,
                                    b.values[i], a.values[i]);
        }
    }
    return count;
}

void compareBits(const Picture& stored, const Picture& picture, Verdict& verdict) {
    std::string first;
    const std::int64_t count = countUnlikeBits(stored, picture, first);
    verdict.hasSameBits = count == 0;
    if (!verdict.isSameBuild || count == 0) return;
    const RegionGrid grid(picture.dataWindow, kRegionSides[0]);
    const RegionFinding most =
        mostChangedRegion(picture.dataWindow, kRegionSides[0], grid.means(beautyOf(stored)),
                          grid.means(beautyOf(picture)));
    verdict.findings.push_back(
        {"bits", fmt::format("{} values differ, of the same build, instruction set, scene and "
                             "settings; {}; most in {}",
                             count, first, describe(most))});
}

// Another scene, told by its hash, is no noise.
void compareInput(const Picture& stored, const Picture& picture, Verdict& verdict) {
    if (!verdict.isSameBuildOfAnotherScene || verdict.hasSameBits) return;
    std::string regions;
    for (const std::int32_t side : kRegionSides) {
        const RegionGrid grid(picture.dataWindow, side);
        for (const RegionFinding& region :
             changedRegions(picture.dataWindow, side, grid.means(beautyOf(stored)),
                            grid.means(beautyOf(picture)), kChangedRegions))
            regions += (regions.empty() ? "" : "; ") + describe(region);
    }
    verdict.findings.push_back({"input", "the scene's input changed; " + regions});
}

// A render that shares the reference's noise may be off by what twins are.
void comparePairs(const Picture& stored, const Picture& picture, const Reference& reference,
                  const Picture* noise, Verdict& verdict) {
    if (!reference.pairs || noise == nullptr) return;
    verdict.correlation = noiseCorrelation(*noise, stored, picture);
    verdict.isPaired = verdict.correlation > kPairedCorrelation;
    if (!verdict.isPaired) verdict.seenChange = seenChange(reference.regions.front());
    if (!verdict.isPaired) return;
    const PixelRect& window = picture.dataWindow;
    const RegionGrid grid(window, kPairSide);
    const RegionFinding found =
        furthestOfPair(window, *reference.pairs, grid.means(beautyOf(picture)));
    verdict.shareOfLimit = std::max(verdict.shareOfLimit, std::abs(found.z) / kPairLimit);
    if (std::abs(found.z) <= kPairLimit) return;  // false for NaN
    verdict.findings.push_back(
        {"pair", fmt::format("{}, {:.1f} standard deviations of what rounding makes of the same "
                             "noise (limit {:g})",
                             describe(found), std::abs(found.z), kPairLimit)});
}

struct RegionMeasure {
    const char* name;
    std::string before{};  // what is told
    double floor{};        // what is no difference
};

// The regions that are furthest off, those of each side.
void compareRegions(const PixelRect& window, const std::vector<RegionSpread>& spreads,
                    const std::function<std::vector<double>(std::int32_t side)>& meansOf,
                    const RegionMeasure& measure, Verdict& verdict) {
    for (const RegionSpread& spread : spreads) {
        const RegionFinding found =
            furthestRegion(window, spread, meansOf(spread.side), measure.floor);
        verdict.shareOfLimit = std::max(verdict.shareOfLimit, std::abs(found.z) / spread.limit);
        if (!(std::abs(found.z) <= spread.limit))
            verdict.findings.push_back(
                {measure.name,
                 fmt::format("{}{}, {:.1f} standard errors (limit {:.1f})", measure.before,
                             describe(found), std::abs(found.z), spread.limit)});
    }
}

// Of each pixel the mean of squares over it and those that touch it.
std::vector<double> meanSquares(const Channel& channel, const PixelRect& window) {
    const std::int32_t width = window.width(), height = window.height();
    std::vector<double> result(channel.values.size());
    for (std::int32_t y = 0; y < height; ++y) {
        for (std::int32_t x = 0; x < width; ++x) {
            double sum = 0;
            int count = 0;
            for (std::int32_t v = std::max(0, y - 1); v <= std::min(height - 1, y + 1); ++v) {
                for (std::int32_t u = std::max(0, x - 1); u <= std::min(width - 1, x + 1); ++u) {
                    const double error = channel.values[static_cast<std::size_t>(v * width + u)];
                    sum += error * error;
                    ++count;
                }
            }
            const auto at = static_cast<std::size_t>(y * width + x);
            const double own = channel.values[at];
            result[at] = std::max(own * own, sum / count);
        }
    }
    return result;
}

}  // namespace

PixelFinding furthestPixel(const Picture& stored, const Picture& picture) {
    constexpr double kRounding = 1e-5;
    PixelFinding found;
    const Beauty a = beautyOf(stored), b = beautyOf(picture);
    for (std::size_t c = 0; c < 3; ++c) {
        const Channel *ea = stored.find(kErrorChannels[c]), *eb = picture.find(kErrorChannels[c]);
        if (ea == nullptr || eb == nullptr) return {};
        const auto va = meanSquares(*ea, a.window), vb = meanSquares(*eb, b.window);
        for (std::size_t i = 0; i < va.size(); ++i) {
            const double wanted = a.values[c][i], got = b.values[c][i];
            const double rounding = kRounding * std::max(std::abs(wanted), std::abs(got));
            if (wanted == got) continue;
            const double z = (got - wanted) / std::sqrt(va[i] + vb[i] + rounding * rounding);
            if (std::abs(z) <= std::abs(found.z)) continue;
            const Place at = placeOf(a.window, i);
            found = {at.x, at.y, static_cast<int>(c), z, a.values[c][i], b.values[c][i]};
        }
    }
    return found;
}

Verdict comparePictures(const Picture& stored, const Picture& picture, const Reference& reference,
                        const Picture* noise) {
    Verdict verdict;
    lookForBadValues(picture, verdict.findings);
    compareShape(stored, picture, verdict.findings);
    if (!verdict.findings.empty()) return verdict;
    const bool isBuild = std::ranges::all_of(
        kSameBuild, [&](const char* name) { return haveSame(stored, picture, name); });
    verdict.isSameBuild = isBuild && haveSame(stored, picture, kScene);
    verdict.isSameBuildOfAnotherScene = isBuild && !verdict.isSameBuild;
    compareWithNumbers(stored, reference, verdict.findings);
    if (!verdict.findings.empty()) return verdict;
    compareBits(stored, picture, verdict);
    const PixelRect& window = picture.dataWindow;
    verdict.seenChange = seenChange(reference);
    if (verdict.isSameBuild || verdict.hasSameBits) return verdict;
    compareInput(stored, picture, verdict);
    comparePairs(stored, picture, reference, noise, verdict);
    const Beauty beauty = beautyOf(picture);
    compareRegions(
        window, reference.regions,
        [&](std::int32_t side) { return RegionGrid(window, side).means(beauty); },
        RegionMeasure{"region"}, verdict);
    const PixelFinding pixel = furthestPixel(stored, picture);
    if (std::abs(pixel.z) > reference.pixelLimit)
        verdict.findings.push_back(
            {"pixel",
             fmt::format("{} at {},{} is {:.4g} in place of {:.4g}, {:.1f} standard errors "
                         "(limit {:.1f})",
                         "RGB"[pixel.channel], pixel.x, pixel.y, pixel.got, pixel.wanted,
                         std::abs(pixel.z), reference.pixelLimit)});
    return verdict;
}

std::vector<double> codeMeans(const DisplayPicture& picture, const PixelRect& window,
                              std::int32_t side) {
    constexpr float kFullCode = 255.0f;
    std::array<std::vector<float>, 3> planes;
    const DisplayPicture codes = asCodes(picture);
    for (std::size_t i = 0; i < codes.values.size(); ++i)
        planes[i % 3].push_back(codes.values[i] * kFullCode);
    return RegionGrid(window, side).means({window, {planes[0], planes[1], planes[2]}});
}

void compareCodes(const DisplayPicture& picture, const PixelRect& window, const DisplayNoise& noise,
                  double codeLimit, const std::string& view, Verdict& verdict) {
    compareRegions(
        window, noise.codes, [&](std::int32_t side) { return codeMeans(picture, window, side); },
        {"display codes", view, codeLimit}, verdict);
}

}  // namespace pm::host
