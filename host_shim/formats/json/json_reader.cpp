// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/json/json_reader.h"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "host_shim/formats/json/key_set.h"
#include "host_shim/formats/source_file.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostShown = 60;     // letters of a key
constexpr std::size_t kMostOfFault = 200;  // of the parser's text
constexpr std::size_t kMostDepth = 16;

// What values take: lists double where they are full, so a quarter of them is free on average; a
// block of memory has its own head.
constexpr std::uint64_t kBlock = 16;
constexpr std::uint64_t kElement = sizeof(Json) * 3 / 2;
constexpr std::uint64_t kMember = sizeof(Json::object_t::value_type) * 3 / 2;
constexpr std::uint64_t kContainer = sizeof(Json::object_t) + kBlock;
constexpr std::uint64_t kText = sizeof(std::string) + kBlock;
constexpr std::uint64_t kKnownKey = sizeof(std::string) + 4 * sizeof(void*) + kBlock;

std::string shortened(std::string text, std::size_t most) {
    if (text.size() > most) text = text.substr(0, most) + "...";
    return text;
}

// The letters of a text; asks goOn on the way, also where one value has millions of them.
class WatchedText {
  public:
    using iterator_category = std::forward_iterator_tag;
    using value_type = char;
    using difference_type = std::ptrdiff_t;
    using pointer = const char*;
    using reference = const char&;

    WatchedText() = default;
    WatchedText(const char* at, const GoOn& goOn) : m_at(at), m_goOn(&goOn) {}
    reference operator*() const { return *m_at; }
    WatchedText& operator++() {
        if (++m_count % kBetweenLooks == 0 && *m_goOn) (*m_goOn)();
        ++m_at;
        return *this;
    }
    WatchedText operator++(int) {
        WatchedText before = *this;
        ++*this;
        return before;
    }
    friend bool operator==(const WatchedText& a, const WatchedText& b) { return a.m_at == b.m_at; }

  private:
    static constexpr std::uint32_t kBetweenLooks = 1 << 16;

    const char* m_at{};
    const GoOn* m_goOn{};
    std::uint32_t m_count{};
};

// What nlohmann's reader calls with what it finds. Its own makers of values look at all that a list
// holds whenever one of its entries ends, and at all keys of an object for each new one.
class Builder : public Json::json_sax_t {
  public:
    Builder(JsonBudget& budget, const JsonParts* parts) : m_budget(budget), m_parts(parts) {}

    Json take() { return std::move(m_root); }

    bool null() override { return put({}); }
    bool boolean(bool value) override { return put(value); }
    bool number_integer(number_integer_t value) override { return put(value); }
    bool number_unsigned(number_unsigned_t value) override { return put(value); }
    bool number_float(number_float_t value, const string_t&) override { return put(value); }
    bool string(string_t& value) override {
        const std::uint64_t bytes = kText + value.size();
        return put(std::move(value), bytes);
    }
    bool binary(binary_t&) override { return false; }
    bool start_object(std::size_t) override { return open(true); }
    bool start_array(std::size_t) override { return open(false); }
    bool end_object() override { return close(); }
    bool end_array() override { return close(); }
    bool key(string_t& value) override {
        Level& level = m_levels[m_depth - 1];
        m_budget.take(kKnownKey + value.size());
        level.keyBytes += kKnownKey + value.size();
        if (!level.keys.insert(value))
            refuse(fmt::format("'{}' is there twice", shortened(value, kMostShown)));
        level.key = std::move(value);
        return true;
    }
    bool parse_error(std::size_t, const std::string&,
                     const nlohmann::detail::exception& error) override {
        std::string why = error.what();
        if (const auto end = why.find("] "); end != why.npos) why = why.substr(end + 2);
        refuse("no JSON: " + shortened(why, kMostOfFault));
    }

  private:
    struct Level {
        Json* value{};  // null: its entries are parts, and not kept
        bool isObject{};
        std::size_t count{};  // of entries that were begun
        KeySet keys;
        std::uint64_t keyBytes{};
        std::string key;  // the last one
    };

    [[noreturn]] void refuse(const std::string& why) const {
        throw HostError(ExitCode::kBadInput, fmt::format("{}: {}", m_budget.file(), why));
    }

    bool isPart() const { return m_depth > 0 && m_levels[m_depth - 1].value == nullptr; }

    Json* place(Json value) {
        if (m_depth == 0) return &(m_root = std::move(value));
        Level& level = m_levels[m_depth - 1];
        ++level.count;
        if (level.value == nullptr) {
            m_partBegan = m_budget.used();
            return &(m_part = std::move(value));
        }
        if (!level.isObject) {
            m_budget.take(kElement);
            return &level.value->get_ref<Json::array_t&>().emplace_back(std::move(value));
        }
        m_budget.take(kMember + level.key.size());
        // As a list: the key is new.
        Json::object_t::Container& members = level.value->get_ref<Json::object_t&>();
        return &members.emplace_back(std::move(level.key), std::move(value)).second;
    }

    bool put(Json value, std::uint64_t bytes = 0) {
        const bool isWhole = isPart();
        place(std::move(value));
        m_budget.take(bytes);
        if (isWhole) endPart();
        return true;
    }

    // A list or object gets no other entry while one of its own is open, so it stays where it is.
    bool open(bool isObject) {
        if (m_depth >= kMostDepth)
            refuse(
                fmt::format("lists and objects stand in each other more than {} deep", kMostDepth));
        Json* value = nullptr;
        if (isByParts(isObject)) {
            if (m_depth > 0) ++m_levels[m_depth - 1].count;
            if (m_depth == 0) m_root = Json::object();
        } else {
            value = place(isObject ? Json(Json::value_t::object) : Json(Json::value_t::array));
            m_budget.take(kContainer);
        }
        Level& level = m_levels[m_depth++];
        level.value = value;
        level.isObject = isObject;
        level.count = 0;
        return true;
    }

    // Whether the entries of what begins now are parts: the whole, or a member of it.
    bool isByParts(bool isObject) const {
        if (m_parts == nullptr) return false;
        if (m_depth == 0) return isObject;
        return m_depth == 1 && isPart() && m_parts->areEntries(m_levels[0].key, isObject);
    }

    bool close() {
        Level& level = m_levels[--m_depth];
        level.keys.clear();
        m_budget.giveBack(std::exchange(level.keyBytes, 0));
        if (level.value != nullptr && isPart()) endPart();
        return true;
    }

    void endPart() {
        const Level& top = m_levels[0];
        const Level& its = m_levels[m_depth - 1];
        const bool isEntry = m_depth == 2;
        const std::uint64_t bytes = m_budget.used() - m_partBegan;
        m_parts->take({top.key, isEntry, its.count - 1, its.key, m_part});
        m_part = nullptr;
        m_budget.giveBack(bytes);
    }

    JsonBudget& m_budget;
    const JsonParts* m_parts;
    Json m_root, m_part;
    std::uint64_t m_partBegan{};
    std::array<Level, kMostDepth> m_levels;
    std::size_t m_depth{};
};

Json read(std::string_view text, JsonBudget& budget, const GoOn& goOn, const JsonParts* parts) {
    Builder builder(budget, parts);
    Json::sax_parse(WatchedText(text.data(), goOn), WatchedText(text.data() + text.size(), goOn),
                    &builder);
    return builder.take();
}

}  // namespace

Json parseJson(std::string_view text, JsonBudget& budget, const GoOn& goOn) {
    return read(text, budget, goOn, nullptr);
}

Json parseJson(std::string_view text, const std::string& file, const GoOn& goOn) {
    JsonBudget budget(file, text.size());
    return parseJson(text, budget, goOn);
}

Json parseJsonFile(const std::filesystem::path& file, const GoOn& goOn, std::uint64_t mostBytes) {
    return parseJson(readWholeFile(file, goOn, mostBytes), file.string(), goOn);
}

Json readJsonParts(std::string_view text, JsonBudget& budget, const GoOn& goOn,
                   const JsonParts& parts) {
    return read(text, budget, goOn, &parts);
}

}  // namespace pm::host
