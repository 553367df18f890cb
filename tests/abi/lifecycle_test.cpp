// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Renders from start to end: callbacks, cancelling at random moments, destroying, two at once.
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "tests/abi/host.h"

namespace pm::test {

namespace {

// What came through the callbacks of one render, and whether the rules held.
struct Log {
    std::atomic<int> inside{0};
    std::atomic<bool> overlapped{false};
    std::atomic<int> finishedCount{0};
    std::atomic<int> callsAfterFinished{0};
    std::atomic<int> progressCount{0}, bucketsStarted{0}, bucketsFinished{0}, messages{0};
    std::atomic<bool> progressFell{false};
    std::atomic<double> lastFraction{0};
    std::atomic<PmrStatus> status{1};
    std::atomic<PmrRender> render{nullptr};
    // What to try inside callbacks.
    std::atomic<bool> cancelInBucket{false}, callForbidden{false};
    std::atomic<int> wrongAnswers{0};
    std::chrono::microseconds slowness{0};
    std::thread::id finishedOn;
};

class Inside {
  public:
    Inside(void* user, PmrRender render) : m_log(*static_cast<Log*>(user)) {
        if (m_log.inside++ != 0) m_log.overlapped = true;
        if (m_log.finishedCount != 0) ++m_log.callsAfterFinished;
        m_log.render = render;
        if (m_log.slowness.count() > 0) std::this_thread::sleep_for(m_log.slowness);
        if (!m_log.callForbidden) return;
        for (const PmrStatus answer : {api().waitRender(render, 1.0), api().pollRender(render, 1.0),
                                       api().destroyRender(render)})
            if (answer != PMR_ERROR_IN_CALLBACK) ++m_log.wrongAnswers;
        std::int32_t state = 0;
        PmrStatus status = 0;
        float pixel[4];
        const PmrRectangle one = {3, 3, 4, 4};
        for (const PmrStatus answer : {api().renderState(render, &state, &status),
                                       api().readPixels(render, &one, "beauty", pixel, 0, 0)})
            if (answer != PMR_OK) ++m_log.wrongAnswers;
    }
    ~Inside() { --m_log.inside; }
    Log* operator->() { return &m_log; }

  private:
    Log& m_log;
};

void onMessage(void* user, PmrRender render, std::int32_t, std::int32_t, const char*) {
    ++Inside(user, render)->messages;
}
void onProgress(void* user, PmrRender render, double fraction, double) {
    Inside log(user, render);
    ++log->progressCount;
    if (!(fraction >= log->lastFraction && fraction <= 1.0)) log->progressFell = true;
    log->lastFraction = fraction;
}
void onBucketStarted(void* user, PmrRender render, const PmrBucketInfo*) {
    ++Inside(user, render)->bucketsStarted;
}
void onBucketFinished(void* user, PmrRender render, const PmrBucketInfo* bucket) {
    Inside log(user, render);
    ++log->bucketsFinished;
    if (bucket->bucketIndex >= bucket->bucketCount || bucket->passIndex >= bucket->passCount ||
        bucket->sampleCount == 0)
        ++log->wrongAnswers;
    if (log->cancelInBucket) {
        if (api().cancelRender(render) != PMR_OK) ++log->wrongAnswers;
        if (api().cancelRender(render) != PMR_OK) ++log->wrongAnswers;
    }
}
void onFinished(void* user, PmrRender render, PmrStatus status) {
    Inside log(user, render);
    log->status = status;
    log->finishedOn = std::this_thread::get_id();
    ++log->finishedCount;
}

PmrRenderDesc descFor(Log& log, std::int32_t mode) {
    PmrRenderDesc desc = PMR_INIT(PmrRenderDesc);
    desc.callbackMode = mode;
    desc.user = &log;
    desc.message = onMessage;
    desc.progress = onProgress;
    desc.bucketStarted = onBucketStarted;
    desc.bucketFinished = onBucketFinished;
    desc.finished = onFinished;
    return desc;
}

void expectRulesHeld(const Log& log) {
    EXPECT_FALSE(log.overlapped);
    EXPECT_EQ(1, log.finishedCount);
    EXPECT_EQ(0, log.callsAfterFinished);
    EXPECT_FALSE(log.progressFell);
    EXPECT_EQ(0, log.wrongAnswers);
}

TEST(Lifecycle, CallbacksFromAThread) {
    const BoxHost host;
    Log log;
    log.callForbidden = true;
    const PmrRenderDesc desc = descFor(log, PMR_CALLBACKS_THREAD);
    const PmrRender render = host.makeRender({{"bucketSize", "8"}}, &desc);
    EXPECT_EQ(PMR_ERROR_STATE, api().waitRender(render, 0.0));
    EXPECT_EQ(PMR_OK, api().startRender(render));
    EXPECT_EQ(PMR_ERROR_STATE, api().startRender(render));
    EXPECT_EQ(PMR_ERROR_STATE, api().setSettingInteger(render, "passes", 3));
    EXPECT_EQ(PMR_ERROR_STATE, api().pollRender(render, 0.0));
    EXPECT_EQ(PMR_OK, api().waitRender(render, -1.0));
    expectRulesHeld(log);
    EXPECT_EQ(PMR_OK, log.status);
    EXPECT_EQ(1.0, log.lastFraction);
    EXPECT_GE(log.bucketsFinished, 9 * 7);
    EXPECT_NE(std::this_thread::get_id(), log.finishedOn);
    std::int32_t state = 0;
    PmrStatus status = 1;
    EXPECT_EQ(PMR_OK, api().renderState(render, &state, &status));
    EXPECT_EQ(PMR_RENDER_FINISHED, state);
    EXPECT_EQ(PMR_OK, status);
    EXPECT_EQ(PMR_OK, api().cancelRender(render));
    EXPECT_EQ(PMR_OK, api().waitRender(render, 0.0));  // cancelling a finished one changes nothing
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
    expectRulesHeld(log);
}

TEST(Lifecycle, CallbacksFromPolling) {
    const BoxHost host;
    Log log;
    log.callForbidden = true;
    const PmrRenderDesc desc = descFor(log, PMR_CALLBACKS_POLL);
    const PmrRender render = host.makeRender({}, &desc);
    EXPECT_EQ(PMR_ERROR_STATE, api().pollRender(render, 0.0));
    EXPECT_EQ(PMR_OK, api().startRender(render));
    EXPECT_EQ(PMR_OK, api().waitRender(render, -1.0));
    EXPECT_EQ(0, log.progressCount + log.finishedCount);  // only polling delivers
    PmrStatus status = PMR_OK;
    while ((status = api().pollRender(render, 1.0)) == PMR_OK) {
    }
    EXPECT_EQ(PMR_ERROR_STATE, status);
    expectRulesHeld(log);
    EXPECT_EQ(std::this_thread::get_id(), log.finishedOn);
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
    expectRulesHeld(log);
}

// The library measures them: events that a slow host gets late, merged or not at all take none.
TEST(Lifecycle, BucketTimesReachAHostThatIsLate) {
    constexpr std::uint32_t kPasses = 3;
    struct Told {
        double seconds = 0;
        std::vector<std::uint32_t> timedPasses;
    } told;
    const BoxHost host;
    PmrRenderDesc desc = PMR_INIT(PmrRenderDesc);
    desc.callbackMode = PMR_CALLBACKS_POLL;
    desc.user = &told;
    desc.bucketFinished = [](void* user, PmrRender, const PmrBucketInfo* info) {
        EXPECT_GT(info->seconds, 0.0);
        static_cast<Told*>(user)->seconds += info->seconds;
        static_cast<Told*>(user)->timedPasses.push_back(info->timedPasses);
    };
    const PmrRender render = host.makeRender(
        {{"bucketSize", "8"}, {"passes", std::to_string(kPasses)}, {"threads", "2"}}, &desc);
    const auto begun = std::chrono::steady_clock::now();
    EXPECT_EQ(PMR_OK, api().startRender(render));
    EXPECT_EQ(PMR_OK, api().waitRender(render, -1.0));
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begun;
    while (api().pollRender(render, 1.0) == PMR_OK) {
    }
    EXPECT_EQ(std::vector<std::uint32_t>(9 * 7, kPasses), told.timedPasses);
    EXPECT_LT(told.seconds, 2 * elapsed.count());  // two workers, a bucket each at a time
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
}

TEST(Lifecycle, TwoThreadsPollOneRender) {
    const BoxHost host;
    Log log;
    log.slowness = std::chrono::microseconds(200);
    const PmrRenderDesc desc = descFor(log, PMR_CALLBACKS_POLL);
    const PmrRender render = host.makeRender({{"bucketSize", "8"}}, &desc);
    EXPECT_EQ(PMR_OK, api().startRender(render));
    const auto poll = [&] {
        while (api().pollRender(render, 20.0) == PMR_OK) {
        }
    };
    std::thread other(poll);
    poll();
    other.join();
    expectRulesHeld(log);
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
}

TEST(Lifecycle, DestroyWhileRunningDeliversFinished) {
    const BoxHost host;
    for (const std::int32_t mode : {PMR_CALLBACKS_THREAD, PMR_CALLBACKS_POLL}) {
        Log log;
        const PmrRenderDesc desc = descFor(log, mode);
        const PmrRender render = host.makeRender({{"passes", "100000"}}, &desc);
        EXPECT_EQ(PMR_OK, api().startRender(render));
        std::this_thread::sleep_for(std::chrono::milliseconds(30));
        EXPECT_EQ(PMR_OK, api().destroyRender(render));
        expectRulesHeld(log);
        EXPECT_EQ(PMR_ERROR_CANCELLED, log.status);
        if (mode == PMR_CALLBACKS_POLL) {
            EXPECT_EQ(0, log.progressCount + log.bucketsStarted + log.bucketsFinished);  // dropped
        }
        EXPECT_EQ(PMR_ERROR_HANDLE, api().destroyRender(render));
        EXPECT_EQ(PMR_ERROR_HANDLE, api().cancelRender(render));
    }
}

TEST(Lifecycle, DestroyWithoutStartCallsNothing) {
    const BoxHost host;
    Log log;
    const PmrRenderDesc desc = descFor(log, PMR_CALLBACKS_THREAD);
    EXPECT_EQ(PMR_OK, api().destroyRender(host.makeRender({}, &desc)));
    EXPECT_EQ(0, log.finishedCount);
}

TEST(Lifecycle, CancelBeforeStartHolds) {
    const BoxHost host;
    const PmrRender render = host.makeRender({{"passes", "100000"}});
    EXPECT_EQ(PMR_OK, api().cancelRender(render));
    EXPECT_EQ(PMR_OK, api().startRender(render));
    EXPECT_EQ(PMR_ERROR_CANCELLED, api().waitRender(render, 20.0));
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
}

TEST(Lifecycle, CancelInsideCallback) {
    const BoxHost host;
    Log log;
    log.cancelInBucket = true;
    const PmrRenderDesc desc = descFor(log, PMR_CALLBACKS_THREAD);
    const PmrRender render = host.makeRender({{"passes", "100000"}}, &desc);
    EXPECT_EQ(PMR_OK, api().startRender(render));
    EXPECT_EQ(PMR_ERROR_CANCELLED, api().waitRender(render, 20.0));
    expectRulesHeld(log);
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
}

TEST(Lifecycle, CancelAtRandomMoments) {
    const BoxHost host;
    std::mt19937 random(20240607);
    for (int i = 0; i < 40; ++i) {
        Log log;
        const PmrRenderDesc desc =
            descFor(log, i % 2 == 0 ? PMR_CALLBACKS_THREAD : PMR_CALLBACKS_POLL);
        const PmrRender render = host.makeRender({{"passes", "100000"}}, &desc);
        ASSERT_EQ(PMR_OK, api().startRender(render));
        const auto moment = std::chrono::microseconds(random() % 40000);
        const auto cancel = [&] {
            std::this_thread::sleep_for(moment);
            EXPECT_EQ(PMR_OK, api().cancelRender(render));
            EXPECT_EQ(PMR_OK, api().cancelRender(render));
        };
        std::thread first(cancel), second(cancel);
        if (i % 2 == 1)
            while (api().pollRender(render, 20.0) == PMR_OK) {
            }
        EXPECT_EQ(PMR_ERROR_CANCELLED, api().waitRender(render, 20.0));
        first.join();
        second.join();
        EXPECT_EQ(PMR_OK, api().destroyRender(render));
        expectRulesHeld(log);
    }
}

// What was delivered before the cancel stays and is whole: each pixel has none or all of a pass.
TEST(Lifecycle, CancelLeavesWholePasses) {
    const BoxHost host;
    Log log;
    log.cancelInBucket = true;
    const PmrRenderDesc desc = descFor(log, PMR_CALLBACKS_THREAD);
    const PmrRender render =
        host.makeRender({{"passes", "4"}, {"aaLevel", "2"}, {"layers", "samples"}}, &desc);
    EXPECT_EQ(PMR_OK, api().startRender(render));
    api().waitRender(render, 20.0);
    const PmrRectangle whole = {0, 0, kWidth, kHeight};
    const std::vector<float> samples = readLayer(render, "samples", 1, whole);
    const std::vector<float> beauty = readLayer(render, "beauty", 4, whole);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        EXPECT_EQ(samples[i], std::floor(samples[i]));
        if (samples[i] == 0.0f) {
            for (std::size_t c = 0; c < 4; ++c) EXPECT_EQ(0.0f, beauty[4 * i + c]);
        }
    }
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
}

TEST(Lifecycle, SlowHostStopsNobody) {
    const BoxHost host;
    Log log;
    log.slowness = std::chrono::milliseconds(20);
    const PmrRenderDesc desc = descFor(log, PMR_CALLBACKS_THREAD);
    const PmrRender render =
        host.makeRender({{"bucketSize", "8"}, {"passes", "20"}, {"aaLevel", "1"}}, &desc);
    EXPECT_EQ(PMR_OK, api().startRender(render));
    EXPECT_EQ(PMR_OK, api().waitRender(render, -1.0));
    expectRulesHeld(log);
    // 20 passes of 63 buckets, but what was not taken in time was merged.
    EXPECT_LT(log.bucketsFinished, 20 * 63);
    EXPECT_GE(log.bucketsFinished, 63);
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
}

TEST(Lifecycle, TwoContextsAtOnce) {
    const BoxHost first, second;
    const std::vector<float> alone = renderBox(first, {});
    std::vector<float> a, b, c;
    std::thread one([&] { a = renderBox(first, {}); });
    std::thread two([&] { b = renderBox(second, {}); });
    std::thread three([&] { c = renderBox(first, {{"seed", "5"}}); });
    one.join();
    two.join();
    three.join();
    EXPECT_EQ(alone, a);
    EXPECT_EQ(alone, b);
    EXPECT_NE(alone, c);
}

TEST(Lifecycle, ReleasedContextLivesUntilItsRendersEnd) {
    PmrRender render = nullptr;
    {
        const BoxHost host;
        render = host.makeRender({});
        EXPECT_EQ(PMR_OK, api().startRender(render));
    }  // scene and context released while it runs
    EXPECT_EQ(PMR_OK, api().waitRender(render, -1.0));
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
}

}  // namespace

}  // namespace pm::test
