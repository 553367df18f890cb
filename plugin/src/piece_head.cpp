// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/src/piece_head.h"

#include <array>
#include <nlohmann/json.hpp>

#include "plugin/src/call_error.h"

namespace pm::plugin {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "pm-piece/1";

// In the order of PieceKind.
struct KindText {
    const char* inFile;
    const char* forPeople;
};
constexpr std::array<KindText, 3> kKinds = {
    {{"checkpoint", "a checkpoint"}, {"part", "a part of a picture"}, {"photons", "a photon map"}}};

const KindText& textOf(PieceKind kind) {
    return kKinds.at(static_cast<std::size_t>(kind));
}

PieceKind kindOf(const std::string& text) {
    for (std::size_t i = 0; i < kKinds.size(); ++i)
        if (text == kKinds[i].inFile) return static_cast<PieceKind>(i);
    throw CallError(PMR_ERROR_FILE, "of a kind that is not known here");
}

bool isKept(const SettingSpec& spec, PieceKind kind) {
    switch (spec.id) {
        case Setting::kHostNote:
            return kind == PieceKind::kPart;
        case Setting::kCrop:
        case Setting::kLayers:
        case Setting::kHostIdentity:
            return true;
        case Setting::kPasses:
            return false;  // PieceHead::passes
        default:
            return spec.changesPixels;
    }
}

Json pairsJson(const auto& pairs) {
    Json json = Json::array();
    for (const auto& [name, value] : pairs) json.push_back({name, value});
    return json;
}

}  // namespace

const char* kindName(PieceKind kind) {
    return textOf(kind).forPeople;
}

std::string PieceHead::toJson() const {
    Json json = {{"schema", kSchema},
                 {"kind", textOf(kind).inFile},
                 {"identity", pairsJson(identity)},
                 {"sceneHash", sceneHash},
                 {"settingsHash", settingsHash},
                 {"isa", isa},
                 {"settings", pairsJson(settings)},
                 {"passes", passes},
                 {"sharesNoise", sharesNoise},
                 {"bucketCount", bucketCount},
                 {"firstBucket", range.first},
                 {"lastBucket", range.last}};
    if (!photonHash.empty()) json["photonHash"] = photonHash;
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

PieceHead PieceHead::fromJson(std::span<const std::byte> text) {
    const auto* first = reinterpret_cast<const char*>(text.data());
    try {
        const Json json = Json::parse(first, first + text.size());
        if (json.at("schema") != kSchema)
            throw CallError(PMR_ERROR_FILE, "of another version than " + std::string(kSchema));
        PieceHead head;
        head.kind = kindOf(json.at("kind").get<std::string>());
        head.photonHash = json.value("photonHash", std::string());
        for (const Json& part : json.at("identity"))
            head.identity.push_back({part.at(0).get<std::string>(), part.at(1).get<std::string>()});
        json.at("sceneHash").get_to(head.sceneHash);
        json.at("settingsHash").get_to(head.settingsHash);
        json.at("isa").get_to(head.isa);
        for (const Json& setting : json.at("settings"))
            head.settings.emplace_back(setting.at(0).get<std::string>(),
                                       setting.at(1).get<std::string>());
        json.at("passes").get_to(head.passes);
        json.at("sharesNoise").get_to(head.sharesNoise);
        json.at("bucketCount").get_to(head.bucketCount);
        json.at("firstBucket").get_to(head.range.first);
        json.at("lastBucket").get_to(head.range.last);
        return head;
    } catch (const nlohmann::json::exception&) {
        throw CallError(PMR_ERROR_FILE, "its head can't be understood");
    }
}

PieceHead makePieceHead(PieceKind kind, const Identity& scene, const SettingValues& values) {
    PieceHead head;
    head.kind = kind;
    const Identity settings = settingsIdentity(values);
    head.sceneHash = identityHash(scene);
    head.settingsHash = identityHash(settings);
    for (const Identity& part : {buildIdentity(), scene, settings, frameIdentity(values)})
        head.identity.insert(head.identity.end(), part.begin(), part.end());
    for (const IdentityPart& part : scene)
        if (part.name == "instruction set") head.isa = part.value;
    for (const SettingSpec& spec : settingSpecs())
        if (isKept(spec, kind)) head.settings.emplace_back(spec.name, values.text(spec.id));
    return head;
}

}  // namespace pm::plugin
