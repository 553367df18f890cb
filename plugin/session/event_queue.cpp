// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/event_queue.h"

#include <algorithm>
#include <utility>

#include "plugin/session/callback_scope.h"

namespace pm::plugin {

Deadline deadlineAfter(double seconds) {
    constexpr double kForEver = 1e9;
    if (seconds < 0.0 || seconds > kForEver) return std::nullopt;
    return std::chrono::steady_clock::now() +
           std::chrono::duration_cast<std::chrono::steady_clock::duration>(
               std::chrono::duration<double>(seconds));
}

void EventQueue::open(DeliveryHooks hooks, bool hasThread) {
    const std::lock_guard lock(m_mutex);
    m_hooks = std::move(hooks);
    if (hasThread && !m_thread) m_thread.emplace();
}

void EventQueue::push(Kind kind, std::uint32_t bucket) {
    m_events.push_back({kind, bucket});
    m_changed.notify_all();
}

void EventQueue::message(MessageLevel level, std::int32_t code, std::string text) {
    const std::lock_guard lock(m_mutex);
    if (!m_listener.message || m_dropping || m_messages.size() >= kMaxWaitingMessages) return;
    m_messages.push_back({level, code, std::move(text)});
    try {
        push(Kind::kMessage);
    } catch (...) {
        m_messages.pop_back();
        throw;
    }
}

void EventQueue::progress(double fraction, double remainingSeconds) {
    const std::lock_guard lock(m_mutex);
    if (!m_listener.progress || m_dropping) return;
    m_fraction = std::max(m_fraction, fraction);
    m_remainingSeconds = remainingSeconds;
    if (m_progressWaits) return;
    push(Kind::kProgress);
    m_progressWaits = true;
}

void EventQueue::bucketStarted(const BucketInfo& bucket) {
    const std::lock_guard lock(m_mutex);
    if (!m_listener.bucketStarted || m_dropping) return;
    Bucket& waiting = m_buckets[bucket.bucketIndex];
    if (waiting.startedWaits || waiting.finishedWaits) return;
    push(Kind::kStarted, bucket.bucketIndex);
    waiting.started = bucket;
    waiting.startedWaits = true;
}

void EventQueue::bucketFinished(const BucketInfo& bucket) {
    const std::lock_guard lock(m_mutex);
    if (!m_listener.bucketFinished || m_dropping) return;
    Bucket& waiting = m_buckets[bucket.bucketIndex];
    if (!waiting.finishedWaits) push(Kind::kFinishedBucket, bucket.bucketIndex);
    waiting.finished = bucket;
    waiting.finishedWaits = true;
}

void EventQueue::finished(CallStatus status) noexcept {
    const std::lock_guard lock(m_mutex);
    m_status = status;
    m_finishedWaits = true;
    m_changed.notify_all();
}

EventQueue::Parcel EventQueue::take() {
    Event event{Kind::kFinished, 0};
    if (!m_events.empty()) {
        event = m_events.front();
        m_events.pop_front();
    }
    Parcel parcel;
    parcel.kind = event.kind;
    switch (event.kind) {
        case Kind::kMessage:
            parcel.message = std::move(m_messages.front());
            m_messages.pop_front();
            break;
        case Kind::kProgress:
            parcel.fraction = m_fraction;
            parcel.remainingSeconds = m_remainingSeconds;
            m_progressWaits = false;
            break;
        case Kind::kStarted:
            parcel.bucket = m_buckets[event.bucket].started;
            m_buckets[event.bucket].startedWaits = false;
            if (!m_buckets[event.bucket].finishedWaits) m_buckets.erase(event.bucket);
            break;
        case Kind::kFinishedBucket:
            parcel.bucket = m_buckets[event.bucket].finished;
            // A start that was told before the end has gone out before it.
            m_buckets.erase(event.bucket);
            break;
        case Kind::kFinished:
            parcel.status = m_status;
            m_finishedWaits = false;
            break;
    }
    return parcel;
}

void EventQueue::call(const Parcel& parcel) const {
    const CallbackScope scope;
    switch (parcel.kind) {
        case Kind::kMessage:
            m_listener.message(parcel.message.level, parcel.message.code, parcel.message.text);
            break;
        case Kind::kProgress:
            m_listener.progress(parcel.fraction, parcel.remainingSeconds);
            break;
        case Kind::kStarted:
            m_listener.bucketStarted(parcel.bucket);
            break;
        case Kind::kFinishedBucket:
            if (m_hooks.before) m_hooks.before(parcel.bucket.bucketIndex);
            m_listener.bucketFinished(parcel.bucket);
            break;
        case Kind::kFinished:
            if (m_listener.finished) m_listener.finished(parcel.status);
            break;
    }
}

// Whether this is still the process that it was before.
bool EventQueue::callHost(const Parcel& parcel) const {
    const Activity activity;
    try {
        call(parcel);
    } catch (...) {
        // A host in C++ must not throw through a C interface; its exception ends here.
    }
    return !activity.isOfParent();
}

bool EventQueue::waitFor(std::unique_lock<std::mutex>& lock, const Deadline& deadline,
                         bool (*ready)(const EventQueue&)) {
    const auto isReady = [this, ready] { return ready(*this); };
    if (deadline) return m_changed.wait_until(lock, *deadline, isReady);
    m_changed.wait(lock, isReady);
    return true;
}

EventQueue::Delivery EventQueue::deliverOne(const Deadline& deadline) {
    std::unique_lock lock(m_mutex);
    const bool ready = waitFor(lock, deadline, [](const EventQueue& queue) {
        const bool waits = !queue.m_events.empty() || queue.m_finishedWaits;
        return queue.m_over || (!queue.m_delivering && waits);
    });
    if (m_over) return Delivery::kOver;
    if (!ready) return Delivery::kTimeout;
    const Parcel parcel = take();
    m_delivering = true;
    lock.unlock();
    if (!callHost(parcel)) return Delivery::kOver;
    if (parcel.kind == Kind::kFinishedBucket && m_hooks.after)
        m_hooks.after(parcel.bucket.bucketIndex);
    endDelivery(parcel.kind);
    return Delivery::kDelivered;
}

void EventQueue::endDelivery(Kind kind) {
    // Whoever has seen the end and forks then has a child that may read the render.
    const auto noFork = holdOffForks();
    const std::lock_guard lock(m_mutex);
    m_delivering = false;
    if (kind == Kind::kFinished) {
        m_over = true;
        m_thread.reset();
    }
    m_changed.notify_all();
}

void EventQueue::dropAllButFinished() {
    const std::lock_guard lock(m_mutex);
    m_dropping = true;
    if (m_over) return;
    m_events.clear();
    m_messages.clear();
    m_buckets.clear();
}

void EventQueue::close() {
    const std::lock_guard lock(m_mutex);
    m_over = true;
    m_thread.reset();
    m_changed.notify_all();
}

bool EventQueue::waitUntilOver(const Deadline& deadline) {
    std::unique_lock lock(m_mutex);
    return waitFor(lock, deadline, [](const EventQueue& queue) { return queue.m_over; });
}

}  // namespace pm::plugin
