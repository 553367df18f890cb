// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/process/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <map>
#include <thread>

#include "host_shim/process/interrupt.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kGlance = std::chrono::milliseconds(5);  // between looks at who has ended
constexpr auto kPatience = std::chrono::seconds(3);     // with those that are to end

// posix_spawn's list of what is done before the program begins.
class SpawnActions {
  public:
    SpawnActions() { posix_spawn_file_actions_init(&m_actions); }
    ~SpawnActions() { posix_spawn_file_actions_destroy(&m_actions); }
    SpawnActions(const SpawnActions&) = delete;
    SpawnActions& operator=(const SpawnActions&) = delete;
    posix_spawn_file_actions_t* get() { return &m_actions; }

  private:
    posix_spawn_file_actions_t m_actions{};
};

pid_t start(const ChildTask& task) {
    std::vector<std::string> words{"pm_host"};
    words.insert(words.end(), task.arguments.begin(), task.arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    SpawnActions actions;
    posix_spawn_file_actions_addopen(actions.get(), STDOUT_FILENO, task.log.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_adddup2(actions.get(), STDOUT_FILENO, STDERR_FILENO);
    posix_spawn_file_actions_addchdir_np(actions.get(), task.folder.c_str());
    pid_t child = 0;
    const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
    const int failed =
        posix_spawn(&child, program.c_str(), actions.get(), nullptr, argv.data(), environ);
    if (failed != 0)
        throw HostError(ExitCode::kInternal,
                        fmt::format("pm_host can't be started: {}", std::strerror(failed)));
    return child;
}

// Those that run; what is left of them when this ends is killed.
class Crowd {
  public:
    ~Crowd() { endAll(); }
    // Whoever started us may have it ignored; then there would be nothing to wait for.
    Crowd() { std::signal(SIGCHLD, SIG_DFL); }
    Crowd(const Crowd&) = delete;
    Crowd& operator=(const Crowd&) = delete;

    std::size_t size() const { return m_running.size(); }
    void add(const ChildTask& task, std::size_t index) {
        m_running[start(task)] = {index, Clock::now()};
    }
    // Those that have ended since.
    std::vector<std::pair<std::size_t, ChildResult>> ended() {
        std::vector<std::pair<std::size_t, ChildResult>> list;
        for (auto at = m_running.begin(); at != m_running.end();) {
            int status = 0;
            const pid_t ended = waitpid(at->first, &status, WNOHANG);
            if (ended < 0 && errno != EINTR)
                throw HostError(ExitCode::kInternal, fmt::format("a child can't be waited for: {}",
                                                                 std::strerror(errno)));
            if (ended != at->first) {
                ++at;
                continue;
            }
            list.emplace_back(at->second.index, resultOf(status, at->second.start));
            at = m_running.erase(at);
        }
        return list;
    }
    // Ends all; what they were doing is lost. They have a while to clear up.
    std::vector<std::pair<std::size_t, ChildResult>> endAll() {
        for (const auto& [child, entry] : m_running) kill(child, SIGTERM);
        const auto patience = Clock::now() + kPatience;
        std::vector<std::pair<std::size_t, ChildResult>> list;
        for (const auto& [child, entry] : m_running) {
            while (waitpid(child, nullptr, WNOHANG) == 0 && Clock::now() < patience)
                std::this_thread::sleep_for(kGlance);
            if (kill(child, 0) == 0) {
                kill(child, SIGKILL);
                waitpid(child, nullptr, 0);
            }
            ChildResult result = resultOf(0, entry.start);
            result.end = ChildResult::End::kOutOfTime;
            list.emplace_back(entry.index, result);
        }
        m_running.clear();
        return list;
    }

  private:
    struct Entry {
        std::size_t index{};
        Clock::time_point start;
    };
    static ChildResult resultOf(int status, Clock::time_point start) {
        ChildResult result;
        result.seconds = std::chrono::duration<double>(Clock::now() - start).count();
        const bool isExit = WIFEXITED(status);
        result.end = isExit ? ChildResult::End::kExited : ChildResult::End::kSignalled;
        result.code = isExit ? WEXITSTATUS(status) : WTERMSIG(status);
        return result;
    }
    std::map<pid_t, Entry> m_running;
};

}  // namespace

std::vector<ChildResult> runChildren(
    const std::vector<ChildTask>& tasks, int atOnce, std::chrono::duration<double> budget,
    const std::function<void(std::size_t, const ChildResult&)>& done) {
    std::vector<ChildResult> results(tasks.size());
    const auto begin = Clock::now();
    Crowd crowd;
    const auto take = [&](const auto& list) {
        for (const auto& [index, result] : list) {
            results[index] = result;
            done(index, result);
        }
    };
    for (std::size_t next = 0; next < tasks.size() || crowd.size() > 0;) {
        throwIfInterrupted();
        if (Clock::now() - begin > budget) {
            take(crowd.endAll());
            return results;
        }
        while (next < tasks.size() && crowd.size() < static_cast<std::size_t>(atOnce)) {
            crowd.add(tasks[next], next);
            ++next;
        }
        const auto ended = crowd.ended();
        take(ended);
        if (ended.empty()) std::this_thread::sleep_for(kGlance);
    }
    return results;
}

}  // namespace pm::host
