// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/app/listings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace pm::host {
namespace {

std::optional<PmrSettingInfo> findSetting(const PmrApi& api, const std::string& name) {
    for (uint32_t i = 0; i < api.settingCount(); ++i) {
        auto info = PMR_INIT(PmrSettingInfo);
        if (api.settingInfo(i, &info) == PMR_OK && name == info.name) return info;
    }
    return std::nullopt;
}

std::string rangeText(const PmrSettingInfo& info) {
    if (info.type == PMR_SETTING_CHOICE) return info.choices;
    if (info.type == PMR_SETTING_TEXT) return "text";
    constexpr double kNoEnd = 9e18;  // of 64-bit numbers
    if (info.maximum > kNoEnd) return fmt::format("{} or more", info.minimum);
    return fmt::format("{} to {}", info.minimum, info.maximum);
}

std::string parameterRange(const PmrParameterInfo& info) {
    if (info.type == PMR_PARAMETER_TEXT) return "text";
    if (info.type == PMR_PARAMETER_TEXTURE) return "texture; default none";
    if (info.type == PMR_PARAMETER_OBJECTS) return "handles";
    std::string range =
        fmt::format("{}{:g} to {}{:g}", info.excludesMinimum != 0 ? "above " : "", info.minimum,
                    info.excludesMaximum != 0 ? "below " : "", info.maximum);
    if (std::isinf(info.maximum))
        range = fmt::format("{}{:g}{}", info.excludesMinimum != 0 ? "above " : "", info.minimum,
                            info.excludesMinimum != 0 ? "" : " or more");
    if (std::isinf(info.minimum)) range = "finite";
    if (info.type == PMR_PARAMETER_CHOICE) range = info.choices;
    if (info.type == PMR_PARAMETER_INTEGER) range = "integer, " + range;
    if (info.count > 1) range = fmt::format("{} numbers, {}", info.count, range);
    if (*info.unit != '\0') range += fmt::format(" {}", info.unit);
    return fmt::format("{}; default {}", range, info.defaultText);
}

}  // namespace

std::string listViews(const ColourPipeline& colour) {
    std::string text;
    for (const ViewEntry& entry : colour.listViews()) {
        text += fmt::format("{}: {}{}\n", entry.display, entry.view,
                            entry.isDefault ? " (default)" : "");
    }
    return text;
}

std::string listLooks(const ColourPipeline& colour) {
    std::string text;
    for (const LookEntry& entry : colour.listLooks()) {
        text += entry.name;
        if (!entry.description.empty()) text += ": " + entry.description;
        text += "\n";
    }
    return text;
}

std::string listSpaces(const ColourPipeline& colour) {
    std::string text;
    for (const SpaceEntry& entry : colour.listSpaces()) {
        text += entry.name;
        for (const std::string& alias : entry.aliases) text += ", " + alias;
        if (entry.isData) text += " (data)";
        if (entry.isRenderingSpace) text += " (rendering space)";
        if (!entry.isRenderingSpace && entry.canRender) text += " (can be the rendering space)";
        if (entry.isBuiltIn) text += " (built in)";
        text += "\n";
    }
    return text;
}

std::string listLayers(const PmrApi& api) {
    std::string text;
    for (uint32_t i = 0; i < api.layerCount(); ++i) {
        auto info = PMR_INIT(PmrLayerInfo);
        if (api.layerInfo(i, &info) != PMR_OK) continue;
        text += fmt::format("{}: {}{} [{}]\n", info.name, info.help,
                            info.isDefault != 0 ? " (always written)" : "", info.channels);
    }
    return text;
}

std::string listSettings(const PmrApi& api) {
    std::string text;
    for (uint32_t i = 0; i < api.settingCount(); ++i) {
        auto info = PMR_INIT(PmrSettingInfo);
        if (api.settingInfo(i, &info) != PMR_OK) continue;
        const std::string unit = *info.unit != '\0' ? fmt::format(" {}", info.unit) : "";
        text +=
            fmt::format("{}: {} [{}{}; default {}] {}\n", info.name, info.help, rangeText(info),
                        unit, *info.defaultText != '\0' ? info.defaultText : "empty", info.cost);
    }
    return text;
}

std::string listOrders(const PmrApi& api) {
    const auto info = findSetting(api, "bucketOrder");
    std::string text = info ? info->choices : "";
    std::ranges::replace(text, ',', '\n');
    return text + "\n";
}

std::string listParameters(const PmrApi& api) {
    std::string text;
    for (int32_t object = 0; const char* name = api.objectName(object); ++object) {
        for (uint32_t i = 0; i < api.parameterCount(object); ++i) {
            auto info = PMR_INIT(PmrParameterInfo);
            if (api.parameterInfo(object, i, &info) != PMR_OK) continue;
            text +=
                fmt::format("{}.{}: {} [{}]\n", name, info.name, info.help, parameterRange(info));
        }
    }
    return text;
}

std::string settingHelp(const PmrApi& api, const std::string& name) {
    const auto info = findSetting(api, name);
    if (!info) return {};
    std::string text = info->help;
    if (info->type == PMR_SETTING_CHOICE)
        text += fmt::format(" One of {}.", info->choices);
    else if (info->type != PMR_SETTING_TEXT)
        text += fmt::format(" Allowed: {}.", rangeText(*info));
    if (*info->defaultText != '\0') text += fmt::format(" ({})", info->defaultText);
    return std::string_view(info->cost) == "None." ? text : text + " " + info->cost;
}

}  // namespace pm::host
