// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>

#include "plugin/session/render_listener.h"
#include "plugin/values/forks.h"

namespace pm::plugin {

// A point in time to wait for; nothing = for ever.
using Deadline = std::optional<std::chrono::steady_clock::time_point>;

// From a host's timeout: negative or very long means for ever. seconds must not be NaN.
Deadline deadlineAfter(double seconds);

// What a render has to tell its host, between the workers that never wait and the callbacks that
// come one at a time. Its size is bounded however slow the host is: progress and what comes again
// for a bucket overwrite what was not delivered yet, and so at most two entries a bucket wait.
// Only `finished` and messages always arrive (messages: the first kMaxWaitingMessages waiting;
// those beyond are counted, and the statistics count warnings anyway). Threads: every member may be
// called from any thread at any time.
class EventQueue {
  public:
    static constexpr std::size_t kMaxWaitingMessages = 1000;

    explicit EventQueue(RenderListener listener) : m_listener(std::move(listener)) {}

    // Called with a bucket's index before and after bucketFinished, on the thread that delivers.
    struct DeliveryHooks {
        std::function<void(std::uint32_t bucketIndex)> before, after;
    };
    // Before the first event. hasThread: one of the library's delivers, until it is over.
    void open(DeliveryHooks hooks, bool hasThread = false);

    void message(MessageLevel level, std::int32_t code, std::string text);
    void progress(double fraction, double remainingSeconds);
    // A bucket that begins is not told where an earlier event of it still waits.
    void bucketStarted(const BucketInfo& bucket);
    void bucketFinished(const BucketInfo& bucket);
    // The last event; once. It needs no memory, as all the others do (std::bad_alloc).
    void finished(CallStatus status) noexcept;

    enum class Delivery { kDelivered, kTimeout, kOver };
    // Waits for an event until the deadline and calls the host with it, on the calling thread.
    // kOver: `finished` has returned before, or the host has forked inside the callback and this
    // is the child, where nothing else comes.
    Delivery deliverOne(const Deadline& deadline);

    // Drops what waits but `finished`, and takes nothing else from now on.
    void dropAllButFinished();
    // Nothing was begun, and nothing will come: as if it were over.
    void close();
    bool waitUntilOver(const Deadline& deadline);

  private:
    enum class Kind : std::uint8_t { kMessage, kProgress, kStarted, kFinishedBucket, kFinished };
    struct Event {
        Kind kind;
        std::uint32_t bucket;
    };
    struct Message {
        MessageLevel level = MessageLevel::kInfo;
        std::int32_t code = 0;
        std::string text;
    };
    struct Bucket {
        BucketInfo started{}, finished{};
        bool startedWaits = false, finishedWaits = false;
    };
    // An event with all that the callback needs, taken out of the queue.
    struct Parcel {
        Kind kind = Kind::kFinished;
        Message message{};
        double fraction = 0, remainingSeconds = 0;
        BucketInfo bucket{};
        CallStatus status = CallStatus::kOk;
    };

    void push(Kind kind, std::uint32_t bucket = 0);
    Parcel take();
    void call(const Parcel& parcel) const;
    bool callHost(const Parcel& parcel) const;
    void endDelivery(Kind kind);
    bool waitFor(std::unique_lock<std::mutex>& lock, const Deadline& deadline,
                 bool (*ready)(const EventQueue&));

    const RenderListener m_listener;
    mutable std::mutex m_mutex;
    std::condition_variable m_changed;
    std::deque<Event> m_events;
    std::deque<Message> m_messages;
    std::unordered_map<std::uint32_t, Bucket> m_buckets;  // that an event waits of
    DeliveryHooks m_hooks;
    std::optional<Activity> m_thread;  // of the thread that delivers
    double m_fraction = 0, m_remainingSeconds = 0;
    bool m_progressWaits = false;
    CallStatus m_status = CallStatus::kOk;
    bool m_dropping = false;
    bool m_finishedWaits = false;  // behind all of m_events
    bool m_delivering = false;     // a callback is running
    bool m_over = false;           // `finished` has returned
};

}  // namespace pm::plugin
