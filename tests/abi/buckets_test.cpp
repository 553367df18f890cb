// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Renders that deliver bucket by bucket: the bits of the whole frame, a bounded number of buckets
// that wait, and no deadlock whatever the host does.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <functional>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/abi/host.h"

namespace pm::test {

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using Settings = std::map<std::string, std::string>;

constexpr const char* kLayers = "albedo,N,Z,stderr,samples,aalevel";
const std::map<std::string, std::uint32_t> kChannels = {
    {"beauty", 4}, {"direct", 3}, {"indirect", 3}, {"caustic", 3}, {"emission", 3}, {"albedo", 3},
    {"N", 3},      {"Z", 1},      {"stderr", 3},   {"samples", 1}, {"aalevel", 1},
};
using Picture = std::map<std::string, std::vector<float>>;

// A host that puts buckets together.
struct Taker {
    PmrRectangle window{0, 0, kWidth, kHeight};
    Picture picture;
    std::vector<std::uint32_t> finished;  // bucketIndex, as they came
    std::atomic<std::uint32_t> begun{0};
    std::uint32_t mostWaiting = 0;
    double samples = 0;
    std::function<void(PmrRender)> also;  // in each bucketFinished
    std::atomic<int> ends{0};
    std::atomic<double> fraction{0};
    bool fell = false;

    PmrRenderDesc desc(std::int32_t mode) {
        PmrRenderDesc desc = PMR_INIT(PmrRenderDesc);
        desc.callbackMode = mode;
        desc.user = this;
        desc.bucketStarted = [](void* user, PmrRender, const PmrBucketInfo*) {
            ++static_cast<Taker*>(user)->begun;
        };
        desc.bucketFinished = [](void* user, PmrRender render, const PmrBucketInfo* info) {
            static_cast<Taker*>(user)->take(render, *info);
        };
        desc.progress = [](void* user, PmrRender, double fraction, double) {
            auto* taker = static_cast<Taker*>(user);
            taker->fell |= !(fraction >= taker->fraction && fraction <= 1);
            taker->fraction = fraction;
        };
        desc.finished = [](void* user, PmrRender, PmrStatus) { ++static_cast<Taker*>(user)->ends; };
        return desc;
    }

    void take(PmrRender render, const PmrBucketInfo& info) {
        finished.push_back(info.bucketIndex);
        EXPECT_EQ(info.passIndex + 1, info.passCount);
        EXPECT_EQ(info.timedPasses, info.passCount);
        EXPECT_GT(info.seconds, 0.0);
        samples += static_cast<double>(info.sampleCount);
        const auto width = static_cast<std::size_t>(window.x1 - window.x0);
        for (const auto& [layer, channels] : kChannels) {
            std::vector<float>& all = picture[layer];
            all.resize(width * static_cast<std::size_t>(window.y1 - window.y0) * channels, -7.0f);
            const PmrRectangle& r = info.rectangle;
            float* first = all.data() + (static_cast<std::size_t>(r.y0 - window.y0) * width +
                                         static_cast<std::size_t>(r.x0 - window.x0)) *
                                            channels;
            EXPECT_EQ(PMR_OK, api().readPixels(render, &r, layer.c_str(), first, 0,
                                               static_cast<std::int64_t>(width * channels * 4)));
        }
        if (also) also(render);
    }
};

class Buckets : public ::testing::Test {
  protected:
    PmrRender make(Taker& taker, std::int32_t mode, Settings settings) {
        settings.try_emplace("layers", kLayers);
        const PmrRenderDesc desc = taker.desc(mode);
        return m_host.makeRender(settings, &desc);
    }
    static void pollToEnd(PmrRender render, const Taker& taker) {
        while (taker.ends == 0) {
            const PmrStatus status = api().pollRender(render, 1.0);
            ASSERT_TRUE(status == PMR_OK || status == PMR_ERROR_TIMEOUT);
        }
    }
    static nlohmann::json statistics(PmrRender render) {
        return nlohmann::json::parse(
            textOf([&](char* buffer, std::uint64_t capacity, std::uint64_t* needed) {
                return api().renderStatistics(render, buffer, capacity, needed);
            }));
    }
    std::string explained(PmrRender render) const {
        return textOf([&](char* buffer, std::uint64_t capacity, std::uint64_t* needed) {
            return api().explainRender(render, buffer, capacity, needed);
        });
    }
    static std::int32_t delivery(PmrRender render) {
        std::int32_t found = -1;
        EXPECT_EQ(PMR_OK, api().renderDelivery(render, &found));
        return found;
    }
    // The whole frame, read at the end.
    Picture whole(Settings settings, const PmrRectangle& window, nlohmann::json* json) {
        settings.try_emplace("layers", kLayers);
        settings["delivery"] = "frame";
        const PmrRender render = m_host.makeRender(settings);
        EXPECT_EQ(PMR_OK, api().startRender(render)) << m_host.lastError();
        EXPECT_EQ(PMR_OK, api().waitRender(render, -1.0));
        Picture picture;
        for (const auto& [layer, channels] : kChannels)
            picture[layer] = readLayer(render, layer.c_str(), channels, window);
        *json = statistics(render);
        EXPECT_EQ(PMR_OK, api().destroyRender(render));
        return picture;
    }
    void expectSameBits(const Settings& settings, std::int32_t mode, const PmrRectangle& window,
                        const Picture& wanted, nlohmann::json* json);

    BoxHost m_host;
};

void Buckets::expectSameBits(const Settings& settings, std::int32_t mode,
                             const PmrRectangle& window, const Picture& wanted,
                             nlohmann::json* json) {
    Taker taker;
    taker.window = window;
    Settings byBuckets = settings;
    byBuckets["delivery"] = "buckets";
    const PmrRender render = make(taker, mode, byBuckets);
    EXPECT_EQ(PMR_DELIVERY_BUCKETS, delivery(render));
    ASSERT_EQ(PMR_OK, api().startRender(render)) << m_host.lastError();
    if (mode == PMR_CALLBACKS_POLL)
        pollToEnd(render, taker);
    else
        EXPECT_EQ(PMR_OK, api().waitRender(render, -1.0));
    EXPECT_EQ(1, taker.ends);
    EXPECT_FALSE(taker.fell);
    EXPECT_EQ(1.0, taker.fraction);
    for (const auto& [layer, pixels] : wanted) {
        const std::vector<float>& found = taker.picture[layer];
        ASSERT_EQ(pixels.size(), found.size());
        EXPECT_EQ(0, std::memcmp(pixels.data(), found.data(), pixels.size() * sizeof(float)))
            << layer;
    }
    // Each once, in the order, and nothing can be read any more.
    for (std::uint32_t i = 0; i < taker.finished.size(); ++i) EXPECT_EQ(i, taker.finished[i]);
    EXPECT_EQ(taker.begun, taker.finished.size());
    const auto& samples = taker.picture["samples"];
    double sum = 0;
    for (const float count : samples) sum += static_cast<double>(count);
    EXPECT_NEAR(sum, taker.samples, static_cast<double>(taker.finished.size()));
    float pixel[4] = {};
    const PmrRectangle one{0, 0, 1, 1};
    EXPECT_EQ(PMR_ERROR_STATE, api().readPixels(render, &one, "beauty", pixel, 0, 0));
    *json = statistics(render);
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
}

TEST_F(Buckets, SameBitsAsTheWholeFrame) {
    const PmrRectangle frame{0, 0, kWidth, kHeight}, crop{-3, 5, 50, 51};
    const std::vector<std::pair<Settings, PmrRectangle>> pictures = {
        {{{"passes", "5"}, {"aaLevel", "1"}, {"aaLevelMost", "3"}}, frame},
        {{{"passes", "4"}, {"aaLevel", "1"}, {"aaLevelMost", "1"}}, frame},
        {{{"passes", "3"}, {"aaLevelMost", "2"}, {"aaLevel", "2"}, {"crop", "-3,5,50,51"}}, crop},
    };
    const std::vector<Settings> ways = {
        {{"threads", "1"}},
        {{"threads", "3"}, {"bucketOrder", "random"}, {"bucketSize", "8"}},
        {{"threads", "2"}, {"bucketOrder", "spiral"}, {"bucketSize", "40"}},
    };
    std::int32_t mode = PMR_CALLBACKS_THREAD;
    for (const auto& [settings, window] : pictures) {
        nlohmann::json ofWhole, of;
        const Picture wanted = whole(settings, window, &ofWhole);
        EXPECT_EQ("frame", ofWhole["delivery"]);
        for (const Settings& way : ways) {
            Settings all = settings;
            for (const auto& [name, value] : way) all[name] = value;
            mode = PMR_CALLBACKS_THREAD + PMR_CALLBACKS_POLL - mode;
            expectSameBits(all, mode, window, wanted, &of);
            EXPECT_EQ("buckets", of["delivery"]);
            EXPECT_EQ("passes done", of["stopReason"]);
            EXPECT_EQ(ofWhole["passesDone"], of["passesDone"]);
            EXPECT_EQ(ofWhole["counters"]["cameraSamples"], of["counters"]["cameraSamples"]);
            EXPECT_EQ(ofWhole["counters"]["photonsEmitted"], of["counters"]["photonsEmitted"]);
            // A single sample in four passes tells nothing of its error.
            ASSERT_EQ(ofWhole["relMseEstimateNoise"].is_null(),
                      of["relMseEstimateNoise"].is_null());
            if (of["relMseEstimateNoise"].is_null()) continue;
            // Fewer neighbours at the buckets' borders, which half of the pixels of buckets of 8
            // are at: near, not the same.
            const double ratio = of["relMseEstimateNoise"].get<double>() /
                                 ofWhole["relMseEstimateNoise"].get<double>();
            const double most = all.contains("bucketSize") && all["bucketSize"] == "8" ? 2 : 1.4;
            EXPECT_LT(ratio, most);
            EXPECT_GT(ratio, 1 / most);
        }
    }
}

TEST_F(Buckets, TheEstimatedErrorKnowsNoThreadsAndNoOrder) {
    nlohmann::json first;
    for (const Settings& way :
         std::vector<Settings>{{{"threads", "1"}}, {{"threads", "3"}, {"bucketOrder", "random"}}}) {
        Settings settings = {{"passes", "4"}, {"delivery", "buckets"}};
        for (const auto& [name, value] : way) settings[name] = value;
        Taker taker;
        const PmrRender render = make(taker, PMR_CALLBACKS_THREAD, settings);
        ASSERT_EQ(PMR_OK, api().startRender(render)) << m_host.lastError();
        EXPECT_EQ(PMR_OK, api().waitRender(render, -1.0));
        const nlohmann::json json = statistics(render);
        EXPECT_EQ(PMR_OK, api().destroyRender(render));
        if (first.is_null()) first = json;
        for (const char* key : {"relMseEstimate", "relMseEstimateTrimmed", "relMseEstimateNoise",
                                "relMseEstimateBias", "relMseEstimateBiasStandardError"}) {
            EXPECT_TRUE(json[key].is_number()) << key;
            EXPECT_EQ(first[key], json[key]) << key;
        }
        ASSERT_EQ(1u, json["errorCurve"].size());
        EXPECT_EQ(4, json["errorCurve"][0]["passes"]);
        EXPECT_EQ(json["relMseEstimate"], json["errorCurve"][0]["estimatedRelMse"]);
        EXPECT_GT(json["buckets"]["medianSecondsPerPass"].get<double>(), 0);
    }
}

TEST_F(Buckets, NoMoreThanAFewWaitForASlowHost) {
    constexpr std::uint32_t kHeldPerThread = 4;
    Taker taker;
    taker.also = [&](PmrRender) {
        if (taker.finished.size() == 1) std::this_thread::sleep_for(300ms);
        const auto held = taker.begun - static_cast<std::uint32_t>(taker.finished.size()) + 1;
        taker.mostWaiting = std::max(taker.mostWaiting, held);
    };
    const PmrRender render =
        make(taker, PMR_CALLBACKS_THREAD,
             {{"delivery", "buckets"}, {"threads", "2"}, {"bucketSize", "8"}, {"aaLevel", "2"}});
    ASSERT_EQ(PMR_OK, api().startRender(render)) << m_host.lastError();
    EXPECT_EQ(PMR_OK, api().waitRender(render, -1.0));
    EXPECT_EQ(63u, taker.finished.size());
    EXPECT_LE(taker.mostWaiting, 2 * kHeldPerThread);
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
}

TEST_F(Buckets, EndsSoonWhenCancelledWhileTheHostTakesNothing) {
    for (const bool destroyed : {false, true}) {
        Taker taker;
        const PmrRender render = make(taker, PMR_CALLBACKS_POLL,
                                      {{"delivery", "buckets"},
                                       {"threads", "2"},
                                       {"bucketSize", "8"},
                                       {"aaLevel", "2"},
                                       {"aaLevelMost", "2"}});
        ASSERT_EQ(PMR_OK, api().startRender(render)) << m_host.lastError();
        EXPECT_EQ(PMR_ERROR_STATE, api().waitRender(render, 0.0));
        // All that may wait is there, and no more will be: 8 buckets of 64 pixels with 2 samples.
        const auto samples = [&] {
            return statistics(render)["counters"]["cameraSamples"].get<std::uint64_t>();
        };
        for (int tries = 0; tries < 3000 && samples() < 1024; ++tries)
            std::this_thread::sleep_for(10ms);
        std::this_thread::sleep_for(100ms);
        EXPECT_EQ(1024u, samples());
        std::int32_t state = PMR_RENDER_CREATED;
        EXPECT_EQ(PMR_OK, api().renderState(render, &state, nullptr));
        EXPECT_EQ(PMR_RENDER_RUNNING, state);
        const auto start = Clock::now();
        if (!destroyed) {
            EXPECT_EQ(PMR_OK, api().cancelRender(render));
            while (state != PMR_RENDER_FINISHED && Clock::now() - start < 5s) {
                std::this_thread::sleep_for(1ms);
                EXPECT_EQ(PMR_OK, api().renderState(render, &state, nullptr));
            }
            EXPECT_LT(Clock::now() - start, 1s);  // 0.2 s where the machine is not shared
            EXPECT_EQ(PMR_ERROR_CANCELLED, api().waitRender(render, -1.0));
            // What was finished is still delivered, with its pixels.
            pollToEnd(render, taker);
            EXPECT_GT(taker.finished.size(), 0u);
            EXPECT_LE(taker.finished.size(), 8u);
        }
        EXPECT_EQ(PMR_OK, api().destroyRender(render));
        EXPECT_LT(Clock::now() - start, 2s);
        EXPECT_EQ(1, taker.ends);
    }
}

TEST_F(Buckets, CanBeCancelledInsideACallback) {
    Taker taker;
    taker.also = [](PmrRender render) {
        EXPECT_EQ(PMR_OK, api().cancelRender(render));
        EXPECT_EQ(PMR_ERROR_IN_CALLBACK, api().waitRender(render, -1.0));
    };
    const PmrRender render = make(taker, PMR_CALLBACKS_THREAD,
                                  {{"delivery", "buckets"}, {"bucketSize", "8"}, {"passes", "8"}});
    ASSERT_EQ(PMR_OK, api().startRender(render)) << m_host.lastError();
    EXPECT_EQ(PMR_ERROR_CANCELLED, api().waitRender(render, -1.0));
    EXPECT_EQ(1, taker.ends);
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
}

TEST_F(Buckets, ReadingBeyondTheBucketGivesNothing) {
    Taker taker;
    taker.also = [&](PmrRender render) {
        std::vector<float> all = readLayer(render, "samples", 1, {0, 0, kWidth, kHeight});
        const auto read = static_cast<std::size_t>(
            std::count_if(all.begin(), all.end(), [](float count) { return count > 0; }));
        EXPECT_LE(read, std::size_t{16 * 16});
        EXPECT_GT(read, 0u);
    };
    const PmrRender render = make(taker, PMR_CALLBACKS_THREAD, {{"delivery", "buckets"}});
    ASSERT_EQ(PMR_OK, api().startRender(render)) << m_host.lastError();
    EXPECT_EQ(PMR_OK, api().waitRender(render, -1.0));
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
}

// Which way it goes follows from settings and limit, and is told before the start.
TEST_F(Buckets, FitGoesByTheMemoryLimit) {
    Taker taker;
    const PmrRender render = make(taker, PMR_CALLBACKS_THREAD,
                                  {{"delivery", "fit"},
                                   {"width", "8192"},
                                   {"height", "8192"},
                                   {"aaLevelMost", "1"},
                                   {"threads", "2"},
                                   {"passes", "8"}});
    const auto set = [&](const char* name, const char* value) {
        EXPECT_EQ(PMR_OK, api().setSettingText(render, name, value)) << m_host.lastError();
    };
    set("memoryLimitGib", "1000");
    EXPECT_EQ(PMR_DELIVERY_FRAME, delivery(render));
    EXPECT_EQ(std::string::npos, explained(render).find("bucket by bucket"));
    set("memoryLimitGib", "4");
    EXPECT_EQ(PMR_DELIVERY_BUCKETS, delivery(render));
    EXPECT_NE(std::string::npos, explained(render).find("bucket by bucket")) << explained(render);
    // A hundredth of a GiB is too little for the maps, whatever the buckets take.
    set("memoryLimitGib", "0.01");
    EXPECT_EQ(PMR_ERROR_MEMORY, api().startRender(render));
    EXPECT_NE(std::string::npos, m_host.lastError().find("even bucket by bucket"))
        << m_host.lastError();
    EXPECT_NE(std::string::npos, m_host.lastError().find("the memory limit is 0.01 GiB"));
    // What doesn't go together with buckets leaves the frame, and that is refused with what it
    // needs.
    set("memoryLimitGib", "4");
    const std::vector<std::pair<const char*, std::pair<const char*, const char*>>> others = {
        {"passes", {"9", "8"}},
        {"timeLimitSeconds", {"5", "0"}},
        {"errorTarget", {"0.1", "0"}},
        {"buckets", {"0:3", ""}},
        {"part", {"/nowhere/x.pmpart", ""}},
        {"checkpoint", {"/nowhere/x.pmcheck", ""}},
        {"bucketOrder", {"correlated", "hilbert"}},
    };
    for (const auto& [name, values] : others) {
        set(name, values.first);
        EXPECT_EQ(PMR_DELIVERY_FRAME, delivery(render)) << name;
        EXPECT_EQ(PMR_ERROR_MEMORY, api().startRender(render)) << name;
        const std::string text = m_host.lastError();
        EXPECT_NE(std::string::npos, text.find("the render needs ")) << text;
        EXPECT_NE(std::string::npos, text.find("bucket by bucket does not go together with "))
            << text;
        set("delivery", "buckets");
        EXPECT_EQ(PMR_ERROR_ARGUMENT, api().startRender(render)) << name;
        set("delivery", "fit");
        set(name, values.second);
        EXPECT_EQ(PMR_DELIVERY_BUCKETS, delivery(render)) << name;
    }
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
}

TEST_F(Buckets, WantAHostThatTakesThem) {
    const PmrRender render = m_host.makeRender({{"delivery", "fit"}});
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().startRender(render));
    EXPECT_NE(std::string::npos, m_host.lastError().find("bucketFinished"));
    std::int32_t found = 0;
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().renderDelivery(render, &found));
    EXPECT_EQ(PMR_OK, api().setSettingText(render, "delivery", "frame"));
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().renderDelivery(render, nullptr));
    EXPECT_EQ(PMR_OK, api().renderDelivery(render, &found));
    EXPECT_EQ(PMR_DELIVERY_FRAME, found);
    EXPECT_EQ(PMR_OK, api().startRender(render));
    EXPECT_EQ(PMR_OK, api().waitRender(render, -1.0));
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
}

}  // namespace

}  // namespace pm::test
