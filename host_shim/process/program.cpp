// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/process/program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <thread>

#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

int codeOf(int status) {
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

// What is done in the new process before the program begins.
class Start {
  public:
    Start() {
        // Whoever started us may have them ignored.
        sigset_t standard;
        sigemptyset(&standard);
        for (const int signal : {SIGINT, SIGTERM, SIGPIPE, SIGCHLD, SIGXFSZ})
            sigaddset(&standard, signal);
        posix_spawn_file_actions_init(&m_actions);
        posix_spawnattr_init(&m_attributes);
        posix_spawnattr_setsigdefault(&m_attributes, &standard);
        posix_spawnattr_setflags(&m_attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);
        posix_spawn_file_actions_addopen(&m_actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    }
    ~Start() {
        posix_spawn_file_actions_destroy(&m_actions);
        posix_spawnattr_destroy(&m_attributes);
    }
    Start(const Start&) = delete;
    Start& operator=(const Start&) = delete;

    posix_spawn_file_actions_t* actions() { return &m_actions; }
    pid_t program(const std::vector<std::string>& words) {
        std::signal(SIGCHLD, SIG_DFL);  // else there would be nothing to wait for
        std::vector<std::string> copies = words;
        std::vector<char*> argv;
        for (std::string& word : copies) argv.push_back(word.data());
        argv.push_back(nullptr);
        pid_t child = 0;
        const int failed =
            posix_spawnp(&child, argv[0], &m_actions, &m_attributes, argv.data(), environ);
        if (failed != 0)
            throw HostError(ExitCode::kUsage, fmt::format("{} can't be started: {}", words.front(),
                                                          std::strerror(failed)));
        return child;
    }

  private:
    posix_spawn_file_actions_t m_actions{};
    posix_spawnattr_t m_attributes{};
};

class Pipe {
  public:
    Pipe() {
        if (pipe2(m_ends.data(), O_CLOEXEC) != 0)
            throw HostError(ExitCode::kInternal,
                            fmt::format("no pipe can be made: {}", std::strerror(errno)));
    }
    ~Pipe() {
        closeWriting();
        close(m_ends[0]);
    }
    Pipe(const Pipe&) = delete;
    Pipe& operator=(const Pipe&) = delete;

    int reading() const { return m_ends[0]; }
    int writing() const { return m_ends[1]; }
    void closeWriting() {
        if (m_ends[1] >= 0) close(m_ends[1]);
        m_ends[1] = -1;
    }

  private:
    std::array<int, 2> m_ends{-1, -1};
};

using Clock = std::chrono::steady_clock;

// Milliseconds for poll().
int timeTo(Clock::time_point end) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now()).count();
    return static_cast<int>(std::clamp<std::int64_t>(left, 0, 1'000'000));
}

// Reads both to their ends, or until then; whether they have ended.
bool readAll(const Pipe& out, const Pipe& err, Clock::time_point until, ProgramEnd& end) {
    std::array<pollfd, 2> files{{{out.reading(), POLLIN, 0}, {err.reading(), POLLIN, 0}}};
    std::array<std::string*, 2> texts{&end.out, &end.err};
    std::array<char, 4096> buffer{};
    while (files[0].fd >= 0 || files[1].fd >= 0) {
        const int ready = poll(files.data(), files.size(), timeTo(until));
        if (ready < 0 && errno != EINTR) return false;
        if (ready == 0 && Clock::now() >= until) return false;
        if (ready <= 0) continue;
        for (std::size_t i = 0; i < files.size(); ++i) {
            if (files[i].fd < 0 || files[i].revents == 0) continue;
            const ssize_t count = read(files[i].fd, buffer.data(), buffer.size());
            if (count > 0)
                texts[i]->append(buffer.data(), static_cast<std::size_t>(count));
            else if (count == 0 || errno != EINTR)
                files[i].fd = -1;
        }
    }
    return true;
}

}  // namespace

ProgramEnd runProgram(const std::vector<std::string>& words, std::chrono::milliseconds limit) {
    Pipe out, err;
    Start start;
    posix_spawn_file_actions_adddup2(start.actions(), out.writing(), STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(start.actions(), err.writing(), STDERR_FILENO);
    const pid_t child = start.program(words);
    out.closeWriting();
    err.closeWriting();
    constexpr std::chrono::seconds kToEnd{2};
    ProgramEnd end;
    if (!readAll(out, err, Clock::now() + limit, end)) {
        kill(-child, SIGTERM);
        if (!readAll(out, err, Clock::now() + kToEnd, end)) kill(-child, SIGKILL);
    }
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    end.code = codeOf(status);
    return end;
}

BackgroundProgram::BackgroundProgram(const std::vector<std::string>& words,
                                     const std::filesystem::path& log) {
    Start start;
    posix_spawn_file_actions_addopen(start.actions(), STDOUT_FILENO, log.c_str(),
                                     O_WRONLY | O_CREAT | O_APPEND, 0666);
    posix_spawn_file_actions_adddup2(start.actions(), STDOUT_FILENO, STDERR_FILENO);
    m_child = start.program(words);
}

BackgroundProgram::~BackgroundProgram() {
    end();
}

std::optional<int> BackgroundProgram::ended() {
    int status = 0;
    if (!m_code && waitpid(m_child, &status, WNOHANG) == m_child) m_code = codeOf(status);
    return m_code;
}

void BackgroundProgram::end() {
    if (ended()) return;  // its number may be another's by now
    constexpr std::chrono::milliseconds kGlance{20};
    constexpr std::chrono::seconds kBetween{1}, kPatience{10};
    const auto waits = [&](Clock::duration most) {
        for (const auto until = Clock::now() + most; !ended() && Clock::now() < until;)
            std::this_thread::sleep_for(kGlance);
    };
    for (const auto patience : {Clock::duration(kBetween), Clock::duration(kPatience)}) {
        if (ended()) break;
        kill(m_child, SIGTERM);
        waits(patience);
    }
    kill(-m_child, SIGKILL);
    if (!m_code) waits(kPatience);
}

}  // namespace pm::host
