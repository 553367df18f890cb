// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <algorithm>
#include <nlohmann/json.hpp>

#include "host_shim/formats/json/json_reader.h"
#include "host_shim/formats/sidecar/sidecar.h"
#include "host_shim/formats/sidecar/sidecar_parts.h"

namespace pm::host {
namespace {

using nlohmann::ordered_json;

ordered_json describe(const CameraData& camera) {
    ordered_json json;
    json["name"] = camera.name;
    json["position"] = camera.eye.value();
    if (camera.lookAt) json["lookAt"] = *camera.lookAt;
    if (camera.up) json["up"] = *camera.up;
    if (camera.verticalFovDegrees) json["fieldOfView"] = *camera.verticalFovDegrees;
    return json;
}

// Indented, but for lists of numbers, which stand in a line.
void write(const ordered_json& value, std::size_t indent, std::string& text) {
    const bool isRow = value.is_array() && std::ranges::all_of(value, [](const auto& entry) {
                           return !entry.is_structured();
                       });
    if (!value.is_structured() || value.empty()) {
        text += value.dump();
        return;
    }
    const auto lineAt = [](std::size_t column) { return std::string("\n").append(column, ' '); };
    const std::string line = isRow ? "" : lineAt(indent + 4);
    text += value.is_array() ? '[' : '{';
    bool isFirst = true;
    for (const auto& [key, entry] : value.items()) {
        if (!isFirst) text += isRow ? ", " : ",";
        isFirst = false;
        text += line;
        if (value.is_object()) text += ordered_json(key).dump() + ": ";
        write(entry, indent + 4, text);
    }
    if (!isRow) text += lineAt(indent);
    text += value.is_array() ? ']' : '}';
}

// Of a point light: no other kind is guessed.
ordered_json describe(const LightData& light) {
    ordered_json json;
    json["type"] = "point";
    json["name"] = light.name;
    json["position"] = {light.transform[3], light.transform[7], light.transform[11]};
    ordered_json& intensity = json["intensity"] = ordered_json::array();
    for (const float value : light.emission) intensity.push_back(static_cast<double>(value));
    if (light.isInRenderingSpace) json["colourSpace"] = "rendering";
    return json;
}

}  // namespace

std::string withGuess(std::string_view before, const SidecarGuess& guess) {
    ordered_json all;
    // It has been read, so memory is there for it.
    JsonBudget budget = JsonBudget::ofLimit("sidecar", 0);
    if (before.empty())
        all["schema"] = kSidecarSchema;
    else
        all = parseJson(before, budget, {});
    if (guess.light) all["lights"].push_back(describe(*guess.light));
    const bool hasCamera = all.contains("cameras") && !all["cameras"].empty();
    if (guess.camera && !hasCamera) all["cameras"].push_back(describe(*guess.camera));
    std::string text;
    write(all, 0, text);
    return text + "\n";
}

}  // namespace pm::host
