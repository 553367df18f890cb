// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/check/reference_making.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <iterator>
#include <memory>
#include <utility>

#include "host_shim/pictures/display_compare.h"
#include "host_shim/pictures/finished_file.h"
#include "host_shim/pictures/picture_io.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

constexpr double kLeastPixelLimit = 7.0;
constexpr double kBeyondOwn = 1.5;  // of what the renders are apart
constexpr int kVisibleBeyondOwn = 2;
constexpr std::int64_t kPixelsOfOneVisible = 1000;

std::string bytesOf(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    if (!stream) throw HostError(ExitCode::kFile, fmt::format("{}: can't be read", file.string()));
    return bytes;
}

void checkFinite(const Picture& picture) {
    for (const Channel& channel : picture.channels)
        if (channel.isColour &&
            !std::ranges::all_of(channel.values, [](float value) { return std::isfinite(value); }))
            throw HostError(
                ExitCode::kBadInput,
                fmt::format("a reference can't be made: {} is not finite somewhere", channel.name));
}

std::vector<RegionSpread> regionsOf(const PixelRect& window, const std::vector<Picture>& pictures) {
    std::vector<RegionSpread> spreads;
    for (const std::int32_t side : kRegionSides) {
        std::vector<std::vector<double>> means;
        for (const Picture& picture : pictures)
            means.push_back(RegionGrid(window, side).means(beautyOf(picture)));
        spreads.push_back(spreadOf(window, side, means));
    }
    return spreads;
}

void addCodes(const std::vector<RenderedFiles>& renders, Reference& reference) {
    std::vector<DisplayPicture> pictures;
    for (const RenderedFiles& render : renders) pictures.push_back(readDisplayPicture(render.png));
    for (const std::int32_t side : kRegionSides) {
        std::vector<std::vector<double>> means;
        for (const DisplayPicture& picture : pictures)
            means.push_back(codeMeans(picture, reference.window, side));
        reference.codes.push_back(spreadOf(reference.window, side, means));
    }
    for (const DisplayPicture& picture : pictures)
        reference.visibleLimit = std::max(reference.visibleLimit,
                                          compareDisplay(pictures.front(), picture).visiblePixels);
    reference.visibleLimit =
        kVisibleBeyondOwn * reference.visibleLimit + reference.window.area() / kPixelsOfOneVisible;
}

std::string today() {
    return fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time(nullptr)));
}

std::string versionOf(const Picture& picture) {
    const auto found = picture.attributes.find("pm:version");
    const auto* text =
        found == picture.attributes.end() ? nullptr : std::get_if<std::string>(&found->second);
    return text == nullptr ? "" : *text;
}

}  // namespace

Reference makeReference(const std::vector<RenderedFiles>& renders, const fs::path& before,
                        const std::string& because) {
    std::vector<Picture> pictures;
    for (const RenderedFiles& render : renders) {
        pictures.push_back(readExr(render.exr));
        checkFinite(pictures.back());
    }
    Reference reference;
    if (fs::exists(before)) reference.reasons = readReference(before).reasons;
    reference.reasons.push_back({because, today(), versionOf(pictures.front())});
    reference.window = pictures.front().dataWindow;
    reference.regions = regionsOf(reference.window, pictures);
    reference.pixelLimit = kLeastPixelLimit;
    for (const Picture& picture : pictures)
        reference.pixelLimit =
            std::max(reference.pixelLimit,
                     kBeyondOwn * std::abs(furthestPixel(pictures.front(), picture).z));
    if (!renders.front().png.empty()) addCodes(renders, reference);
    return reference;
}

void storeReference(const RenderedFiles& kept, const Reference& reference,
                    const ReferenceFiles& files) {
    std::vector<std::pair<fs::path, std::string>> contents{{files.picture, bytesOf(kept.exr)},
                                                           {files.numbers, textOf(reference)}};
    if (!kept.png.empty()) contents.emplace_back(files.display, bytesOf(kept.png));
    // All or none: only what is on the disk as a whole takes the names.
    std::vector<std::unique_ptr<FinishedFile>> written;
    for (const auto& [file, bytes] : contents) {
        written.push_back(std::make_unique<FinishedFile>(file));
        written.back()->write(bytes);
    }
    for (const auto& file : written) file->commit();
}

}  // namespace pm::host
