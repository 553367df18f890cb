// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Hosts that fork: the child has none of the library's threads, and no call may wait for one.
#include <dlfcn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <mutex>
#include <thread>

#include "tests/abi/host.h"

namespace pm::test {

namespace {

constexpr int kMostSeconds = 20;
constexpr int kHang = 1000;

// What a child's last call brings: a status, 0 to -99.
int inChild(const std::function<int()>& work, bool byExit = false) {
    const pid_t child = fork();
    if (child == 0) {
        alarm(kMostSeconds);
        const int code = -work();
        byExit ? std::exit(code) : _exit(code);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? -WEXITSTATUS(status) : kHang + WTERMSIG(status);
}

const std::map<std::string, std::string>& longRender() {
    static const std::map<std::string, std::string> settings = {
        {"width", "320"}, {"height", "240"}, {"passes", "500"}, {"photons", "50000"}};
    return settings;
}

void expectEnds(PmrRender render) {
    EXPECT_EQ(PMR_OK, api().cancelRender(render));
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
}

PmrRenderDesc described(std::int32_t mode) {
    PmrRenderDesc desc = PMR_INIT(PmrRenderDesc);
    desc.callbackMode = mode;
    return desc;
}

std::string textOfLastError() {
    std::array<char, 400> text{};
    api().lastError(nullptr, text.data(), text.size(), nullptr);
    return text.data();
}

// In a child, where a failed expectation would not be seen: the first status that is not OK.
int releaseAll(PmrRender render, const BoxHost& host) {
    for (const PmrStatus status : {api().destroyRender(render), api().releaseScene(host.scene()),
                                   api().releaseContext(host.context())})
        if (status != PMR_OK) return status;
    return api().destroyRender(render) == PMR_ERROR_HANDLE ? PMR_OK : -99;
}

TEST(Fork, ChildDestroysWhatRuns) {
    for (const std::int32_t mode : {PMR_CALLBACKS_THREAD, PMR_CALLBACKS_POLL}) {
        const BoxHost host;
        const PmrRenderDesc desc = described(mode);
        const PmrRender render = host.makeRender(longRender(), &desc);
        EXPECT_EQ(PMR_OK, inChild([&] { return releaseAll(render, host); }));
        ASSERT_EQ(PMR_OK, api().startRender(render));
        for (const int microseconds : {0, 100, 300, 1000, 3000, 10000, 30000, 60000}) {
            std::this_thread::sleep_for(std::chrono::microseconds(microseconds));
            EXPECT_EQ(PMR_OK, inChild([&] { return releaseAll(render, host); })) << microseconds;
        }
        expectEnds(render);
        EXPECT_EQ(PMR_ERROR_HANDLE, api().destroyRender(render));
    }
}

// Scenes, contexts, merges and threads in calls, too: whatever another thread may have in hand.
TEST(Fork, NothingElseIsTakenFromTheParent) {
    const BoxHost host;
    const PmrRender render = host.makeRender(longRender());
    PmrMerge merge = nullptr;
    ASSERT_EQ(PMR_OK, api().createMerge(host.context(), &merge));
    ASSERT_EQ(PMR_OK, api().startRender(render));
    const PmrRectangle one = {0, 0, 1, 1};
    float pixel[4];
    std::int32_t number = 0;
    double bounds[6];
    PmrRender other = nullptr;
    PmrScene scene = nullptr;
    std::uint64_t needed = 0;
    const std::vector<std::function<PmrStatus()>> calls = {
        [&] { return api().waitRender(render, -1.0); },
        [&] { return api().pollRender(render, -1.0); },
        [&] { return api().cancelRender(render); },
        [&] { return api().startRender(render); },
        [&] { return api().renderState(render, &number, nullptr); },
        [&] { return api().renderStopReason(render, &number); },
        [&] { return api().renderDelivery(render, &number); },
        [&] { return api().readPixels(render, &one, "beauty", pixel, 0, 0); },
        [&] { return api().renderStatistics(render, nullptr, 0, &needed); },
        [&] { return api().explainRender(render, nullptr, 0, &needed); },
        [&] { return api().commitScene(host.scene()); },
        [&] { return api().sceneBounds(host.scene(), bounds); },
        [&] { return api().createRender(host.scene(), nullptr, &other); },
        [&] { return api().createScene(host.context(), nullptr, &scene); },
        [&] { return api().cancelBuilds(host.context(), 1); },
        [&] { return api().mergeMissing(merge, nullptr, 0, &needed); }};
    for (std::size_t i = 0; i < calls.size(); ++i)
        EXPECT_EQ(PMR_ERROR_STATE, inChild([&] {
                      const PmrStatus status = calls[i]();
                      const bool isSaid = textOfLastError().find("forked") != std::string::npos;
                      return isSaid ? status : -98;
                  }))
            << i;
    EXPECT_EQ(PMR_OK, inChild([&] { return api().releaseMerge(merge); }));
    // A child of such a child knows it as well.
    EXPECT_EQ(PMR_ERROR_STATE,
              inChild([&] { return inChild([&] { return api().waitRender(render, -1.0); }); }));
    expectEnds(render);
    EXPECT_EQ(PMR_OK, api().releaseMerge(merge));
}

// A handle of the child's own, and what it makes of the parent's where nothing was at work.
TEST(Fork, ChildRendersByItself) {
#ifdef __SANITIZE_THREAD__
    GTEST_SKIP() << "ThreadSanitizer ends a forked child that starts threads";
#endif
    const BoxHost host;
    const PmrRectangle all = {0, 0, kWidth, kHeight};
    const std::vector<float> expected = renderBox(host, {});
    const PmrRender idle = host.makeRender(longRender()), done = host.makeRender({});
    ASSERT_EQ(PMR_OK, api().startRender(done));
    ASSERT_EQ(PMR_OK, api().waitRender(done, -1.0));
    EXPECT_EQ(0, inChild([&] {
                  const bool isRead = readLayer(done, "beauty", 4, all) == expected;
                  const bool isWaited = api().waitRender(done, -1.0) == PMR_OK;
                  const bool isSame = renderBox(host, {}) == expected;
                  return isRead && isWaited && isSame ? releaseAll(done, host) : -97;
              }));
    ASSERT_EQ(PMR_OK, api().startRender(idle));
    EXPECT_EQ(0, inChild([&] {
                  const BoxHost own;
                  return renderBox(own, {}) == expected ? 0 : -97;
              }));
    expectEnds(idle);
    EXPECT_EQ(expected, readLayer(done, "beauty", 4, all));
    EXPECT_EQ(PMR_OK, api().destroyRender(done));
}

TEST(Fork, CheckpointStaysTheParents) {
    const std::string file = testing::TempDir() + "fork_" + std::to_string(::getpid());
    const BoxHost host;
    std::map<std::string, std::string> settings = longRender();
    settings["checkpoint"] = file;
    const PmrRender render = host.makeRender(settings);
    ASSERT_EQ(PMR_OK, api().startRender(render));
    while (!std::filesystem::exists(file)) std::this_thread::yield();
    EXPECT_EQ(PMR_OK, inChild([&] { return releaseAll(render, host); }));
    EXPECT_TRUE(std::filesystem::exists(file));
    expectEnds(render);
    std::filesystem::remove(file);
}

// What a host that forks inside a callback sees in the child: it may end all there, and once the
// callback has returned nothing waits.
struct Forking {
    int afterwards = 0;
    int inside = 0;
    pid_t child = -1;
};

void forkOnce(void* user, PmrRender render, std::int32_t, std::int32_t, const char*) {
    auto& forking = *static_cast<Forking*>(user);
    if (forking.child != -1) return;
    forking.inside = inChild([&] { return api().destroyRender(render); });
    forking.child = fork();
    if (forking.child == 0) alarm(kMostSeconds);
}

TEST(Fork, InsideACallback) {
    const BoxHost host;
    Forking forking;
    PmrRenderDesc desc = described(PMR_CALLBACKS_POLL);
    desc.message = forkOnce;
    desc.user = &forking;
    const PmrRender render = host.makeRender(longRender(), &desc);
    ASSERT_EQ(PMR_OK, api().startRender(render));
    while (forking.child == -1) {
        const PmrStatus status = api().pollRender(render, -1.0);
        if (forking.child == 0) _exit(-status);
        ASSERT_EQ(PMR_OK, status);
    }
    EXPECT_EQ(PMR_OK, forking.inside);
    int status = 0;
    waitpid(forking.child, &status, 0);
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(PMR_ERROR_STATE, -WEXITSTATUS(status));
    expectEnds(render);
}

// Of all that runs in exit(), log4cplus alone waits (docs/c_interface.md), which is passed over by
// the function below.
TEST(Fork, ChildExits) {
    const BoxHost host;
    const PmrRender render = host.makeRender(longRender());
    EXPECT_EQ(0, inChild([] { return 0; }, true));
    ASSERT_EQ(PMR_OK, api().startRender(render));
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    EXPECT_EQ(0, inChild([] { return 0; }, true));
    EXPECT_EQ(0, inChild([&] { return releaseAll(render, host); }, true));
    expectEnds(render);
}

const pid_t kFirstProcess = ::getpid();

}  // namespace

}  // namespace pm::test

// In place of std::condition_variable::wait for the whole program: exit() called by one of its own
// functions goes on with those that remain.
extern "C" __attribute__((visibility("default"))) void waitOfCondition(
    void* condition,
    void* lock) __asm__("_ZNSt18condition_variable4waitERSt11unique_lockISt5mutexE");
extern "C" void waitOfCondition(void* condition, void* lock) {
    Dl_info caller{};
    if (::getpid() != pm::test::kFirstProcess &&
        dladdr(__builtin_return_address(0), &caller) != 0 &&
        std::strstr(caller.dli_fname, "log4cplus") != nullptr)
        std::exit(0);
    using Wait = void (*)(void*, void*);
    static const auto usual = reinterpret_cast<Wait>(
        dlsym(RTLD_NEXT, "_ZNSt18condition_variable4waitERSt11unique_lockISt5mutexE"));
    usual(condition, lock);
}
