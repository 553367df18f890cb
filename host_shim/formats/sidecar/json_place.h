// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <initializer_list>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pm::host {

// Numbers that are allowed, and what they count: messages say "(0, 180] degrees".
struct NumberRange {
    double low{-std::numeric_limits<double>::max()};
    double high{std::numeric_limits<double>::max()};
    bool withLow{true};
    bool withHigh{true};
    const char* unit{""};
};

// A value of a JSON file and where it stands: "lights[2].angle". All that is asked of it is
// checked; errors are HostError kBadInput, "FILE: PLACE is VALUE; what is allowed". Refers to the
// file's value and name, which must outlive it.
class JsonPlace {
  public:
    // path: empty for the whole.
    JsonPlace(const nlohmann::ordered_json& value, const std::string& file, std::string path = {})
        : m_value(&value), m_file(&file), m_path(std::move(path)) {}

    // Throws: the place, and text after it.
    [[noreturn]] void refuse(const std::string& text) const;

    // Of an object: refuses keys that are not allowed.
    void allowKeys(std::initializer_list<std::string_view> allowed) const;
    bool has(const char* key) const { return m_value->contains(key); }
    JsonPlace member(const char* key) const;  // refuses where there is none
    // Of an object.
    std::vector<std::pair<std::string, JsonPlace>> members() const;
    // The entries of a list; of a key that is not there none.
    std::vector<JsonPlace> entries() const { return entriesOr("a list"); }
    // The same, where other values are allowed too.
    std::vector<JsonPlace> entriesOr(const char* allowed) const;
    std::vector<JsonPlace> entriesOf(const char* key) const;

    bool isText() const { return m_value->is_string(); }
    bool isNumber() const { return m_value->is_number(); }
    bool isObject() const { return m_value->is_object(); }
    double number(const NumberRange& range = {}) const;
    std::array<double, 3> triple(const NumberRange& range = {}) const;
    // One number for all three, or three.
    std::array<double, 3> oneOrThree(const NumberRange& range = {}) const;
    std::array<double, 12> matrix() const;  // of 12 numbers, with an inverse
    std::string text() const;               // not empty
    // Which of the words it is.
    std::size_t choice(std::initializer_list<std::string_view> allowed) const;

    // The path of an object's member, however long its key is.
    static std::string memberPath(const std::string& path, const std::string& key);
    const std::string& path() const { return m_path; }
    const std::string& file() const { return *m_file; }

  private:
    [[noreturn]] void refuseValue(const std::string& allowed) const;
    JsonPlace entry(std::size_t index) const;

    const nlohmann::ordered_json* m_value;
    const std::string* m_file;
    std::string m_path;
};

}  // namespace pm::host
