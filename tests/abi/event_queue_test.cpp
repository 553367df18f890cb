// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What waits for a slow host is bounded, and merged in an order that makes sense.
#include "plugin/src/event_queue.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace pm::plugin {

namespace {

using Calls = std::vector<std::string>;

Calls& callsOf(void* user) {
    return *static_cast<Calls*>(user);
}

PmrRenderDesc sinksFor(Calls& calls) {
    PmrRenderDesc desc = PMR_INIT(PmrRenderDesc);
    desc.user = &calls;
    desc.message = [](void* user, PmrRender, std::int32_t, std::int32_t, const char* text) {
        callsOf(user).push_back(text);
    };
    desc.progress = [](void* user, PmrRender, double fraction, double) {
        callsOf(user).push_back("progress " + std::to_string(std::lround(fraction * 100)));
    };
    desc.bucketStarted = [](void* user, PmrRender, const PmrBucketInfo* bucket) {
        callsOf(user).push_back("start " + std::to_string(bucket->bucketIndex));
    };
    desc.bucketFinished = [](void* user, PmrRender, const PmrBucketInfo* bucket) {
        callsOf(user).push_back("done " + std::to_string(bucket->bucketIndex) + " pass " +
                                std::to_string(bucket->passIndex));
    };
    desc.finished = [](void* user, PmrRender, PmrStatus status) {
        callsOf(user).push_back("finished " + std::to_string(status));
    };
    return desc;
}

PmrBucketInfo bucket(std::uint32_t index, std::uint32_t pass) {
    PmrBucketInfo info = PMR_INIT(PmrBucketInfo);
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
    EventQueue queue(sinksFor(calls));
    queue.open(nullptr);
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
    EventQueue queue(sinksFor(calls));
    queue.open(nullptr);
    for (int i = 0; i < 100000; ++i) queue.message(PMR_LEVEL_INFO, PMR_MESSAGE_PHASE, "m");
    deliverAll(queue);
    EXPECT_EQ(EventQueue::kMaxWaitingMessages, calls.size());
}

TEST(EventQueue, DropsAllButFinished) {
    Calls calls;
    EventQueue queue(sinksFor(calls));
    queue.open(nullptr);
    queue.message(PMR_LEVEL_INFO, 0, "lost");
    queue.bucketFinished(bucket(0, 0));
    queue.finished(PMR_ERROR_CANCELLED);
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
    PmrRenderDesc desc = PMR_INIT(PmrRenderDesc);
    desc.user = &host;
    desc.finished = [](void* user, PmrRender, PmrStatus) {
        ++static_cast<Host*>(user)->finished;
        static_cast<Host*>(user)->queue->dropAllButFinished();
    };
    EventQueue queue(desc);
    host.queue = &queue;
    queue.open(nullptr);
    queue.finished(PMR_OK);
    EXPECT_EQ(EventQueue::Delivery::kDelivered, queue.deliverOne(deadlineAfter(0.0)));
    EXPECT_EQ(EventQueue::Delivery::kOver, queue.deliverOne(deadlineAfter(0.0)));
    EXPECT_EQ(1, host.finished);
}

TEST(EventQueue, NoCallbacksIsFine) {
    EventQueue queue(PMR_INIT(PmrRenderDesc));
    queue.open(nullptr);
    queue.bucketStarted(bucket(0, 0));
    queue.bucketFinished(bucket(0, 0));
    queue.message(0, 0, "");
    queue.progress(0, 0);
    EXPECT_EQ(EventQueue::Delivery::kTimeout, queue.deliverOne(deadlineAfter(0.0)));
    queue.finished(PMR_OK);
    EXPECT_EQ(EventQueue::Delivery::kDelivered, queue.deliverOne(std::nullopt));
    EXPECT_TRUE(queue.waitUntilOver(std::nullopt));
}

}  // namespace

}  // namespace pm::plugin
