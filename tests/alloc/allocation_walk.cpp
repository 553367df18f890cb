// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/alloc/allocation_walk.h"

#include <dlfcn.h>
#include <execinfo.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

#include "tests/alloc/failing_malloc.h"

namespace pm::test {

namespace {

// For one walk, of some milliseconds: beyond it hangs, however busy the machine is.
constexpr unsigned kMostSeconds = 4;
constexpr std::size_t kMostFindings = 64;

enum class What : std::int32_t { kStatus, kNoText, kLeak, kNotRefused, kOtherPixels };

// What a child tells its parent, also when it crashes.
struct Shared {
    std::atomic<std::size_t> done{0};  // of the numbers
    std::atomic<std::size_t> findings{0};
    struct {
        std::uint64_t number;
        What what;
        PmrStatus status;
        const char* call;  // the same address in the parent
        Stack failed;
    } finding[kMostFindings];
    Stack failed, crashed;
    std::uint64_t count = 0;
};

Shared* s_shared = nullptr;

void onCrash(int signal) {
    Stack& stack = s_shared->crashed;
    stack.count = backtrace(stack.frames.data(), static_cast<int>(stack.frames.size()));
    _exit(128 + signal);
}

// On every thread of a child that hangs: which of them is inside of the ray tracer is told; all
// others wait for it.
void onHangingThread(int) {
    Stack stack;
    stack.count = backtrace(stack.frames.data(), static_cast<int>(stack.frames.size()));
    for (int i = 0; i < stack.count; ++i) {
        Dl_info info{};
        if (dladdr(stack.frames[static_cast<std::size_t>(i)], &info) == 0 || !info.dli_fname)
            continue;
        if (std::strstr(info.dli_fname, "libembree3") == nullptr) continue;
        stack.count -= i;
        std::copy_n(stack.frames.begin() + i, stack.count, stack.frames.begin());
        s_shared->crashed = stack;
        return;
    }
}

void onHang(int) {
    for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task"))
        tgkill(getpid(), std::stoi(thread.path().filename()), SIGUSR1);
    const timespec moment{0, 300'000'000};
    for (int i = 0; i < 3; ++i) nanosleep(&moment, nullptr);  // signals end it early
    _exit(128 + SIGALRM);
}

std::string textOf(const Stack& stack) {
    std::string text;
    for (int i = 0; i < stack.count; ++i) {
        Dl_info info{};
        const void* frame = stack.frames[static_cast<std::size_t>(i)];
        dladdr(frame, &info);
        const std::string file =
            std::filesystem::path(info.dli_fname == nullptr ? "?" : info.dli_fname).filename();
        std::array<char, 64> at{};
        std::snprintf(at.data(), at.size(), "+%#tx",
                      static_cast<const char*>(frame) - static_cast<const char*>(info.dli_fbase));
        text += "    " + file + at.data() + " " +
                (info.dli_sname == nullptr ? "" : info.dli_sname) + "\n";
    }
    return text;
}

std::string fileOf(const void* frame, std::string* function = nullptr) {
    Dl_info info{};
    if (dladdr(frame, &info) == 0 || info.dli_fname == nullptr) return "?";
    if (function != nullptr) *function = info.dli_sname == nullptr ? "" : info.dli_sname;
    return std::filesystem::path(info.dli_fname).filename();
}

// What stands between the refused memory and pm, but for the C and C++ libraries.
std::string belowOf(const Stack& stack) {
    std::string below;
    for (int i = 0; i < stack.count; ++i) {
        std::string function;
        const std::string file = fileOf(stack.frames[static_cast<std::size_t>(i)], &function);
        if (file.starts_with("libpm_plugin")) break;
        const bool isOther = file.starts_with("lib") && !file.starts_with("libc.") &&
                             !file.starts_with("libstdc++") && !file.starts_with("libgcc");
        if (isOther) below = file + " " + function;
    }
    return below;
}

std::string textOf(What what, PmrStatus status, const char* call) {
    switch (what) {
        case What::kStatus:
            return std::string("status ") + std::to_string(status) + " of " + call;
        case What::kNoText:
            return std::string("no text of ") + call;
        case What::kLeak:
            return "leak";
        case What::kNotRefused:
            return "what can't be right was taken";
        case What::kOtherPixels:
            return "other pixels";
    }
    return "?";
}

// In a child: goes the walk with failing allocations, and looks at what comes of each.
class Child {
  public:
    Child(const PmrApi& api, const Walk& walk, const char* folder)
        : m_api(api), m_walk(walk), m_folder(folder) {}

    WalkResult go(std::uint64_t failing) {
        WalkResult result;
        failAllocation(failing, &s_shared->failed);
        m_walk.go(m_api, m_folder, result);
        s_shared->count = allocationCount();
        failAllocation(0, nullptr);
        return result;
    }
    void warmUp() {
        for (int i = 0; i < 4; ++i) {
            m_usual = go(0);
            m_usualRise = liveAllocations() - m_live;
            m_live += m_usualRise;
        }
    }
    void look(std::uint64_t number) {
        const WalkResult result = go(number);
        if (result.firstFailure != PMR_OK && result.firstFailure != PMR_ERROR_MEMORY)
            tell(number, What::kStatus, result);
        if (!result.hasText) tell(number, What::kNoText, result);
        if (!result.isRefused) tell(number, What::kNotRefused, result);
        const bool isWhole = result.firstFailure == PMR_OK && m_usual.pixels != 0;
        if (isWhole && result.pixels != m_usual.pixels) tell(number, What::kOtherPixels, result);
    }
    // What stays after a walk may be kept for the next; what stays after each is lost. (Embree
    // keeps something for each thread that ever committed a scene, so some rises when nothing
    // fails.)
    void lookForLeak(std::uint64_t number) {
        if (std::exchange(m_live, liveAllocations()) + m_usualRise >= liveAllocations()) return;
        int rises = 0;
        for (int i = 0; i < 3; ++i) {
            const std::int64_t before = liveAllocations();
            go(number);
            rises += liveAllocations() > before + m_usualRise ? 1 : 0;
        }
        if (rises == 3) tell(number, What::kLeak, {});
        m_live = liveAllocations();
    }

  private:
    void tell(std::uint64_t number, What what, const WalkResult& result) {
        const std::size_t place = s_shared->findings++;
        if (place >= kMostFindings) return;
        s_shared->finding[place] = {number, what, result.firstFailure, result.failedCall,
                                    s_shared->failed};
    }

    const PmrApi& m_api;
    const Walk& m_walk;
    const char* m_folder;
    WalkResult m_usual{};
    std::int64_t m_live = 0, m_usualRise = 0;
};

template <typename Work>
int inChild(const Work& work) {
    std::fflush(nullptr);
    const pid_t child = fork();
    if (child < 0) throw std::runtime_error("no process can be made");
    if (child == 0) {
        for (const int signal : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL}) {
            std::signal(signal, onCrash);
        }
        std::signal(SIGALRM, onHang);
        std::signal(SIGUSR1, onHangingThread);
        work();
        _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return status;
}

// A child that makes no progress is ended by SIGALRM: `alarm` is set anew for each number.
void goOn() {
    s_shared->crashed.count = 0;
    alarm(kMostSeconds);
}

std::string endOf(int status) {
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM) return "hang";
    if (WIFSIGNALED(status)) return "killed by signal " + std::to_string(WTERMSIG(status));
    const int code = WEXITSTATUS(status);
    if (code == 128 + SIGALRM) return "hang";
    return code > 128 ? "crash (signal " + std::to_string(code - 128) + ")"
                      : "exit " + std::to_string(code);
}

Shared& makeShared() {
    if (s_shared == nullptr) {
        Stack warmUp;  // the first backtrace() of a process loads a library
        warmUp.count = backtrace(warmUp.frames.data(), 1);
        void* memory = mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE,
                            MAP_SHARED | MAP_ANONYMOUS, -1, 0);
        if (memory == MAP_FAILED) throw std::bad_alloc();
        s_shared = static_cast<Shared*>(memory);
    }
    return *new (s_shared) Shared;
}

void takeFindings(Shared& shared, std::vector<Finding>& findings) {
    const std::size_t count = std::min<std::size_t>(shared.findings, kMostFindings);
    for (std::size_t i = 0; i < count; ++i) {
        const auto& found = shared.finding[i];
        findings.push_back({found.number,
                            textOf(found.what, found.status, found.call),
                            textOf(found.failed),
                            {},
                            belowOf(found.failed),
                            found.what != What::kLeak});
    }
    shared.findings = 0;
}

}  // namespace

std::uint64_t countAllocations(const PmrApi& api, const Walk& walk, const char* folder,
                               Start start) {
    Shared& shared = makeShared();
    Child child(api, walk, folder);
    const int status = inChild([&] {
        goOn();
        if (start == Start::kWarm) child.warmUp();
        if (child.go(0).firstFailure != PMR_OK) _exit(1);
    });
    if (status != 0) throw std::runtime_error(std::string(walk.name) + ": " + endOf(status));
    return shared.count;
}

std::vector<Finding> walkFailing(const PmrApi& api, const Walk& walk, const char* folder,
                                 Start start, const std::vector<std::uint64_t>& numbers) {
    Shared& shared = makeShared();
    std::vector<Finding> findings;
    const bool isWarm = start == Start::kWarm;
    while (shared.done < numbers.size()) {
        Child child(api, walk, folder);
        const int status = inChild([&] {
            goOn();
            if (isWarm) child.warmUp();
            const std::size_t end = isWarm ? numbers.size() : shared.done + 1;
            while (shared.done < end) {
                goOn();
                const std::uint64_t number = numbers[shared.done];
                child.look(number);
                if (isWarm) child.lookForLeak(number);
                ++shared.done;
            }
        });
        takeFindings(shared, findings);
        if (status == 0) continue;
        const std::string end = endOf(status);
        const bool isInside = end == "hang" && shared.crashed.count > 0;
        findings.push_back({numbers[shared.done], end, textOf(shared.failed),
                            textOf(shared.crashed),
                            belowOf(isInside ? shared.crashed : shared.failed), false});
        ++shared.done;
    }
    return findings;
}

}  // namespace pm::test
