// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/buckets/bucket_order.h"

#include <fmt/format.h>

#include <array>
#include <limits>

#include "integrator/values/error.h"
#include "scheduler/buckets/hilbert_order.h"
#include "scheduler/buckets/static_orders.h"

namespace pm {
namespace {

// The table's form of a function without a seed.
template <std::vector<std::uint32_t> (*cells)(std::int32_t, std::int32_t)>
std::vector<std::uint32_t> unseeded(std::int32_t columns, std::int32_t rows, std::uint64_t) {
    return cells(columns, rows);
}

constexpr std::array kBucketOrders{
    BucketOrder{"hilbert", "one continuous Hilbert curve through the frame",
                &unseeded<hilbertOrder>},
    BucketOrder{"row", "row after row, each from left to right", &unseeded<rowOrder>},
    BucketOrder{"column", "column after column, each from top to bottom", &unseeded<columnOrder>},
    BucketOrder{"diagonal", "diagonal after diagonal from the top left corner",
                &unseeded<diagonalOrder>},
    BucketOrder{"spiral", "from the middle outwards", &unseeded<spiralOrder>},
    BucketOrder{"random", "shuffled by the seed", &randomOrder},
    BucketOrder{"correlated", "Hilbert's, but next the neighbour whose finished edges agree best",
                &unseeded<hilbertOrder>, true},
};

}  // namespace

std::uint32_t checkedCellCount(std::int32_t columns, std::int32_t rows) {
    const std::int64_t cells = static_cast<std::int64_t>(columns) * rows;
    if (columns < 0 || rows < 0 || cells > std::numeric_limits<std::uint32_t>::max()) {
        throw Error(Status::kInvalidArgument,
                    fmt::format("a bucket order over {} x {} cells; both counts must be >= 0 and "
                                "their product at most {}",
                                columns, rows, std::numeric_limits<std::uint32_t>::max()));
    }
    return static_cast<std::uint32_t>(cells);
}

std::span<const BucketOrder> bucketOrders() {
    return kBucketOrders;
}

const BucketOrder* findBucketOrder(std::string_view name) {
    for (const BucketOrder& order : kBucketOrders) {
        if (order.name == name) return &order;
    }
    return nullptr;
}

}  // namespace pm
