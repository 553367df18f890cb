// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Tables of things that have a name and an id.
#pragma once

#include <cstddef>
#include <string_view>

namespace pm::plugin {

// Whether each entry stands where its id says.
template <typename Table>
constexpr bool isInOrderOfIds(const Table& table) {
    for (std::size_t i = 0; i < table.size(); ++i)
        if (static_cast<std::size_t>(table[i].id) != i) return false;
    return true;
}

// Null where there is none of that name.
template <typename Table>
constexpr const typename Table::value_type* findByName(const Table& table, std::string_view name) {
    for (const auto& entry : table)
        if (name == entry.name) return &entry;
    return nullptr;
}

}  // namespace pm::plugin
