// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/buckets/bucket_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "integrator/values/error.h"

namespace pm {
namespace {

// Far beyond any picture, and small enough that sums of coordinates and sizes can't overflow.
constexpr std::int32_t kMaxCoordinate = 1 << 29;

// Integer division rounds towards zero, which would put a crooked atom around 0.
constexpr std::int32_t floorToAtom(std::int32_t coordinate) {
    const std::int32_t rest = coordinate % kAtomSizePixels;
    return coordinate - rest - (rest < 0 ? kAtomSizePixels : 0);
}

constexpr std::int32_t ceilToAtom(std::int32_t coordinate) {
    return -floorToAtom(-coordinate);
}

constexpr std::int32_t ceilDivide(std::int32_t length, std::int32_t size) {
    return (length - 1) / size + 1;
}

void checkBucketSize(std::int32_t bucketSize) {
    if (bucketSize < kMinBucketSizePixels || bucketSize > kMaxBucketSizePixels ||
        bucketSize % kAtomSizePixels != 0) {
        throw Error(
            Status::kInvalidArgument,
            fmt::format("bucket size is {}; it must be a multiple of {} from {} to {} "
                        "(pixels)",
                        bucketSize, kAtomSizePixels, kMinBucketSizePixels, kMaxBucketSizePixels));
    }
}

}  // namespace

void checkWindow(const Rect& window) {
    for (const std::int32_t c : {window.x0, window.y0, window.x1, window.y1}) {
        if (c < -kMaxCoordinate || c > kMaxCoordinate) {
            throw Error(Status::kInvalidArgument,
                        fmt::format("window coordinate is {}; it must be from {} to {} (pixels)", c,
                                    -kMaxCoordinate, kMaxCoordinate));
        }
    }
}

Rect wholeAtoms(const Rect& pixels) {
    if (pixels.empty()) return {};
    return {floorToAtom(pixels.x0), floorToAtom(pixels.y0), ceilToAtom(pixels.x1),
            ceilToAtom(pixels.y1)};
}

std::int32_t atomCount(const Rect& bucket) {
    const Rect atoms = wholeAtoms(bucket);
    return atoms.width() / kAtomSizePixels * (atoms.height() / kAtomSizePixels);
}

Rect atomOf(const Rect& bucket, std::int32_t index) {
    const Rect atoms = wholeAtoms(bucket);
    const std::int32_t columns = atoms.width() / kAtomSizePixels;
    const std::int32_t x = atoms.x0 + index % columns * kAtomSizePixels;
    const std::int32_t y = atoms.y0 + index / columns * kAtomSizePixels;
    return intersect({x, y, x + kAtomSizePixels, y + kAtomSizePixels}, bucket);
}

std::int32_t autoBucketSize(const Rect& window) {
    constexpr std::int64_t kMostBuckets = 65536;
    const Rect atoms = wholeAtoms(window);
    std::int32_t size = 32;
    const auto buckets = [&] {
        return std::int64_t{ceilDivide(atoms.width(), size)} * ceilDivide(atoms.height(), size);
    };
    while (size < kMaxBucketSizePixels && buckets() > kMostBuckets) size *= 2;
    return size;
}

BucketGrid::BucketGrid(const Rect& window, std::int32_t bucketSize)
    : m_window(window), m_bucketSize(bucketSize) {
    checkWindow(window);
    checkBucketSize(bucketSize);
    if (window.empty()) return;
    m_originX = floorToAtom(window.x0);
    m_originY = floorToAtom(window.y0);
    m_columns = ceilDivide(window.x1 - m_originX, bucketSize);
    m_rows = ceilDivide(window.y1 - m_originY, bucketSize);
    const std::int64_t cells = static_cast<std::int64_t>(m_columns) * m_rows;
    if (cells > std::numeric_limits<std::uint32_t>::max()) {
        throw Error(
            Status::kInvalidArgument,
            fmt::format("a window of {} x {} pixels has {} buckets of {} pixels; at most {} "
                        "are allowed",
                        window.width(), window.height(), cells, bucketSize,
                        std::numeric_limits<std::uint32_t>::max()));
    }
}

Rect BucketGrid::cellRect(std::uint32_t cell) const {
    const auto columns = static_cast<std::uint32_t>(m_columns);
    // A cell begins within the window, so its origin fits; its end may only after clipping.
    const std::int32_t x = m_originX + static_cast<std::int32_t>(cell % columns) * m_bucketSize;
    const std::int32_t y = m_originY + static_cast<std::int32_t>(cell / columns) * m_bucketSize;
    return intersect({x, y, x + m_bucketSize, y + m_bucketSize}, m_window);
}

std::int64_t BucketGrid::maxCellArea() const {
    if (m_window.empty()) return 0;
    return static_cast<std::int64_t>(std::min(m_bucketSize, m_window.width())) *
           std::min(m_bucketSize, m_window.height());
}

}  // namespace pm
