// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "integrator/materials/texture_source.h"
#include "plugin/parameters/packed_values.h"
#include "plugin/parameters/parameter.h"
#include "plugin/values/call_error.h"
#include "plugin/values/hasher.h"

namespace pm::plugin {

// "a, b, c": the names of a table, for the texts of errors.
template <typename Row>
std::string namesOf(std::span<const Row> rows) {
    std::string names;
    for (const Row& row : rows) names += (names.empty() ? "" : ", ") + std::string(row.info.name);
    return names;
}

// The place of a name in a table. Errors: CallError(NAME) with the names that there are.
template <typename Row>
std::size_t indexOf(std::span<const Row> rows, std::string_view name, const std::string& owner) {
    for (std::size_t i = 0; i < rows.size(); ++i)
        if (name == rows[i].info.name) return i;
    throw CallError(CallStatus::kName, fmt::format("{}: there is no parameter '{}'; allowed: {}",
                                                   owner, name, namesOf(rows)));
}

// What a host has said of one object, a value for each row of its table; first the defaults. The
// structs of the C interface are presets of it. The table must outlive it. Threads: as any value.
template <typename Row>
class ParameterSet {
  public:
    explicit ParameterSet(std::span<const Row> rows) : m_rows(rows), m_values(rows.size()) {
        for (std::size_t i = 0; i < rows.size(); ++i) m_values.put(i, defaultValue(rows[i].info));
    }

    std::span<const Row> rows() const { return m_rows; }
    ParameterValue value(std::size_t index) const { return m_values.get(index); }
    ParameterValue value(std::string_view name) const {
        return m_values.get(indexOf(m_rows, name, "the table"));
    }
    double number(std::string_view name) const { return value(name).numbers.at(0); }

    // As it is.
    void assign(std::size_t index, ParameterValue value) { m_values.put(index, std::move(value)); }
    // Checked. Errors: CallError NAME, ARGUMENT; see checkedValue. The value before then stays.
    void set(std::string_view name, ParameterValue value, const std::string& owner) {
        const std::size_t index = indexOf(m_rows, name, owner);
        m_values.put(index, checkedValue(m_rows[index].info, std::move(value), owner));
    }
    // The same from a text.
    void setText(std::string_view name, const std::string& text, const std::string& owner) {
        const std::size_t index = indexOf(m_rows, name, owner);
        m_values.put(index, parseValue(m_rows[index].info, text, owner));
    }
    // Checks what means something for objects of this kind. Errors: CallError(ARGUMENT).
    void check(std::uint32_t kind, const std::string& owner) {
        for (std::size_t i = 0; i < m_rows.size(); ++i) {
            const ParameterInfo& info = m_rows[i].info;
            if ((info.kinds >> kind & 1u) != 0 && info.type != ParameterType::kObjects)
                m_values.put(i, checkedValue(info, m_values.get(i), owner));
        }
    }

    // Puts all into a description that has a place for it. textureIndex: the number of a texture
    // in the scene.
    using TextureIndex = std::function<std::int32_t(const std::shared_ptr<const Texture>&)>;
    template <typename Description>
    void putInto(Description& description, const TextureIndex& textureIndex) const {
        for (std::size_t i = 0; i < m_rows.size(); ++i) {
            const auto& place = std::get<Place<Description>>(m_rows[i].places);
            const bool isTexture = m_rows[i].info.type == ParameterType::kTexture;
            if (place.put == nullptr) continue;
            const ParameterValue value = m_values.get(i);
            place.put(description, value, isTexture ? textureIndex(value.texture) : kNoTexture);
        }
    }
    template <typename Description>
    void putInto(Description& description) const {
        putInto(description, [](const std::shared_ptr<const Texture>&) { return kNoTexture; });
    }

  private:
    std::span<const Row> m_rows;
    PackedValues m_values;
};

// Adds what pixels depend on in a description, row by row. Of a row that came later nothing where
// it has its default: scenes without keep the checksums that they have had.
template <typename Description, typename Row>
void hashRows(Hasher& hasher, std::span<const Row> rows, const Description& description) {
    for (const Row& row : rows) {
        const auto& place = std::get<Place<Description>>(row.places);
        if (place.hash == nullptr || !row.info.changesPixels) continue;
        if (row.info.isLater) {
            Description plain = description;
            place.put(plain, defaultValue(row.info), kNoTexture);
            const auto feed = [&](const Description& d) {
                return checksumOf([&](Hasher& own) { place.hash(own, d); });
            };
            if (feed(plain) == feed(description)) continue;
            hasher.add(std::string_view(row.info.name));
        }
        place.hash(hasher, description);
    }
}

}  // namespace pm::plugin
