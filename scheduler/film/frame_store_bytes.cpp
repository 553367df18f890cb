// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/film/frame_store_bytes.h"

#include <fmt/format.h>

#include <cstring>
#include <mutex>
#include <type_traits>

#include "integrator/values/error.h"

namespace pm {
namespace {

void checkWithin(const Rect& rect, const Rect& window) {
    if (intersect(rect, window) == rect) return;
    throw Error(Status::kInvalidArgument,
                fmt::format("pixels [{},{}) x [{},{}) are not within what the frame holds", rect.x0,
                            rect.x1, rect.y0, rect.y1));
}

}  // namespace

template <typename Store, typename Visit>
void FrameStoreBytes::forEachArray(Store& store, Visit visit) {
    visit(store.m_sums);
    visit(store.m_weights);
    visit(store.m_deviations);
    visit(store.m_passes);
    visit(store.m_evenSums);
    visit(store.m_evenWeights);
    visit(store.m_evenPasses);
    visit(store.m_allotted);
    visit(store.m_seen);
    visit(store.m_passWeights);
    visit(store.m_halfWeights);
    visit(store.m_groups);
}

template <typename Store, typename Visit>
void FrameStoreBytes::forEachRow(Store& store, const Rect& rect, Visit visit) {
    const auto pixels = static_cast<std::size_t>(store.m_area.area());
    forEachArray(store, [&](auto& array) {
        using Element = std::remove_reference_t<decltype(array[0])>;
        static_assert(std::is_trivially_copyable_v<Element>);
        if (array.empty()) return;
        const std::size_t perPixel = array.size() / pixels;
        const std::size_t rowBytes =
            static_cast<std::size_t>(rect.width()) * perPixel * sizeof(Element);
        for (std::int32_t y = rect.y0; y < rect.y1; ++y) {
            const std::lock_guard lock(store.bandLock(y));
            visit(array.data() + store.pixelIndex(rect.x0, y) * perPixel, rowBytes);
        }
    });
}

Rect FrameStoreBytes::area(const FrameStore& store) {
    return store.m_area;
}

std::size_t FrameStoreBytes::bytesPerPixel(const FrameStore& store) {
    const auto pixels = static_cast<std::size_t>(store.m_area.area());
    std::size_t bytes = 0;
    forEachArray(store,
                 [&](const auto& array) { bytes += array.size() / pixels * sizeof(array[0]); });
    return bytes;
}

void FrameStoreBytes::append(const FrameStore& store, const Rect& rect,
                             std::vector<std::byte>& bytes) {
    if (rect.empty()) return;
    checkWithin(rect, store.m_area);
    std::size_t at = bytes.size();
    bytes.resize(at + static_cast<std::size_t>(rect.area()) * bytesPerPixel(store));
    forEachRow(store, rect, [&](const auto* row, std::size_t rowBytes) {
        std::memcpy(bytes.data() + at, row, rowBytes);
        at += rowBytes;
    });
}

void FrameStoreBytes::restore(FrameStore& store, const Rect& rect,
                              std::span<const std::byte> bytes) {
    checkWithin(rect, store.m_area);
    const std::size_t wanted = static_cast<std::size_t>(rect.area()) * bytesPerPixel(store);
    if (bytes.size() != wanted) {
        throw Error(Status::kInvalidArgument,
                    fmt::format("sums of {} pixels have {} bytes; they must have {}", rect.area(),
                                bytes.size(), wanted));
    }
    forEachRow(store, rect, [&](auto* row, std::size_t rowBytes) {
        std::memcpy(row, bytes.data(), rowBytes);
        bytes = bytes.subspan(rowBytes);
    });
}

}  // namespace pm
