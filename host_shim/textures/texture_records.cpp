// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/textures/texture_records.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <charconv>
#include <optional>

namespace pm::host {
namespace {

namespace fs = std::filesystem;

// With a space after each but the last; none where there are fewer.
template <typename Number, std::size_t Count>
std::optional<std::array<Number, Count>> numbersOf(const std::string& text) {
    std::array<Number, Count> numbers{};
    const char* at = text.data();
    const char* const textEnd = at + text.size();
    for (Number& number : numbers) {
        if (at >= textEnd) return std::nullopt;
        const auto [end, error] = std::from_chars(at, textEnd, number);
        if (error != std::errc()) return std::nullopt;
        at = end + 1;
    }
    return numbers;
}

}  // namespace

Record toRecord(const Original& original, const FileStamp& stamp, const fs::path& file) {
    Record record;
    record.set("content", original.content);
    record.set("source", fs::absolute(file).string());
    record.set("stamp", stamp.text());
    record.setNumber("float", original.isFloatFile ? 1 : 0);
    record.setNumber("bytes", original.bytes);
    record.set("size", original.size);
    record.setNumber("xyz", original.statement.isXyz ? 1 : 0);
    record.set("profile", original.statement.profile);
    for (std::size_t i = 0; i < original.statement.spaces.size(); ++i)
        record.set(fmt::format("space{}", i), original.statement.spaces[i]);
    if (original.statement.chromaticities)
        record.set("chromaticities",
                   fmt::format("{}", fmt::join(*original.statement.chromaticities, " ")));
    if (original.statement.curve)
        record.set("curve", fmt::format("{}", fmt::join(*original.statement.curve, " ")));
    return record;
}

Original toOriginal(const Record& record) {
    Original original;
    original.content = record.get("content");
    original.isFloatFile = record.number("float") != 0;
    original.bytes = record.number("bytes");
    original.size = record.get("size");
    original.statement.isXyz = record.number("xyz") != 0;
    original.statement.profile = record.get("profile");
    for (std::size_t i = 0; !record.get(fmt::format("space{}", i)).empty(); ++i)
        original.statement.spaces.push_back(record.get(fmt::format("space{}", i)));
    original.statement.chromaticities = numbersOf<float, 8>(record.get("chromaticities"));
    original.statement.curve = numbersOf<double, 7>(record.get("curve"));
    return original;
}

Record toRecord(const TextureFacts& facts, const fs::path& file) {
    Record record;
    record.set("source", fs::absolute(file).string());
    record.setNumber("width", facts.width);
    record.setNumber("height", facts.height);
    record.setNumber("channels", facts.channels);
    record.set("texels", fmt::format("{:016x}{:016x}", facts.texelHash[1], facts.texelHash[0]));
    record.setNumber("negative", facts.bad.negative);
    record.setNumber("notFinite", facts.bad.notFinite);
    record.set("note", facts.note);
    record.setNumber("normals", facts.isLikeNormals ? 1 : 0);
    record.setNumber("holes", facts.hasHoles ? 1 : 0);
    record.setNumber("cutOut", facts.isCutOut ? 1 : 0);
    return record;
}

TextureFacts toFacts(const Record& record) {
    TextureFacts facts;
    facts.width = static_cast<std::int32_t>(record.number("width"));
    facts.height = static_cast<std::int32_t>(record.number("height"));
    facts.channels = static_cast<std::int32_t>(record.number("channels"));
    const std::string texels = record.get("texels");
    if (texels.size() == 32) {
        std::from_chars(texels.data(), texels.data() + 16, facts.texelHash[1], 16);
        std::from_chars(texels.data() + 16, texels.data() + 32, facts.texelHash[0], 16);
    }
    facts.bad = {record.number("negative"), record.number("notFinite")};
    facts.note = record.get("note");
    facts.isLikeNormals = record.number("normals") != 0;
    facts.hasHoles = record.number("holes") != 0;
    facts.isCutOut = record.number("cutOut") != 0;
    return facts;
}

}  // namespace pm::host
