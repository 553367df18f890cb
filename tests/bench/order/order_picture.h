// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <filesystem>

namespace pm::bench {

// Draws every bucket order that is known beforehand over a grid of columns x rows cells, one panel
// each, as an SVG: the way from cell to cell, blue where it begins and orange where it ends.
// Throws Error(kIo).
void drawOrders(const std::filesystem::path& file, std::int32_t columns, std::int32_t rows);

}  // namespace pm::bench
