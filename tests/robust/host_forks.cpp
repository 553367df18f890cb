// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Runs pm_host many times from one process that has loaded all of its libraries, which takes longer
// than a small picture. Each line of standard input is {"folder": F, "arguments": [...], "seconds":
// N}; a child of its own runs pm_host so in F, standard output and error in F/.out and F/.err, or
// in "output": O there, and with "variables": {NAME: VALUE} besides; the answer is one line
// {"code", "cpuSeconds", "peakKib"}. A code of 1000 + N is signal N; beyond N seconds of processor
// time it is SIGXCPU's or SIGKILL's, beyond 20 N of a clock SIGALRM's.
//
// usage: pm_host_forks PLUGIN
#include <dlfcn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host_shim/app/host.h"

namespace {

[[noreturn]] void runChild(const nlohmann::json& task) {
    const auto folder = task.at("folder").get<std::string>();
    const auto seconds = task.at("seconds").get<unsigned>();
    const std::string output = task.value("output", ".");
    if (task.contains("variables"))
        for (const auto& [name, value] : task["variables"].items())
            setenv(name.c_str(), value.get<std::string>().c_str(), 1);
    std::vector<std::string> arguments{"pm_host"};
    for (const auto& argument : task.at("arguments"))
        arguments.push_back(argument.get<std::string>());
    std::vector<char*> raw;
    for (std::string& argument : arguments) raw.push_back(argument.data());
    const rlimit limit{seconds, seconds + 1};
    if (chdir(folder.c_str()) != 0 || !freopen("/dev/null", "rb", stdin) ||
        !freopen((output + "/.out").c_str(), "wb", stdout) ||
        !freopen((output + "/.err").c_str(), "wb", stderr) || setrlimit(RLIMIT_CPU, &limit) != 0)
        _exit(99);
    alarm(20 * seconds);
    const int code = pm::host::runProcess(static_cast<int>(raw.size()), raw.data());
    std::fflush(nullptr);
    _exit(code);
}

double secondsOf(const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2 || dlopen(argv[1], RTLD_NOW | RTLD_LOCAL) == nullptr) {
        std::cerr << "usage: pm_host_forks PLUGIN\n";
        return 2;
    }
    setenv("PM_PLUGIN_PATH", argv[1], 1);
    for (const char* name : {"OCIO", "LC_ALL", "LC_NUMERIC", "LANG", "XDG_CACHE_HOME"})
        unsetenv(name);
    for (std::string line; std::getline(std::cin, line);) {
        const auto task = nlohmann::json::parse(line);
        const pid_t child = fork();
        if (child < 0) return 1;
        if (child == 0) runChild(task);
        int status = 0;
        rusage usage{};
        wait4(child, &status, 0, &usage);
        const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
        const nlohmann::json answer{
            {"code", code},
            {"cpuSeconds", secondsOf(usage.ru_utime) + secondsOf(usage.ru_stime)},
            {"peakKib", usage.ru_maxrss}};
        std::cout << answer.dump() << std::endl;
    }
    return 0;
}
