// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/storage/piece_head.h"

#include <array>
#include <limits>

#include "plugin/values/call_error.h"
#include "plugin/values/json.h"

namespace pm::plugin {

namespace {

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
    throw CallError(CallStatus::kFile, "of a kind that is not known here");
}

std::uint32_t numberOf(const Json& json, const char* key) {
    const std::uint64_t number = json.at(key).number();
    if (number > std::numeric_limits<std::uint32_t>::max())
        throw CallError(CallStatus::kFile, "its head can't be understood");
    return static_cast<std::uint32_t>(number);
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
    if (!processorVendor.empty()) json["processorVendor"] = processorVendor;
    if (!photonHash.empty()) json["photonHash"] = photonHash;
    return json.dump();
}

PieceHead PieceHead::fromJson(std::span<const std::byte> text) {
    const Json json = Json::parse(text);
    if (json.at("schema").text() != kSchema)
        throw CallError(CallStatus::kFile, "of another version than " + std::string(kSchema));
    PieceHead head;
    head.kind = kindOf(json.at("kind").text());
    if (const Json* vendor = json.find("processorVendor")) head.processorVendor = vendor->text();
    if (const Json* hash = json.find("photonHash")) head.photonHash = hash->text();
    for (const Json& part : json.at("identity").elements())
        head.identity.push_back({part.elementAt(0).text(), part.elementAt(1).text()});
    head.sceneHash = json.at("sceneHash").text();
    head.settingsHash = json.at("settingsHash").text();
    head.isa = json.at("isa").text();
    for (const Json& setting : json.at("settings").elements())
        head.settings.emplace_back(setting.elementAt(0).text(), setting.elementAt(1).text());
    head.passes = numberOf(json, "passes");
    head.sharesNoise = json.at("sharesNoise").truth();
    head.bucketCount = numberOf(json, "bucketCount");
    head.range.first = numberOf(json, "firstBucket");
    head.range.last = numberOf(json, "lastBucket");
    return head;
}

}  // namespace pm::plugin
