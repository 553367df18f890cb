// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace pm {

// A bucket order is a pure function from a grid's (columns, rows) to a permutation of its cell
// indices (row * columns + column): the buckets in the order in which workers draw them. A grid of
// no cells gives an empty order. O(columns * rows). seed: enters the random order only.
// Errors: kInvalidArgument for a negative count or more than 2^32 - 1 cells.
using BucketOrderFunction = std::vector<std::uint32_t> (*)(std::int32_t columns, std::int32_t rows,
                                                           std::uint64_t seed);

struct BucketOrder {
    std::string_view name;  // as given on a command line
    std::string_view help;  // one line
    BucketOrderFunction cells;
    bool isCorrelated = false;  // the next bucket is chosen while rendering: see CorrelatedChoice
};

// Every order there is, the default first.
std::span<const BucketOrder> bucketOrders();

// The order of that name, or nullptr where there is none: the caller knows how to refuse.
const BucketOrder* findBucketOrder(std::string_view name);

// The number of cells of a grid, checked as BucketOrderFunction has it.
std::uint32_t checkedCellCount(std::int32_t columns, std::int32_t rows);

}  // namespace pm
