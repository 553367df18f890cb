// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/render/picture_assembly.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <future>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "host_shim/process/side_work.h"

namespace pm::host {
namespace {

constexpr const char* kColourConfig = "colour config: ";
constexpr const char* kColourSpace = "rendering space of the host: ";

std::string oneLine(std::string text) {
    std::ranges::replace(text, '\n', ';');
    return text;
}

const std::vector<float>& valuesOf(const Picture& picture, std::string_view name) {
    static const std::vector<float> kNone;
    const auto found = std::ranges::find(picture.channels, name, &Channel::name);
    return found == picture.channels.end() ? kNone : found->values;
}

std::vector<std::string> channelNames(std::string_view list) {
    std::vector<std::string> names;
    while (true) {
        const auto end = list.find(',');
        names.emplace_back(list.substr(0, end));
        if (end == std::string_view::npos) return names;
        list.remove_prefix(end + 1);
    }
}

void addChannels(const PmrLayerInfo& info, Picture& picture) {
    const auto names = channelNames(info.channels);
    for (std::size_t c = 0; c < names.size() && c < info.channelCount; ++c)
        picture.channels.push_back({names[c], info.kind == PMR_LAYER_COLOUR, {}});
}

// Fills the channels of a layer, from `channel` on.
void fillLayer(const PictureSource& source, const PmrLayerInfo& info, std::size_t channel,
               Picture& picture) {
    const PixelRect& window = picture.dataWindow;
    const PmrRectangle rectangle{window.x0, window.y0, window.x1, window.y1};
    const std::size_t stride = info.channelCount;
    const auto pixels = static_cast<std::size_t>(window.area());
    std::vector<float> values(pixels * stride);
    source.readPixels(rectangle, info.name, values.data());
    for (std::size_t c = 0; c < stride; ++c) {
        std::vector<float>& to = picture.channels.at(channel + c).values;
        to.resize(pixels);
        for (std::size_t i = 0; i < pixels; ++i) to[i] = values[i * stride + c];
    }
}

// Settings that change no pixel are left out: the same picture gives the same bytes.
void addSettings(const PictureSource& source, Picture& picture) {
    for (uint32_t i = 0; i < source.api().settingCount(); ++i) {
        auto info = PMR_INIT(PmrSettingInfo);
        if (source.api().settingInfo(i, &info) != PMR_OK || info.changesPixels == 0) continue;
        picture.attributes[fmt::format("pm:{}", info.name)] = source.settingText(info.name);
    }
}

// What was really done, and checksums by which a later run tells whether it may go on with it.
void addStatistics(const PictureSource& source, Picture& picture) {
    const auto json = nlohmann::json::parse(source.statistics(), nullptr, false);
    if (!json.is_object()) return;
    if (const auto isa = json.find("isa"); isa != json.end() && isa->is_string())
        picture.attributes["pm:isa"] = isa->get<std::string>();
    // By it another picture can be held to the same bits.
    if (const auto versions = json.find("versions"); versions != json.end())
        if (const std::string build = versions->value("buildId", ""); !build.empty())
            picture.attributes["pm:build"] = build;
    if (const auto done = json.find("passesDone");
        done != json.end() && done->is_number_integer()) {
        picture.attributes["pm:passesDone"] = done->dump();
        // Where a target ended the render, the setting that repeats it.
        const std::string reason = json.value("stopReason", "");
        if (reason == "error target" || reason == "time limit")
            picture.attributes["pm:passes"] = done->dump();
    }
    // As a number, by which values are to be compared: of auto what was found.
    if (const auto scale = json.find("errorScaleStops");
        scale != json.end() && scale->is_number_integer())
        picture.attributes["pm:errorScale"] = scale->get<std::int32_t>();
    const auto hashes = json.find("hashes");
    if (hashes == json.end()) return;
    for (const auto& [name, value] : hashes->items())
        if (value.is_string())
            picture.attributes[fmt::format("pm:{}Hash", name)] = value.get<std::string>();
}

}  // namespace

Picture assemblePicture(const PictureSource& source, const Options& options,
                        const ColourPipeline& colour, bool complete) {
    Picture picture = assembleHead(source, options, colour, complete);
    std::size_t channel = 0;
    std::vector<std::future<void>> filled;
    for (std::uint32_t i = 0; i < source.layerCount(); ++i) {
        const PmrLayerInfo info = source.layerInfo(i);
        filled.push_back(doBeside(options.threads != 1, [&source, &picture, info, channel] {
            fillLayer(source, info, channel, picture);
        }));
        channel += info.channelCount;
    }
    for (std::future<void>& one : filled) one.get();
    return picture;
}

Picture assembleHead(const PictureSource& source, const Options& options,
                     const ColourPipeline& colour, bool complete) {
    Picture picture;
    picture.width = options.width;
    picture.height = options.height;
    picture.dataWindow = dataWindowOf(options);
    for (std::uint32_t i = 0; i < source.layerCount(); ++i)
        addChannels(source.layerInfo(i), picture);
    if (const auto chromaticities = colour.chromaticities()) {
        picture.attributes["chromaticities"] =
            std::vector<float>(chromaticities->begin(), chromaticities->end());
    }
    if (!colour.colorInteropId().empty()) {
        picture.attributes["colorInteropID"] = colour.colorInteropId();
    }
    addSettings(source, picture);
    addStatistics(source, picture);
    picture.attributes["pm:complete"] = std::int32_t{complete ? 1 : 0};
    picture.attributes["pm:version"] = std::string(source.api().versionText());
    picture.attributes["pm:renderingSpace"] = colour.renderingSpace();
    picture.attributes["pm:ocioCacheId"] = colour.cacheId();
    return picture;
}

std::string colourIdentity(const ColourPipeline& colour) {
    return fmt::format("{}{}\n{}{}", kColourConfig, colour.cacheId(), kColourSpace,
                       colour.renderingSpace());
}

ColourPipeline colourOfParts(const std::string& identity, ColourOptions options) {
    const std::size_t space = identity.find(kColourSpace);
    if (options.renderingSpace.empty() && space != std::string::npos)
        options.renderingSpace = identity.substr(space + std::string_view(kColourSpace).size());
    ColourPipeline colour(options);
    if (const std::string ours = colourIdentity(colour); ours != identity)
        throw HostError(
            ExitCode::kBadInput,
            fmt::format("merge: the parts were rendered with [{}], this is [{}]; give their --ocio "
                        "and --rendering-space",
                        oneLine(identity), oneLine(ours)));
    return colour;
}

PixelRect dataWindowOf(const Options& options) {
    return options.crop.value_or(PixelRect{0, 0, options.width, options.height});
}

const std::string* renderingSpaceOf(const Picture& picture) {
    const auto found = picture.attributes.find("pm:renderingSpace");
    return found == picture.attributes.end() ? nullptr : std::get_if<std::string>(&found->second);
}

bool isBlackThoughHit(const Picture& picture) {
    const auto &r = valuesOf(picture, "R"), &g = valuesOf(picture, "G"),
               &b = valuesOf(picture, "B"), &a = valuesOf(picture, "A");
    if (r.size() != a.size() || g.size() != a.size() || b.size() != a.size()) return false;
    std::size_t covered = 0, lit = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (!(a[i] > 0.0f)) continue;
        ++covered;
        if (r[i] != 0.0f || g[i] != 0.0f || b[i] != 0.0f) ++lit;
    }
    return covered > 0 && 100 * lit <= covered;
}

double emptyShare(const Picture& picture) {
    const std::vector<float>& coverage = valuesOf(picture, "A");
    const auto empty = std::ranges::count_if(coverage, [](float a) { return !(a > 0.0f); });
    return coverage.empty() ? 0 : static_cast<double>(empty) / static_cast<double>(coverage.size());
}

}  // namespace pm::host
