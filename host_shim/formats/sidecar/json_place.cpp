// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/sidecar/json_place.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kMostShown = 60;  // letters of a value

std::string shortened(std::string text, std::size_t most) {
    if (text.size() > most) text = text.substr(0, most) + "...";
    return text;
}

// Without looking at all of a long one.
std::string shown(const ordered_json& value) {
    if (value.is_array()) return fmt::format("a list of {}", value.size());
    if (value.is_object()) return "an object";
    if (value.is_string()) return shortened("'" + value.get<std::string>() + "'", kMostShown);
    return value.dump();
}

std::string textOf(const NumberRange& range) {
    constexpr double kMost = std::numeric_limits<double>::max();
    const std::string unit = *range.unit == '\0' ? "" : fmt::format(" {}", range.unit);
    if (range.low == -kMost && range.high == kMost) return "a number" + unit;
    if (range.high == kMost)
        return fmt::format("{} {:g}{}", range.withLow ? "at least" : "above", range.low, unit);
    return fmt::format("in {}{:g}, {:g}{}{}", range.withLow ? '[' : '(', range.low, range.high,
                       range.withHigh ? ']' : ')', unit);
}

bool isIn(double value, const NumberRange& range) {
    return (range.withLow ? value >= range.low : value > range.low) &&
           (range.withHigh ? value <= range.high : value < range.high);
}

// Whether the 3 x 3 part flattens space, at any scale of its rows: as the C interface asks.
bool isFlat(const std::array<double, 12>& m) {
    constexpr double kFlat = 1e-14;
    std::array<std::array<double, 3>, 3> rows{};
    for (std::size_t row = 0; row < 3; ++row) {
        double size = 0;
        for (std::size_t i = 0; i < 3; ++i) size = std::max(size, std::abs(m[row * 4 + i]));
        if (size == 0) return true;
        for (std::size_t i = 0; i < 3; ++i) rows[row][i] = m[row * 4 + i] / size;
    }
    const auto& [a, b, c] = rows;
    const double determinant = a[0] * (b[1] * c[2] - b[2] * c[1]) -
                               a[1] * (b[0] * c[2] - b[2] * c[0]) +
                               a[2] * (b[0] * c[1] - b[1] * c[0]);
    return std::abs(determinant) < kFlat;
}

}  // namespace

void JsonPlace::refuse(const std::string& text) const {
    throw HostError(ExitCode::kBadInput,
                    fmt::format("{}: {}{}", *m_file, m_path.empty() ? "it" : m_path, text));
}

void JsonPlace::refuseValue(const std::string& allowed) const {
    refuse(fmt::format(" is {}; it must be {}", shown(*m_value), allowed));
}

void JsonPlace::allowKeys(std::initializer_list<std::string_view> allowed) const {
    if (!m_value->is_object()) refuseValue("an object");
    for (const auto& [key, value] : m_value->items())
        if (std::ranges::find(allowed, std::string_view(key)) == allowed.end())
            refuse(fmt::format(" has a '{}'; allowed are {}", shortened(key, kMostShown),
                               fmt::join(allowed, ", ")));
}

JsonPlace JsonPlace::member(const char* key) const {
    const auto found = m_value->find(key);
    if (found == m_value->end()) refuse(fmt::format(" has no '{}', which it must have", key));
    return {*found, *m_file, m_path.empty() ? key : fmt::format("{}.{}", m_path, key)};
}

std::vector<std::pair<std::string, JsonPlace>> JsonPlace::members() const {
    if (!m_value->is_object()) refuseValue("an object");
    std::vector<std::pair<std::string, JsonPlace>> all;
    for (const auto& [key, value] : m_value->items())
        all.emplace_back(key, JsonPlace(value, *m_file, memberPath(m_path, key)));
    return all;
}

std::string JsonPlace::memberPath(const std::string& path, const std::string& key) {
    return fmt::format("{}['{}']", path, shortened(key, kMostShown));
}

JsonPlace JsonPlace::entry(std::size_t index) const {
    return {(*m_value)[index], *m_file, fmt::format("{}[{}]", m_path, index)};
}

std::vector<JsonPlace> JsonPlace::entriesOr(const char* allowed) const {
    if (!m_value->is_array()) refuseValue(allowed);
    std::vector<JsonPlace> all;
    for (std::size_t i = 0; i < m_value->size(); ++i) all.push_back(entry(i));
    return all;
}

std::vector<JsonPlace> JsonPlace::entriesOf(const char* key) const {
    return has(key) ? member(key).entries() : std::vector<JsonPlace>{};
}

double JsonPlace::number(const NumberRange& range) const {
    if (!m_value->is_number()) refuseValue(textOf(range));
    const auto value = m_value->get<double>();
    if (!std::isfinite(value) || !isIn(value, range)) refuseValue(textOf(range));
    return value;
}

std::array<double, 3> JsonPlace::triple(const NumberRange& range) const {
    if (!m_value->is_array() || m_value->size() != 3) refuseValue("a list of 3 numbers");
    std::array<double, 3> values{};
    for (std::size_t i = 0; i < 3; ++i) values[i] = entry(i).number(range);
    return values;
}

std::array<double, 3> JsonPlace::oneOrThree(const NumberRange& range) const {
    if (m_value->is_array()) return triple(range);
    const double value = number(range);
    return {value, value, value};
}

std::array<double, 12> JsonPlace::matrix() const {
    if (!m_value->is_array() || m_value->size() != 12)
        refuseValue("a list of 12 numbers, 3 rows of 4");
    std::array<double, 12> values{};
    for (std::size_t i = 0; i < 12; ++i) values[i] = entry(i).number();
    if (isFlat(values)) refuse(" has no inverse; it must not flatten space");
    return values;
}

std::string JsonPlace::text() const {
    if (!m_value->is_string() || m_value->get_ref<const std::string&>().empty())
        refuseValue("a text that is not empty");
    return m_value->get<std::string>();
}

std::size_t JsonPlace::choice(std::initializer_list<std::string_view> allowed) const {
    const std::string words = fmt::format("one of {}", fmt::join(allowed, ", "));
    if (!m_value->is_string()) refuseValue(words);
    const auto found = std::ranges::find(allowed, m_value->get_ref<const std::string&>());
    if (found == allowed.end()) refuseValue(words);
    return static_cast<std::size_t>(found - allowed.begin());
}

}  // namespace pm::host
