// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/robust/host_process.h"

#include <sys/resource.h>
#include <sys/wait.h>

#include <algorithm>
#include <stdexcept>

#include "tests/robust/host_zygote.h"

namespace pm::host::test {
namespace {

// Textures of one test are no business of another's, nor of the user's.
HostTask taskIn(const fs::path& folder, std::vector<std::string> arguments) {
    return {
        folder.string(), std::move(arguments), {{"XDG_CACHE_HOME", (folder / ".cache").string()}}};
}

pid_t startProgram(const HostTask& task) {
    const pid_t child = fork();
    // A test that then killed process -1 would kill all of the user's.
    if (child < 0) throw std::runtime_error("no process can be made");
    if (child > 0) return child;
    if (!enterTask(task)) _exit(99);
    std::vector<std::string> words = task.arguments;
    words.insert(words.begin(), PM_HOST);
    std::vector<char*> raw;
    for (std::string& word : words) raw.push_back(word.data());
    raw.push_back(nullptr);
    execv(PM_HOST, raw.data());
    _exit(98);
}

bool needsTheProgram(const HostTask& task) {
    const std::string first = task.arguments.empty() ? "" : task.arguments.front();
    rlimit files{};  // a test's own limit is not the zygote's
    getrlimit(RLIMIT_FSIZE, &files);
    return files.rlim_cur != RLIM_INFINITY || first == "check" || first == "farm" ||
           std::any_of(task.variables.begin(), task.variables.end(),
                       [](const auto& variable) { return variable.first == "PM_PLUGIN_PATH"; });
}

}  // namespace

Outcome HostProcess::run(std::vector<std::string> arguments,
                         const std::function<void(pid_t)>& during,
                         const std::vector<std::pair<std::string, std::string>>& variables) const {
    HostTask task = taskIn(m_folder, std::move(arguments));
    task.variables.insert(task.variables.end(), variables.begin(), variables.end());
    m_lastChild = needsTheProgram(task) ? startProgram(task) : startInZygote(task);
    return end(during);
}

Outcome HostProcess::runProgram(std::vector<std::string> arguments,
                                const std::function<void(pid_t)>& during) const {
    m_lastChild = startProgram(taskIn(m_folder, std::move(arguments)));
    return end(during);
}

// Of the child that was started last.
Outcome HostProcess::end(const std::function<void(pid_t)>& during) const {
    if (during) during(m_lastChild);
    int status = 0;
    waitpid(m_lastChild, &status, 0);
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
    return {code, readText(path(".out")), readText(path(".err"))};
}

}  // namespace pm::host::test
