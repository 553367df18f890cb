// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/run/child_process.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <sstream>

#include "integrator/values/error.h"
#include "tests/bench/run/timing.h"

namespace pm::bench {

namespace {

// In the child: never returns. Only calls that are allowed between fork and exec.
[[noreturn]] void become(char* const* arguments, const char* folder, const char* log) {
    const int input = open("/dev/null", O_RDONLY);
    const int output = open(log, O_WRONLY | O_CREAT | O_TRUNC, 0666);
    if (input >= 0 && output >= 0 && chdir(folder) == 0 && dup2(input, 0) == 0 &&
        dup2(output, 1) == 1 && dup2(output, 2) == 2)
        execvp(arguments[0], arguments);
    _exit(127);
}

}  // namespace

ChildResult runChild(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                     const std::filesystem::path& log) {
    std::vector<char*> pointers;
    for (const std::string& argument : arguments)
        pointers.push_back(const_cast<char*>(argument.c_str()));
    pointers.push_back(nullptr);
    const std::string logFile = std::filesystem::absolute(log).string();
    const auto start = std::chrono::steady_clock::now();
    const pid_t child = fork();
    if (child < 0) throw Error(Status::kInternal, arguments[0] + ": can't be started");
    if (child == 0) become(pointers.data(), folder.c_str(), logFile.c_str());
    int status = 0;
    rusage usage{};
    while (wait4(child, &status, 0, &usage) < 0)
        if (errno != EINTR) throw Error(Status::kInternal, arguments[0] + ": can't be waited for");
    ChildResult result;
    result.seconds = secondsSince(start);
    result.processorSeconds = processorSeconds(usage);
    result.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return result;
}

std::string lastLineOf(const std::filesystem::path& log) {
    std::ifstream in(log);
    std::string last;
    for (std::string line; std::getline(in, line);)
        if (line.find_first_not_of(" \t\r") != std::string::npos) last = line;
    return last;
}

std::optional<std::filesystem::path> findProgram(const std::string& name) {
    const char* const variable = getenv("PATH");
    std::istringstream folders(variable != nullptr ? variable : "");
    for (std::string folder; std::getline(folders, folder, ':');) {
        const std::filesystem::path file = std::filesystem::path(folder) / name;
        if (access(file.c_str(), X_OK) == 0 && std::filesystem::is_regular_file(file)) return file;
    }
    return std::nullopt;
}

TemporaryFolder::TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "pm_bench_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw Error(Status::kIo, name + ": can't be made");
    m_path = name;
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(m_path, ignored);
}

}  // namespace pm::bench
