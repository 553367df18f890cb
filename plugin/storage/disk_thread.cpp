// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/storage/disk_thread.h"

#include <chrono>
#include <exception>
#include <utility>

namespace pm::plugin {

DiskThread::~DiskThread() {
    {
        const std::lock_guard lock(m_mutex);
        m_ends = true;
    }
    m_changed.notify_all();
    if (m_thread.joinable()) m_thread.join();
}

void DiskThread::give(std::function<void()> work) {
    {
        const std::lock_guard lock(m_mutex);
        if (!m_thread.joinable()) m_thread = std::thread([this] { run(); });
        m_work.push_back(std::move(work));
    }
    m_changed.notify_all();
}

bool DiskThread::isIdle() const {
    const std::lock_guard lock(m_mutex);
    return m_work.empty();
}

bool DiskThread::waitUntilIdle(const std::atomic<bool>& cancelled) {
    constexpr std::chrono::milliseconds kBetweenLooks{5};
    std::unique_lock lock(m_mutex);
    while (!m_work.empty()) {
        if (cancelled) return false;
        m_changed.wait_for(lock, kBetweenLooks);
    }
    return true;
}

std::string DiskThread::takeTrouble() {
    const std::lock_guard lock(m_mutex);
    return std::exchange(m_trouble, {});
}

void DiskThread::run() {
    std::unique_lock lock(m_mutex);
    while (true) {
        m_changed.wait(lock, [this] { return m_ends || !m_work.empty(); });
        if (m_work.empty()) return;
        doOne(lock);
    }
}

void DiskThread::doOne(std::unique_lock<std::mutex>& lock) {
    std::function<void()> work = std::move(m_work.front());
    lock.unlock();
    std::string trouble;
    try {
        try {
            work();
        } catch (const std::exception& error) {
            trouble = error.what();
        }
    } catch (...) {
        trouble = "out of memory";  // short enough to need none
    }
    work = nullptr;  // may close a file, which may wait as well
    lock.lock();
    if (m_trouble.empty()) m_trouble = std::move(trouble);
    m_work.pop_front();
    m_changed.notify_all();
}

}  // namespace pm::plugin
