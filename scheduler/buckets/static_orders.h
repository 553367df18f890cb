// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <vector>

namespace pm {

// Plain orders of the cells of a grid (row * columns + column), each cell once; a grid of no cells
// gives an empty order. O(columns * rows).
// Errors, all of them: kInvalidArgument for a negative count or more than 2^32 - 1 cells.
// Source: P8 in the paper of Yavuz et al. 2010, section 2, Fig. 1.

// Row after row from the top, each from left to right.
std::vector<std::uint32_t> rowOrder(std::int32_t columns, std::int32_t rows);

// Column after column from the left, each from top to bottom.
std::vector<std::uint32_t> columnOrder(std::int32_t columns, std::int32_t rows);

// Diagonal after diagonal from the top left corner, each from top right to bottom left.
std::vector<std::uint32_t> diagonalOrder(std::int32_t columns, std::int32_t rows);

// From the centre outwards, ring after ring of squares around it. Every step goes to an edge
// neighbour while rings fit into the frame; those beyond its short side are cut into two lines,
// each reached by a jump, but for the first.
std::vector<std::uint32_t> spiralOrder(std::int32_t columns, std::int32_t rows);

// Each permutation as likely as any other, up to the 64 bits of the seed; a seed gives the same
// order on every machine.
std::vector<std::uint32_t> randomOrder(std::int32_t columns, std::int32_t rows, std::uint64_t seed);

}  // namespace pm
