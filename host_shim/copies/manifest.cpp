// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/copies/manifest.h"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "host_shim/copies/sha256.h"
#include "host_shim/formats/json/json_reader.h"
#include "host_shim/process/interrupt.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "pm-pack/1";
constexpr const char* kAll = ".";
constexpr std::size_t kLongestPlace = 4096;
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 50;  // of a file
constexpr std::uint64_t kMostSum = std::uint64_t{1} << 60;    // of all; no sum of two overflows

Json optionJson(const std::optional<PackedOption>& option) {
    if (!option) return nullptr;
    return {{"text", option->text}, {"place", option->place}};
}

std::string placeOf(const Json& json) {
    const auto place = json.get<std::string>();
    if (!isPlace(place)) throw std::runtime_error(fmt::format("'{}' is no place", place));
    return place;
}

std::vector<std::string> placesOf(const Json& json, bool mayBeAll) {
    std::vector<std::string> places;
    for (const Json& place : json)
        places.push_back(mayBeAll && place == kAll ? std::string(kAll) : placeOf(place));
    return places;
}

PackedFile fileOf(const Json& json) {
    if (!json.at("bytes").is_number_unsigned())
        throw std::runtime_error("'bytes' is no whole number from 0 on");
    PackedFile file{placeOf(json.at("place")), json.at("bytes").get<std::uint64_t>(),
                    json.at("sha256").get<std::string>()};
    if (!isSha256(file.sha256))
        throw std::runtime_error(fmt::format("{}: '{}' is no SHA-256", file.place, file.sha256));
    if (file.bytes > kMostBytes)
        throw std::runtime_error(fmt::format("{}: {} bytes are too many", file.place, file.bytes));
    return file;
}

std::optional<PackedOption> optionOf(const Json& json) {
    if (json.is_null()) return std::nullopt;
    return PackedOption{json.at("text").get<std::string>(), placeOf(json.at("place"))};
}

// What is named is there, each place once.
void checkPlaces(const Manifest& manifest) {
    std::set<std::string> places;
    for (const PackedFile& file : manifest.files)
        if (!places.insert(file.place).second)
            throw std::runtime_error(fmt::format("'{}' is there twice", file.place));
    for (const std::string& place : places) {
        throwIfInterrupted();
        const auto below = places.lower_bound(place + "/");
        if (below != places.end() && below->starts_with(place + "/"))
            throw std::runtime_error(fmt::format("'{}' is a file and a folder", place));
    }
    const auto need = [&](const std::string& place) {
        if (!places.contains(place))
            throw std::runtime_error(fmt::format("'{}' is not among its files", place));
    };
    need(manifest.scene);
    if (manifest.ocio) need(manifest.ocio->place);
    if (manifest.environment) need(manifest.environment->place);
}

// A content has one size, and all of them a sum that is a number.
void checkSizes(const Manifest& manifest) {
    std::map<std::string_view, std::uint64_t> sizes;
    std::uint64_t sum = 0;
    for (const PackedFile& file : manifest.files) {
        const auto [known, isNew] = sizes.emplace(file.sha256, file.bytes);
        if (known->second != file.bytes)
            throw std::runtime_error(
                fmt::format("{}: {} bytes, and {} where the same content is "
                            "named before",
                            file.place, file.bytes, known->second));
        if (isNew) sum += file.bytes;
        if (sum > kMostSum)
            throw std::runtime_error(fmt::format("its files have more than {} bytes", kMostSum));
    }
}

Manifest manifestOf(const Json& json) {
    Manifest manifest;
    manifest.scene = placeOf(json.at("scene"));
    manifest.base = json.at("base").get<std::string>();
    manifest.folders = placesOf(json.at("folders"), false);
    manifest.searchPaths = placesOf(json.at("searchPaths"), true);
    manifest.ocio = optionOf(json.at("ocio"));
    manifest.environment = optionOf(json.at("environment"));
    for (const Json& file : json.at("files")) manifest.files.push_back(fileOf(file));
    checkPlaces(manifest);
    checkSizes(manifest);
    return manifest;
}

}  // namespace

std::uint64_t Manifest::bytes() const {
    std::set<std::string_view> counted;
    std::uint64_t sum = 0;
    for (const PackedFile& file : files)
        if (counted.insert(file.sha256).second) sum += file.bytes;
    return sum;
}

std::string Manifest::beginning() {
    return fmt::format("{{\"schema\":\"{}\"", kSchema);
}

std::string Manifest::toJson() const {
    Json json = {{"schema", kSchema},
                 {"scene", scene},
                 {"base", base},
                 {"folders", folders},
                 {"searchPaths", searchPaths},
                 {"ocio", optionJson(ocio)},
                 {"environment", optionJson(environment)}};
    json["files"] = Json::array();
    for (const PackedFile& file : files)
        json["files"].push_back(
            {{"place", file.place}, {"bytes", file.bytes}, {"sha256", file.sha256}});
    return json.dump(1) + "\n";
}

Manifest Manifest::fromJson(std::string_view text, const std::string& where,
                            std::uint64_t memoryLimit) {
    JsonBudget budget(where, text.size(), memoryLimit);
    if (memoryLimit > 0) budget.take(text.size());
    const Json json = parseJson(text, budget, throwIfInterrupted);
    if (!json.is_object() || json.value("schema", Json()) != kSchema)
        throw HostError(ExitCode::kBadInput,
                        fmt::format("{}: is no packed scene, schema {}; pm_host pack makes one",
                                    where, kSchema));
    try {
        return manifestOf(json);
    } catch (const Interrupted&) {
        throw;
    } catch (const std::exception& fault) {
        throw HostError(ExitCode::kBadInput,
                        fmt::format("{}: can't be understood: {}", where, fault.what()));
    }
}

std::string objectPath(const std::string& sha256) {
    return "objects/" + sha256.substr(0, 2) + "/" + sha256;
}

bool isPlace(std::string_view text) {
    if (text.empty() || text.size() > kLongestPlace || text.find('\0') != text.npos) return false;
    for (;;) {
        const std::size_t end = text.find('/');
        const std::string_view part = text.substr(0, end);
        if (part.empty() || part == "." || part == "..") return false;
        if (end == text.npos) return true;
        text.remove_prefix(end + 1);
    }
}

}  // namespace pm::host
