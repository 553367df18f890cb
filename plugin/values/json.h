// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <concepts>
#include <cstddef>
#include <functional>
#include <initializer_list>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace pm::plugin {

// A value of JSON with its members in the order that they came in. nlohmann's own ends the process
// where memory ends while one of its values is destroyed (3.11.2 takes memory for that); here it
// writes and reads the numbers and texts, and reads files. Errors: std::bad_alloc.
class Json {
  public:
    Json() = default;  // null
    Json(std::nullptr_t) {}
    Json(bool value);
    Json(double value);  // null where it is not finite
    Json(const char* text);
    Json(const std::string& text);
    template <std::integral Integer>
    requires(!std::same_as<Integer, bool>) Json(Integer value)
        : m_kind(Kind::kNumber), m_text(std::to_string(value)) {}
    template <typename Element>
    Json(const std::vector<Element>& elements) : m_kind(Kind::kArray) {
        for (const Element& element : elements) push_back(element);
    }
    // Pairs of a text and something make an object, anything else an array.
    Json(std::initializer_list<Json> elements);
    Json(const Json&) = default;
    Json(Json&&) noexcept = default;
    Json& operator=(const Json&) = default;
    Json& operator=(Json&&) noexcept = default;
    ~Json() = default;
    static Json object();
    static Json array();

    // A member of an object, which null becomes; null where it was not there. Many are found by a
    // table.
    Json& operator[](const char* key);
    // To an array, which null becomes.
    void push_back(Json element);

    // What parse() found; CallError(FILE) where it is something else.
    const Json& at(const char* key) const;
    const Json& elementAt(std::size_t index) const;
    const Json* find(const char* key) const;  // null where it is not there
    std::span<const Json> elements() const;
    const std::string& text() const;
    std::uint64_t number() const;  // a whole one, 0 or more
    bool truth() const;

    // spaces: of each level, every member on a line of its own; nothing: all on one line. Bytes
    // that are no UTF-8 are replaced.
    std::string dump(std::optional<std::size_t> spaces = std::nullopt) const;

    // In time that grows as the text does. Errors: CallError(FILE) for what is no JSON, has a key
    // twice, more than 64 levels, 100,000 values or 16 MiB: what is read here is the head of a
    // file.
    static Json parse(std::span<const std::byte> text);

  private:
    enum class Kind { kNull, kBool, kNumber, kText, kArray, kObject };
    friend class JsonReader;

    static Json ofKind(Kind kind);
    bool isPair() const;
    std::optional<std::size_t> placeOf(std::string_view key) const;
    Json& addMember(std::string key);
    void write(std::optional<std::size_t> spaces, std::size_t level, std::string& text) const;

    Kind m_kind = Kind::kNull;
    std::string m_text;               // a text as it is; a number or truth as it is written
    std::vector<std::string> m_keys;  // an object's, one for each element
    std::map<std::string, std::size_t, std::less<>> m_places;  // of its keys, once they are many
    std::vector<Json> m_elements;
};

}  // namespace pm::plugin
