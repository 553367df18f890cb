// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/robust/host_zygote.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include "host_shim/app/host.h"

namespace pm::host::test {
namespace {

int toZygote = -1, fromZygote = -1;

using Words = std::vector<std::string>;

// Lists of words as one text: each has its count before it, and each word ends with a zero.
std::string joined(const std::vector<Words>& lists) {
    std::string text;
    for (const Words& list : lists) {
        text += std::to_string(list.size()) + '\0';
        for (const std::string& word : list) text += word + '\0';
    }
    return text;
}

std::vector<Words> parted(const std::string& text) {
    std::size_t at = 0;
    const auto next = [&] {
        const std::string word = text.c_str() + at;
        at += word.size() + 1;
        return word;
    };
    std::vector<Words> lists;
    while (at < text.size()) {
        Words& list = lists.emplace_back(std::stoul(next()));
        for (std::string& word : list) word = next();
    }
    return lists;
}

bool readAll(int file, void* to, std::size_t size) {
    auto* at = static_cast<char*>(to);
    for (ssize_t got = 0; size > 0; at += got, size -= static_cast<std::size_t>(got))
        if ((got = read(file, at, size)) <= 0) return false;
    return true;
}

bool writeAll(int file, const void* from, std::size_t size) {
    const auto* at = static_cast<const char*>(from);
    for (ssize_t put = 0; size > 0; at += put, size -= static_cast<std::size_t>(put))
        if ((put = write(file, at, size)) <= 0) return false;
    return true;
}

// Environment, folder, arguments, names and values of variables.
[[noreturn]] void runHere(std::vector<Words> lists) {
    clearenv();
    for (std::string& variable : lists.at(0)) putenv(variable.data());
    HostTask task{lists.at(1).at(0), lists.at(2), {}};
    for (std::size_t i = 0; i < lists.at(3).size(); ++i)
        task.variables.emplace_back(lists.at(3)[i], lists.at(4).at(i));
    if (!enterTask(task)) _exit(99);
    setenv("PM_PLUGIN_PATH", PM_PLUGIN, 1);
    Words words = task.arguments;
    words.insert(words.begin(), PM_HOST);
    std::vector<char*> raw;
    for (std::string& word : words) raw.push_back(word.data());
    const int code = runProcess(static_cast<int>(raw.size()), raw.data());
    std::fflush(nullptr);
    _exit(code);  // the test program's own objects are not this process's to destroy
}

// Each task is run by a child of a child that ends, so it becomes the test program's.
[[noreturn]] void serve(int tasks, int answers) {
    dlopen(PM_PLUGIN, RTLD_NOW | RTLD_LOCAL);
    std::uint64_t size = 0;
    while (readAll(tasks, &size, sizeof size)) {
        std::string text(size, '\0');
        if (!readAll(tasks, text.data(), size)) break;
        const pid_t between = fork();
        if (between == 0) {
            const pid_t child = fork();
            if (child == 0) {
                close(tasks);
                close(answers);
                runHere(parted(text));
            }
            _exit(child > 0 && writeAll(answers, &child, sizeof child) ? 0 : 1);
        }
        int status = 0;
        waitpid(between, &status, 0);
        const char gone = status == 0 ? 'y' : 'n';
        if (!writeAll(answers, &gone, 1)) break;
    }
    _exit(0);
}

class ZygoteEnvironment : public ::testing::Environment {
  public:
    void SetUp() override {
        int tasks[2], answers[2];
        if (pipe2(tasks, O_CLOEXEC) != 0 || pipe2(answers, O_CLOEXEC) != 0)
            throw std::runtime_error("no pipe can be made");
        // Children whose parents have ended are this process's.
        prctl(PR_SET_CHILD_SUBREAPER, 1);
        std::fflush(nullptr);
        const pid_t zygote = fork();
        if (zygote < 0) throw std::runtime_error("no process can be made");
        if (zygote == 0) {
            prctl(PR_SET_CHILD_SUBREAPER, 0);
            close(tasks[1]);
            close(answers[0]);
            serve(tasks[0], answers[1]);
        }
        close(tasks[0]);
        close(answers[1]);
        toZygote = tasks[1];
        fromZygote = answers[0];
        m_zygote = zygote;
    }
    void TearDown() override {
        close(toZygote);
        close(fromZygote);
        waitpid(m_zygote, nullptr, 0);
    }

  private:
    pid_t m_zygote = -1;
};

[[maybe_unused]] const auto* const environment =
    ::testing::AddGlobalTestEnvironment(new ZygoteEnvironment);

}  // namespace

pid_t startInZygote(const HostTask& task) {
    Words inherited, names, values;
    for (char** variable = environ; *variable != nullptr; ++variable)
        inherited.emplace_back(*variable);
    for (const auto& [name, value] : task.variables) {
        names.push_back(name);
        values.push_back(value);
    }
    const std::string text = joined({inherited, {task.folder}, task.arguments, names, values});
    const std::uint64_t size = text.size();
    pid_t child = -1;
    char gone = 'n';
    if (!writeAll(toZygote, &size, sizeof size) || !writeAll(toZygote, text.data(), size) ||
        !readAll(fromZygote, &child, sizeof child) || !readAll(fromZygote, &gone, 1) || gone != 'y')
        throw std::runtime_error("no process can be made");
    return child;
}

bool enterTask(const HostTask& task) {
    if (chdir(task.folder.c_str()) != 0 || !freopen(".out", "wb", stdout) ||
        !freopen(".err", "wb", stderr))
        return false;
    for (const char* name :
         {"OCIO", "OPENIMAGEIO_OPTIONS", "LC_ALL", "LC_NUMERIC", "LANG", "PM_PLUGIN_PATH"})
        unsetenv(name);
    for (const auto& [name, value] : task.variables) setenv(name.c_str(), value.c_str(), 1);
    return true;
}

}  // namespace pm::host::test
