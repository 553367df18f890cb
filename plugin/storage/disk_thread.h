// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace pm::plugin {

// Waits for disks, so that nobody who renders does: a sync may take a disk seconds, and nothing
// can interrupt it. One thread, made when it is first needed; work is done in order.
// Threads: all members from any, but the destructor.
class DiskThread {
  public:
    DiskThread() = default;
    // Does what was given before, and joins.
    ~DiskThread();
    DiskThread(const DiskThread&) = delete;
    DiskThread& operator=(const DiskThread&) = delete;

    // What it throws is trouble. Errors: std::system_error where no thread can be made.
    void give(std::function<void()> work);
    bool isIdle() const;
    // Waits until all is done. False when `cancelled` was set before.
    bool waitUntilIdle(const std::atomic<bool>& cancelled);
    // Whether work failed since this was last asked, and why; else empty.
    std::string takeTrouble();

  private:
    void run();
    void doOne(std::unique_lock<std::mutex>& lock);

    mutable std::mutex m_mutex;
    std::condition_variable m_changed;
    std::deque<std::function<void()>> m_work;  // the first is being done
    std::string m_trouble;
    bool m_ends = false;
    std::thread m_thread;
};

}  // namespace pm::plugin
