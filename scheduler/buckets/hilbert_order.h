// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <vector>

namespace pm {

// The cells of a grid along one continuous Hilbert curve, for any columns x rows, not only squares
// and powers of two. Starts in the top left cell; every cell comes once; every step goes to an edge
// neighbour, without exception (hilbert_order.cpp says why parity never forbids that). On a square
// whose side is a power of two it is the classic Hilbert curve.
// Errors: kInvalidArgument for a negative count or more than 2^32 - 1 cells.
// Source: P9 in the paper of Yavuz et al. 2010, section 3.
std::vector<std::uint32_t> hilbertOrder(std::int32_t columns, std::int32_t rows);

}  // namespace pm
