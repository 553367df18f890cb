// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/values/json.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "plugin/values/call_error.h"

namespace pm::plugin {

namespace {

constexpr std::size_t kMostLevels = 64;
constexpr std::size_t kMostValues = 100'000;
constexpr std::size_t kMostBytes = std::size_t{16} << 20;
constexpr std::size_t kFewKeys = 16;  // which are looked through

// Of a number or a text alone; these take no memory to be destroyed.
std::string written(const nlohmann::json& scalar) {
    return scalar.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

CallError notUnderstood() {
    return {CallStatus::kFile, "its head can't be understood"};
}

}  // namespace

Json::Json(bool value) : m_kind(Kind::kBool), m_text(value ? "true" : "false") {}

Json::Json(double value) {
    if (!std::isfinite(value)) return;
    m_kind = Kind::kNumber;
    m_text = written(value);
}

Json::Json(const char* text) : m_kind(Kind::kText), m_text(text) {}

Json::Json(const std::string& text) : m_kind(Kind::kText), m_text(text) {}

bool Json::isPair() const {
    return m_kind == Kind::kArray && m_elements.size() == 2 && m_elements[0].m_kind == Kind::kText;
}

Json::Json(std::initializer_list<Json> elements) : m_kind(Kind::kArray) {
    const bool arePairs =
        elements.size() > 0 && std::all_of(elements.begin(), elements.end(),
                                           [](const Json& element) { return element.isPair(); });
    if (!arePairs) {
        m_elements = elements;
        return;
    }
    m_kind = Kind::kObject;
    for (const Json& pair : elements)
        (*this)[pair.m_elements[0].m_text.c_str()] = pair.m_elements[1];
}

Json Json::ofKind(Kind kind) {
    Json json;
    json.m_kind = kind;
    return json;
}

Json Json::object() {
    return ofKind(Kind::kObject);
}

Json Json::array() {
    return ofKind(Kind::kArray);
}

Json& Json::operator[](const char* key) {
    if (m_kind == Kind::kNull) m_kind = Kind::kObject;
    if (const auto place = placeOf(key)) return m_elements[*place];
    return addMember(key);
}

std::optional<std::size_t> Json::placeOf(std::string_view key) const {
    if (m_keys.size() > kFewKeys) {
        const auto found = m_places.find(key);
        return found == m_places.end() ? std::nullopt : std::optional(found->second);
    }
    const auto found = std::find(m_keys.begin(), m_keys.end(), key);
    if (found == m_keys.end()) return std::nullopt;
    return static_cast<std::size_t>(found - m_keys.begin());
}

// What may fail for want of memory comes first; then keys, places and elements agree.
Json& Json::addMember(std::string key) {
    const std::size_t count = m_keys.size();
    if (m_keys.capacity() == count) m_keys.reserve(2 * count + 1);
    if (m_elements.capacity() == count) m_elements.reserve(2 * count + 1);
    for (std::size_t i = m_places.size(); i < count && count >= kFewKeys; ++i)
        m_places.emplace(m_keys[i], i);
    if (count >= kFewKeys) m_places.emplace(key, count);
    m_keys.push_back(std::move(key));
    return m_elements.emplace_back();
}

void Json::push_back(Json element) {
    if (m_kind == Kind::kNull) m_kind = Kind::kArray;
    m_elements.push_back(std::move(element));
}

const Json* Json::find(const char* key) const {
    const auto place = placeOf(key);
    return place ? &m_elements[*place] : nullptr;
}

const Json& Json::at(const char* key) const {
    const Json* found = find(key);
    if (found == nullptr) throw notUnderstood();
    return *found;
}

const Json& Json::elementAt(std::size_t index) const {
    if (index >= elements().size()) throw notUnderstood();
    return m_elements[index];
}

std::span<const Json> Json::elements() const {
    if (m_kind != Kind::kArray) throw notUnderstood();
    return m_elements;
}

const std::string& Json::text() const {
    if (m_kind != Kind::kText) throw notUnderstood();
    return m_text;
}

std::uint64_t Json::number() const {
    std::uint64_t value = 0;
    const char* const end = m_text.data() + m_text.size();
    const auto read = std::from_chars(m_text.data(), end, value);
    if (m_kind != Kind::kNumber || read.ec != std::errc() || read.ptr != end) throw notUnderstood();
    return value;
}

bool Json::truth() const {
    if (m_kind != Kind::kBool) throw notUnderstood();
    return m_text == "true";
}

void Json::write(std::optional<std::size_t> spaces, std::size_t level, std::string& text) const {
    if (m_kind == Kind::kNull) text += "null";
    if (m_kind == Kind::kBool || m_kind == Kind::kNumber) text += m_text;
    if (m_kind == Kind::kText) text += written(m_text);
    if (m_kind != Kind::kArray && m_kind != Kind::kObject) return;
    const auto newLine = [&](std::size_t levels) {
        if (spaces && !m_elements.empty()) text.append("\n").append(*spaces * levels, ' ');
    };
    const bool isObject = m_kind == Kind::kObject;
    text += isObject ? '{' : '[';
    for (std::size_t i = 0; i < m_elements.size(); ++i) {
        if (i > 0) text += ',';
        newLine(level + 1);
        if (isObject) text.append(written(m_keys[i])).append(spaces ? ": " : ":");
        m_elements[i].write(spaces, level + 1, text);
    }
    newLine(level);
    text += isObject ? '}' : ']';
}

std::string Json::dump(std::optional<std::size_t> spaces) const {
    std::string text;
    write(spaces, 0, text);
    return text;
}

// What nlohmann's reader calls with what it finds; true goes on.
class JsonReader : public nlohmann::json::json_sax_t {
  public:
    Json take() { return std::move(m_root); }

    bool null() override { return put({}); }
    bool boolean(bool value) override { return put(value); }
    bool number_integer(number_integer_t value) override { return put(value); }
    bool number_unsigned(number_unsigned_t value) override { return put(value); }
    bool number_float(number_float_t value, const string_t&) override { return put(value); }
    bool string(string_t& value) override { return put(value); }
    bool binary(binary_t&) override { return false; }
    bool start_object(std::size_t) override { return open(Json::object()); }
    bool key(string_t& value) override {
        m_key = value;
        return true;
    }
    bool end_object() override { return close(); }
    bool start_array(std::size_t) override { return open(Json::array()); }
    bool end_array() override { return close(); }
    bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override {
        return false;
    }

  private:
    // Null where there are too many, or one of this key is there.
    Json* place(Json value) {
        if (++m_count > kMostValues) return nullptr;
        if (m_open.empty()) {
            m_root = std::move(value);
            return &m_root;
        }
        Json& parent = *m_open.back();
        if (parent.m_kind == Json::Kind::kObject) {
            if (parent.placeOf(m_key)) return nullptr;
            return &(parent.addMember(std::move(m_key)) = std::move(value));
        }
        parent.push_back(std::move(value));
        return &parent.m_elements.back();
    }
    bool put(Json value) { return place(std::move(value)) != nullptr; }
    // A parent gets no other element while one of its own is open, so it stays where it is.
    bool open(Json value) {
        if (m_open.size() >= kMostLevels) return false;
        Json* const placed = place(std::move(value));
        if (placed != nullptr) m_open.push_back(placed);
        return placed != nullptr;
    }
    bool close() {
        m_open.pop_back();
        return true;
    }

    Json m_root;
    std::vector<Json*> m_open;
    std::string m_key;
    std::size_t m_count{};
};

Json Json::parse(std::span<const std::byte> text) {
    const auto* first = reinterpret_cast<const char*>(text.data());
    JsonReader reader;
    if (text.size() > kMostBytes) throw notUnderstood();
    if (!nlohmann::json::sax_parse(first, first + text.size(), &reader)) throw notUnderstood();
    return reader.take();
}

}  // namespace pm::plugin
