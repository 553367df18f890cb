// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/bucket_shelf.h"

#include <chrono>
#include <utility>

namespace pm::plugin {

BucketShelf::BucketShelf(std::uint32_t bucketCount, std::uint32_t most)
    : m_count(bucketCount), m_slots(most) {}

std::uint32_t BucketShelf::draw(const std::atomic<bool>& cancelled) {
    // Who cancels knows nothing of those who wait here.
    constexpr std::chrono::milliseconds kLook{20};
    std::unique_lock lock(m_mutex);
    while (true) {
        if (m_closed || m_drawn == m_count || cancelled.load(std::memory_order_acquire))
            return m_count;
        if (m_drawn - m_released < m_slots.size()) return m_drawn++;
        m_changed.wait_for(lock, kLook);
    }
}

void BucketShelf::put(std::uint32_t place, std::shared_ptr<FrameStore> pixels) {
    const std::lock_guard lock(m_mutex);
    slot(place) = {std::move(pixels), {}, false};
}

FrameStore& BucketShelf::pixels(std::uint32_t place) const {
    const std::lock_guard lock(m_mutex);
    return *m_slots[place % m_slots.size()].pixels;
}

void BucketShelf::finish(const BucketInfo& info,
                         const std::function<void(const BucketInfo&)>& tell) {
    const std::lock_guard lock(m_mutex);
    Slot& finished = slot(info.bucketIndex);
    finished.info = info;
    finished.done = true;
    while (m_told < m_drawn && slot(m_told).done) {
        slot(m_told).done = false;
        tell(slot(m_told++).info);
    }
}

void BucketShelf::close() {
    const std::lock_guard lock(m_mutex);
    m_closed = true;
    m_changed.notify_all();
}

void BucketShelf::show(std::uint32_t place) {
    const std::lock_guard lock(m_mutex);
    m_shown = slot(place).pixels;
}

void BucketShelf::release(std::uint32_t place) {
    std::shared_ptr<FrameStore> gone;  // its memory is given back after the lock
    const std::lock_guard lock(m_mutex);
    m_shown.reset();
    gone = std::move(slot(place).pixels);
    m_released = place + 1;
    m_changed.notify_all();
}

std::shared_ptr<const FrameStore> BucketShelf::shown() const {
    const std::lock_guard lock(m_mutex);
    return m_shown;
}

}  // namespace pm::plugin
