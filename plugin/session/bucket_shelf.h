// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "plugin/session/bucket_info.h"
#include "scheduler/film/frame_store.h"

namespace pm::plugin {

// The buckets of a render by buckets that are in work, or done and waiting for the host: each with
// its pixels, and no more than a fixed number. They begin in the order, and the host gets them in
// the order; a bucket's pixels can be read while the host is called back for it, and are gone
// after.
// Threads: every member from any, at once.
class BucketShelf {
  public:
    // most: buckets that are held at once, >= 1.
    BucketShelf(std::uint32_t bucketCount, std::uint32_t most);

    // The place in the order of the bucket to begin next; waits while as many as may be are held.
    // The number of buckets where none is left, after close(), or soon after `cancelled` is set.
    std::uint32_t draw(const std::atomic<bool>& cancelled);
    // The pixels of a bucket that was drawn.
    void put(std::uint32_t place, std::shared_ptr<FrameStore> pixels);
    FrameStore& pixels(std::uint32_t place) const;
    // A bucket is done. Calls tell(info) for it and those that waited for it, in the order; one
    // call at a time.
    void finish(const BucketInfo& info, const std::function<void(const BucketInfo&)>& tell);
    // No bucket is to begin any more.
    void close();

    // The host is called back for a bucket: its pixels are those that can be read.
    void show(std::uint32_t place);
    // The host has returned.
    void release(std::uint32_t place);
    // Null where the host is not being called back for a bucket.
    std::shared_ptr<const FrameStore> shown() const;

  private:
    struct Slot {
        std::shared_ptr<FrameStore> pixels;
        BucketInfo info{};
        bool done = false;
    };
    Slot& slot(std::uint32_t place) { return m_slots[place % m_slots.size()]; }

    const std::uint32_t m_count;
    mutable std::mutex m_mutex;  // of what follows
    std::condition_variable m_changed;
    std::vector<Slot> m_slots;                              // by place, of those from m_released on
    std::uint32_t m_drawn = 0, m_told = 0, m_released = 0;  // places before these are
    bool m_closed = false;
    std::shared_ptr<const FrameStore> m_shown;
};

}  // namespace pm::plugin
