// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What waits for a slow host is bounded, and merged in an order that makes sense.
#include "plugin/session/event_queue.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace pm::plugin {

namespace {

using Calls = std::vector<std::string>;

RenderListener listenerFor(Calls& calls) {
    RenderListener listener;
    listener.message = [&](MessageLevel, std::int32_t, const std::string& text) {
        calls.push_back(text);
    };
    listener.progress = [&](double fraction, double) {
        calls.push_back("progress " + std::to_string(std::lround(fraction * 100)));
    };
    listener.bucketStarted = [&](const BucketInfo& bucket) {
        calls.push_back("start " + std::to_string(bucket.bucketIndex));
    };
    listener.bucketFinished = [&](const BucketInfo& bucket) {
        calls.push_back("done " + std::to_string(bucket.bucketIndex) + " pass " +
                        std::to_string(bucket.passIndex));
    };
    listener.finished = [&](CallStatus status) {
        calls.push_back("finished " + std::to_string(static_cast<int>(status)));
    };
    return listener;
}

BucketInfo bucket(std::uint32_t index, std::uint32_t pass) {
    BucketInfo info;
    info.bucketIndex = index;
    info.passIndex = pass;
    return info;
}

void deliverAll(EventQueue& queue) {
    while (queue.deliverOne(deadlineAfter(0.0)) == EventQueue::Delivery::kDelivered) {
    }
}

TEST(EventQueue, MergesWhatWaits) {
    Calls calls;
    EventQueue queue(listenerFor(calls));
    queue.open({});
    for (std::uint32_t pass = 0; pass < 1000; ++pass)
        for (std::uint32_t i = 0; i < 2; ++i) {
            queue.bucketStarted(bucket(i, pass));
            queue.bucketFinished(bucket(i, pass));
            queue.progress((pass + 0.5 * i) / 1000, 1.0);
        }
    queue.progress(0.1, 1.0);  // a worker that was late
    deliverAll(queue);
    EXPECT_EQ((Calls{"start 0", "done 0 pass 999", "progress 100", "start 1", "done 1 pass 999"}),
              calls);
}

TEST(EventQueue, MessagesAreBounded) {
    Calls calls;
    EventQueue queue(listenerFor(calls));
    queue.open({});
    for (int i = 0; i < 100000; ++i) queue.message(MessageLevel::kInfo, kMessagePhase, "m");
    deliverAll(queue);
    EXPECT_EQ(EventQueue::kMaxWaitingMessages, calls.size());
}

TEST(EventQueue, DropsAllButFinished) {
    Calls calls;
    EventQueue queue(listenerFor(calls));
    queue.open({});
    queue.message(MessageLevel::kInfo, 0, "lost");
    queue.bucketFinished(bucket(0, 0));
    queue.finished(CallStatus::kCancelled);
    queue.dropAllButFinished();
    queue.progress(0.5, 1.0);
    deliverAll(queue);
    queue.dropAllButFinished();
    EXPECT_EQ(EventQueue::Delivery::kOver, queue.deliverOne(deadlineAfter(0.0)));
    EXPECT_EQ(Calls{"finished -9"}, calls);
}

// A host may destroy a render from one thread while another is inside `finished`.
TEST(EventQueue, FinishedOnceWhenDroppedInsideIt) {
    struct Host {
        EventQueue* queue = nullptr;
        int finished = 0;
    } host;
    RenderListener listener;
    listener.finished = [&host](CallStatus) {
        ++host.finished;
        host.queue->dropAllButFinished();
    };
    EventQueue queue(listener);
    host.queue = &queue;
    queue.open({});
    queue.finished(CallStatus::kOk);
    EXPECT_EQ(EventQueue::Delivery::kDelivered, queue.deliverOne(deadlineAfter(0.0)));
    EXPECT_EQ(EventQueue::Delivery::kOver, queue.deliverOne(deadlineAfter(0.0)));
    EXPECT_EQ(1, host.finished);
}

TEST(EventQueue, NoCallbacksIsFine) {
    EventQueue queue(RenderListener{});
    queue.open({});
    queue.bucketStarted(bucket(0, 0));
    queue.bucketFinished(bucket(0, 0));
    queue.message(MessageLevel::kDebug, 0, "");
    queue.progress(0, 0);
    EXPECT_EQ(EventQueue::Delivery::kTimeout, queue.deliverOne(deadlineAfter(0.0)));
    queue.finished(CallStatus::kOk);
    EXPECT_EQ(EventQueue::Delivery::kDelivered, queue.deliverOne(std::nullopt));
    EXPECT_TRUE(queue.waitUntilOver(std::nullopt));
}

}  // namespace

}  // namespace pm::plugin
