// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "plugin/parameters/parameter.h"

namespace pm::plugin {

// A value for each row of a table, in one piece: most are few numbers, and hosts have a hundred
// thousand materials and lights. Threads: as any value.
class PackedValues {
  public:
    // All are empty at first. rows: at most 65,535.
    explicit PackedValues(std::size_t rows) : m_begins(rows + 1) {}

    ParameterValue get(std::size_t row) const;
    void put(std::size_t row, ParameterValue value);

  private:
    template <typename T>
    using OfSomeRows = std::vector<std::pair<std::uint16_t, T>>;

    std::vector<double> m_numbers;
    std::vector<std::uint16_t> m_begins;  // of each row's numbers, and the end
    OfSomeRows<std::string> m_texts;
    OfSomeRows<std::shared_ptr<const Texture>> m_textures;
};

}  // namespace pm::plugin
