// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/bucket_order.h"

#include <fmt/format.h>

#include <array>
#include <limits>
#include <numeric>

#include "integrator/values/error.h"
#include "scheduler/hilbert_order.h"

namespace pm {
namespace {

constexpr std::array kBucketOrders{
    BucketOrder{"hilbert", "one continuous Hilbert curve through the frame", &hilbertOrder},
    BucketOrder{"row", "row after row, each from left to right", &rowOrder},
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

std::vector<std::uint32_t> rowOrder(std::int32_t columns, std::int32_t rows) {
    std::vector<std::uint32_t> order(checkedCellCount(columns, rows));
    std::iota(order.begin(), order.end(), 0u);
    return order;
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
