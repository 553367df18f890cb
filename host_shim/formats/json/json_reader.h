// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "host_shim/formats/json/json_budget.h"
#include "host_shim/values/go_on.h"

namespace pm::host {

// All JSON that comes from outside is read here: in time that grows as the text does, within a
// budget of memory, and asking goOn for every 64 KiB. Errors of all: HostError kBadInput, "FILE:
// what is wrong", for what is no JSON, a key that is there twice, and more than 16 lists and
// objects within each other; those of JsonBudget; what goOn throws.

nlohmann::ordered_json parseJson(std::string_view text, JsonBudget& budget, const GoOn& goOn);

// The same within the budget of its size; file: for messages.
nlohmann::ordered_json parseJson(std::string_view text, const std::string& file, const GoOn& goOn);

// A file, within the budget of its size. Errors: also those of readWholeFile.
nlohmann::ordered_json parseJsonFile(const std::filesystem::path& file, const GoOn& goOn,
                                     std::uint64_t mostBytes = std::uint64_t{64} << 20);

// A part of an object that is read part by part.
struct JsonPart {
    const std::string& key;   // of the member
    bool isEntry{};           // of the list or object that the member is; else all of it
    std::size_t index{};      // of an entry
    const std::string& name;  // the key of an object's entry
    const nlohmann::ordered_json& value;  // gone after the call
};

// Who takes the parts, in the order that they come in.
struct JsonParts {
    // Whether a member that is a list or an object comes by its entries.
    std::function<bool(const std::string& key, bool isObject)> areEntries;
    std::function<void(const JsonPart& part)> take;
};

// Reads a text that is an object without keeping it: one part at a time. A text that is something
// else is returned; else an empty object.
nlohmann::ordered_json readJsonParts(std::string_view text, JsonBudget& budget, const GoOn& goOn,
                                     const JsonParts& parts);

}  // namespace pm::host
