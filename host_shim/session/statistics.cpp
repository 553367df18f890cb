// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/session/statistics.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host_shim/pictures/compare.h"
#include "host_shim/process/plain_text.h"

namespace pm::host {
namespace {

using Json = nlohmann::ordered_json;

Json parsed(const std::string& text) {
    Json json = Json::parse(text, nullptr, false);
    return json.is_object() ? json : Json::object();
}

std::string hostName() {
    std::array<char, 256> name{};
    return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

constexpr int kFirstHostCode = 1000;

// Adds what the host knows to what the plugin said; objects are joined, lists appended to.
void join(const Json& more, Json& json) {
    for (const auto& [key, value] : more.items()) {
        if (json.contains(key) && json[key].is_object() && value.is_object()) {
            join(value, json[key]);
        } else if (json.contains(key) && json[key].is_array() && value.is_array()) {
            json[key].insert(json[key].end(), value.begin(), value.end());
        } else {
            json[key] = value;
        }
    }
}

// The plugin's warnings as it counted them, and the host's own; without a render all that were
// heard.
Json warningList(const Log& log, const Json& library) {
    const auto counted = library.find("warnings");
    const bool hasLibrary = counted != library.end() && counted->is_array();
    Json list = hasLibrary ? *counted : Json::array();
    for (const auto& [code, warning] : log.warnings()) {
        if (hasLibrary && code < kFirstHostCode) continue;
        list.push_back({{"code", code}, {"count", warning.count}, {"texts", {warning.firstText}}});
    }
    return list;
}

// The library knows textures by their prepared files; people know them by their own.
Json namedTextures(const Json& hashes, const std::map<std::string, std::string>& files) {
    constexpr std::string_view kKind = "texture ";
    Json named = Json::object();
    for (const auto& [name, hash] : hashes.items()) {
        const auto found =
            name.starts_with(kKind) ? files.find(name.substr(kKind.size())) : files.end();
        named[found == files.end() ? name : std::string(kKind) + found->second] = hash;
    }
    return named;
}

}  // namespace

std::optional<double> Statistics::estimatedRelMse() const {
    const Json json = parsed(library);
    const auto found = json.find("relMseEstimate");
    if (found == json.end() || !found->is_number()) return std::nullopt;
    return found->get<double>();
}

std::optional<std::int32_t> Statistics::errorScaleStops() const {
    const Json json = parsed(library);
    const auto found = json.find("errorScaleStops");
    if (found == json.end() || !found->is_number_integer()) return std::nullopt;
    return found->get<std::int32_t>();
}

Statistics::BiasNote Statistics::estimatedBias() const {
    const Json json = parsed(library);
    const auto number = [&](const char* key) {
        const auto found = json.find(key);
        return found != json.end() && found->is_number() ? found->get<double>() : 0.0;
    };
    BiasNote note;
    note.most = std::max(0.0, number("relMseEstimateBias") +
                                  2 * number("relMseEstimateBiasStandardError")) +
                number("relMseEstimateCut");
    note.offset = errorOffset(errorScaleStops().value_or(0));
    note.isLowerBound = json.value("relMseEstimateIsLowerBound", Json()) == true;
    return note;
}

std::string Statistics::errorWords() const {
    if (seenError) return describe(*seenError);
    const auto relMse = estimatedRelMse();
    return relMse ? host::errorWords(*relMse) : "";
}

std::string Statistics::estimateDoubts() const {
    constexpr int kFewPasses = 4;
    const Json json = parsed(library);
    std::string doubts;
    const Json freedom = json.value("relMseEstimateDegreesOfFreedom", Json());
    const int passes = json.value("passesDone", kFewPasses);
    if (passes < kFewPasses && freedom.is_number())
        doubts =
            fmt::format("; of {} passes: {:.0f} degrees of freedom", passes, freedom.get<double>());
    const Json isLowerBound = json.value("relMseEstimateIsLowerBound", Json());
    if (isLowerBound.is_boolean() && isLowerBound.get<bool>())
        doubts += fmt::format(
            "; a lower bound: {:.2g} % of the pixels show light finer than the "
            "estimates' radii",
            100 * json.value("relMseEstimateUnresolvedShare", 0.0));
    return doubts;
}

std::string Statistics::libraryStopReason() const {
    return parsed(library).value("stopReason", "finished");
}

std::vector<std::string> Statistics::processorVendors() const {
    std::vector<std::string> vendors;
    for (const Json& vendor : parsed(library).value("processorVendors", Json::array()))
        if (vendor.is_string()) vendors.push_back(vendor.get<std::string>());
    return vendors;
}

std::string Statistics::photonMapText() const {
    const Json json = parsed(library);
    const Json map = json.value("photonMap", Json::object());
    const Json counters = json.value("counters", Json::object());
    return fmt::format("{} photons of {} passes, {:.1f} MB",
                       counters.value("photonsStoredGlobal", std::uint64_t{0}) +
                           counters.value("photonsStoredCaustic", std::uint64_t{0}),
                       map.value("passesHeld", 0u),
                       static_cast<double>(map.value("fileBytes", std::uint64_t{0})) / 1e6);
}

std::optional<BadSampleNote> Statistics::badSamples() const {
    const Json json = parsed(library);
    const auto bad = json.find("badSamples");
    if (bad == json.end()) return std::nullopt;
    BadSampleNote note;
    for (const auto& [kind, count] : bad->at("counts").items())
        note.text +=
            fmt::format("{}{} {}", note.text.empty() ? "" : ", ", count.get<std::uint64_t>(), kind);
    const Json& first = bad->at("first");
    note.x = first.at("x").get<std::int64_t>();
    note.y = first.at("y").get<std::int64_t>();
    note.text += fmt::format(
        "; the first is {} ({}) at pixel {},{}, pass {}, sample {}",
        first.at("fault").get<std::string>(), first.at("part").get<std::string>(), note.x, note.y,
        first.at("pass").get<std::uint64_t>(), first.at("sample").get<std::uint64_t>());
    return note;
}

std::string Statistics::toJson(const Log& log) const {
    Json all = parsed(library);
    if (all.contains("hashes")) all["hashes"] = namedTextures(all["hashes"], textureFiles);
    Json mine;
    mine["schema"] = "pm-stats/1";
    mine["commandLine"] = commandLine;
    mine["machine"] = hostName();
    mine["versions"] = {{"pm_host", PM_VERSION}, {"plugin", pluginVersion}};
    mine["pluginFile"] = pluginFile;
    mine["colour"] = {{"config", colourConfig}, {"renderingSpace", renderingSpace}};
    if (exposureStops) mine["colour"]["exposureStops"] = *exposureStops;
    mine["scene"] = scene;
    if (sameAsFrame) mine["sameAsFrame"] = *sameAsFrame;
    mine["materialFiles"] = Json::array();
    for (const MaterialFile& library : materialFiles)
        mine["materialFiles"].push_back(
            {{"file", library.file}, {"dialect", library.dialect}, {"reason", library.reason}});
    mine["outputs"] = outputs;
    mine["phases"] = phaseSeconds;
    mine["phases"]["elapsedSeconds"] = log.elapsedSeconds();
    mine["stopReason"] = stopReason;
    mine["error"] = error;
    if (const std::string words = errorWords(); !words.empty()) mine["errorWords"] = words;
    if (seenError)
        mine["errorCodes"] = {{"all", seenError->codes},
                              {"darkParts", seenError->darkCodes},
                              {"brightParts", seenError->brightCodes}};
    if (referenceRelMse) {
        mine["relMseReference"] = *referenceRelMse;
        mine["relMseReferenceErrorScaleStops"] = referenceErrorScale;
    }
    if (referenceCodes)
        mine["referenceCodes"] = {{"rms", referenceCodes->rms},
                                  {"mean", referenceCodes->mean},
                                  {"most", referenceCodes->most},
                                  {"visiblePixels", referenceCodes->visiblePixels}};
    mine["exitCode"] = exitCode;
    const Json warnings = warningList(log, all);
    join(mine, all);
    all["warnings"] = warnings;
    return plainJson(all.dump(2, ' ', false, Json::error_handler_t::replace)) + "\n";
}

}  // namespace pm::host
