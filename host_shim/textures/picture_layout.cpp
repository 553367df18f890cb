// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/textures/picture_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "host_shim/values/host_error.h"
#include "host_shim/values/letter_case.h"

namespace pm::host {
namespace {

using Values = PictureLayout::Values;

std::string afterLastDot(const std::string& text) {
    const auto dot = text.rfind('.');
    return dot == std::string::npos ? text : text.substr(dot + 1);
}

// The letter that a channel's last name stands for, 0 for others.
char letterOf(const std::string& name) {
    static const std::map<std::string, char> letters{
        {"r", 'r'},         {"red", 'r'},      {"g", 'g'},     {"green", 'g'}, {"b", 'b'},
        {"blue", 'b'},      {"a", 'a'},        {"alpha", 'a'}, {"y", 'y'},     {"l", 'y'},
        {"luminance", 'y'}, {"grey", 'y'},     {"gray", 'y'},  {"x", 'x'},     {"z", 'z'},
        {"i", 'y'},         {"intensity", 'y'}};
    const auto found = letters.find(lowerCase(afterLastDot(name)));
    return found == letters.end() ? '\0' : found->second;
}

// The channels of one layer of one part, by letter.
struct Layer {
    int part{};
    std::string name;  // empty: the picture itself
    std::map<char, int> channels;

    bool has(std::string_view letters) const {
        return std::ranges::all_of(letters, [&](char c) { return channels.contains(c); });
    }
    int at(char letter) const { return channels.at(letter); }
    bool isXyz() const { return has("xyz") && !has("r"); }
    bool isColour() const { return has("rgb") || has("y") || isXyz(); }
};

// A part's name counts as its layers' name where there are several parts.
std::vector<Layer> layersOf(const std::vector<OIIO::ImageSpec>& parts) {
    std::vector<Layer> layers;
    for (std::size_t part = 0; part < parts.size(); ++part) {
        const OIIO::ImageSpec& spec = parts[part];
        const std::string partName =
            parts.size() > 1 ? std::string(spec.get_string_attribute("oiio:subimagename"))
                             : std::string();
        for (int c = 0; c < static_cast<int>(spec.channelnames.size()); ++c) {
            const std::string& full = spec.channelnames[static_cast<std::size_t>(c)];
            const char letter = letterOf(full);
            const auto dot = full.rfind('.');
            std::string name = dot == std::string::npos ? partName : full.substr(0, dot);
            auto layer = std::ranges::find_if(layers, [&](const Layer& one) {
                return one.part == static_cast<int>(part) && one.name == name;
            });
            if (layer == layers.end())
                layer = layers.insert(layer, {static_cast<int>(part), std::move(name), {}});
            if (letter != '\0') layer->channels.emplace(letter, c);
        }
    }
    return layers;
}

// Smaller is better.
int rankOf(const Layer& layer) {
    static const std::vector<std::string> usual{"combined", "beauty", "rgba", "rgb",
                                                "color",    "colour", "c",    "composite",
                                                "image",    "master"};
    if (layer.name.empty()) return 0;
    const auto found = std::ranges::find(usual, lowerCase(afterLastDot(layer.name)));
    return found == usual.end() ? 100 : 1 + static_cast<int>(found - usual.begin());
}

std::string shownName(const Layer& layer) {
    return layer.name.empty() ? "without a name" : "'" + layer.name + "'";
}

std::string otherNames(const std::vector<Layer>& layers, const Layer& taken) {
    std::string names;
    for (const Layer& layer : layers)
        if (&layer != &taken && layer.isColour())
            names += (names.empty() ? "" : ", ") + shownName(layer);
    return names;
}

bool isBetter(const Layer& a, const Layer& b) {
    const auto key = [](const Layer& layer) {
        return std::tuple(!layer.isColour(), rankOf(layer), !layer.has("rgb"), layer.part);
    };
    return key(a) < key(b);
}

std::string channelList(const std::vector<OIIO::ImageSpec>& parts) {
    constexpr std::size_t kMost = 12;
    std::string names;
    std::size_t count = 0;
    for (const OIIO::ImageSpec& spec : parts)
        for (const std::string& name : spec.channelnames) {
            if (++count > kMost) return names + ", ...";
            names += (names.empty() ? "" : ", ") + name;
        }
    return names;
}

// Formats without names for channels: the first three, or one, and alpha where the format says so.
Layer unnamedLayer(const OIIO::ImageSpec& spec) {
    Layer layer;
    int found = 0;
    for (int c = 0; c < spec.nchannels && found < 3; ++c) {
        if (c == spec.alpha_channel) continue;
        layer.channels.emplace("rgb"[found++], c);
    }
    if (found == 1) layer.channels = {{'y', layer.at('r')}};
    if (spec.alpha_channel >= 0) layer.channels.emplace('a', spec.alpha_channel);
    return layer;
}

void takeColour(const Layer& layer, PictureLayout& layout) {
    if (layer.has("rgb")) {
        layout.values = Values::kColour;
        layout.channels = {layer.at('r'), layer.at('g'), layer.at('b')};
    } else if (layer.isXyz()) {
        layout.values = Values::kXyz;
        layout.channels = {layer.at('x'), layer.at('y'), layer.at('z')};
    } else if (layer.has("rg")) {
        layout.values = Values::kTwo;
        layout.channels = {layer.at('r'), layer.at('g')};
        layout.note = "has red and green only; blue is taken as 0";
    } else {
        const char letter = layer.has("y") ? 'y' : layer.channels.begin()->first;
        layout.values = Values::kGrey;
        layout.channels = {layer.at(letter)};
    }
    if (layer.has("a") && layout.channels[0] != layer.at('a')) layout.alpha = layer.at('a');
}

// The number that -imfchan asks for; nothing where that is left to the picture.
bool takeAsked(const Layer& layer, char channel, PictureLayout& layout) {
    const char letter = channel == 'm' ? 'a' : channel;
    if (channel == '\0' || channel == 'l') return false;
    if (!layer.has(std::string_view(&letter, 1))) {
        const bool isGrey = !layer.has("rgb") && layer.has("y");
        if (isGrey && letter != 'a' && letter != 'z') return false;
        layout.note = fmt::format("has no channel for -imfchan {}; what it has is taken", channel);
        return false;
    }
    layout.values = Values::kNumber;
    layout.channels = {layer.at(letter)};
    return true;
}

void takeNumber(const Layer& layer, TextureKind kind, char channel, PictureLayout& layout) {
    if (takeAsked(layer, channel, layout)) return;
    if (kind == TextureKind::kMask && channel != 'l' && layer.has("a")) {
        layout.values = Values::kNumber;
        layout.channels = {layer.at('a')};
        return;
    }
    const std::string note = layout.note;
    takeColour(layer, layout);
    layout.values = layout.values == Values::kColour ? Values::kLuminance : Values::kNumber;
    layout.channels.resize(layout.values == Values::kLuminance ? 3 : 1);
    layout.note = note;
}

}  // namespace

PictureLayout choosePictureLayout(const std::vector<OIIO::ImageSpec>& parts, TextureKind kind,
                                  char channel) {
    std::vector<Layer> layers = layersOf(parts);
    std::erase_if(layers, [](const Layer& layer) { return layer.channels.empty(); });
    auto best = std::ranges::min_element(layers, isBetter);
    const bool isLone = parts.size() == 1 && parts[0].nchannels <= 2;
    // Names that OpenImageIO made up say nothing.
    const bool hasNames = std::ranges::none_of(
        parts[0].channelnames, [](const std::string& name) { return name.starts_with("channel"); });
    const bool good = best != layers.end() && (best->isColour() || best->has("rg") ||
                                               (isLone && best->channels.size() <= 2));
    if (!good) {
        if (hasNames && !isLone)
            throw HostError(ExitCode::kBadInput,
                            fmt::format("has no channels R, G, B or Y in any layer; it has {}",
                                        channelList(parts)));
        layers = {unnamedLayer(parts[0])};
        best = layers.begin();
    }
    PictureLayout layout;
    layout.part = best->part;
    if (kind == TextureKind::kColour || kind == TextureKind::kVector)
        takeColour(*best, layout);
    else
        takeNumber(*best, kind, channel, layout);
    const std::string others = otherNames(layers, *best);
    if (!best->name.empty())
        layout.note += fmt::format("{}has layers; {} is taken{}", layout.note.empty() ? "" : "; ",
                                   shownName(*best),
                                   others.empty() ? "" : fmt::format(" (others: {})", others));
    return layout;
}

}  // namespace pm::host
