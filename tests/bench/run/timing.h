// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Times that survive a noisy machine: the rivals take turns within one run, each turn is timed, and
// what is reported is the median with the quartiles of the turns.
#pragma once

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <functional>
#include <vector>

namespace pm::bench {

inline double secondsSince(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

template <typename F>
double secondsOf(const F& f) {
    const auto start = std::chrono::steady_clock::now();
    f();
    return secondsSince(start);
}

// Seconds of processor time, user and system.
inline double processorSeconds(const rusage& usage) {
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

// What this process has used, all threads.
inline double processorSeconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return processorSeconds(usage);
}

// What the calling thread has used.
inline double threadSeconds() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Spread {
    double lower = 0, median = 0, upper = 0;  // quartiles
};

inline Spread spreadOf(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const auto at = [&](double share) {
        const double place = share * static_cast<double>(values.size() - 1);
        const auto below = static_cast<std::size_t>(place);
        const std::size_t above = std::min(below + 1, values.size() - 1);
        return values[below] +
               (place - static_cast<double>(below)) * (values[above] - values[below]);
    };
    return {at(0.25), at(0.5), at(0.75)};
}

// Seconds of each turn of each rival: turn r of all comes before turn r + 1 of any, after one turn
// each that is not counted.
inline std::vector<std::vector<double>> takeTurns(int turns,
                                                  const std::vector<std::function<void()>>& rivals,
                                                  bool warmUp = true) {
    std::vector<std::vector<double>> seconds(rivals.size());
    if (warmUp)
        for (const auto& rival : rivals) rival();
    for (int turn = 0; turn < turns; ++turn)
        for (std::size_t i = 0; i < rivals.size(); ++i) seconds[i].push_back(secondsOf(rivals[i]));
    return seconds;
}

// amount / seconds, turn by turn.
inline Spread rate(double amount, const std::vector<double>& seconds) {
    std::vector<double> rates;
    for (const double s : seconds) rates.push_back(amount / s);
    return spreadOf(rates);
}

// Speed of `ours` over that of `theirs`, each pair from the same turn, so that a slow moment of the
// machine meets both.
inline Spread speedRatio(const std::vector<double>& ours, const std::vector<double>& theirs) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < ours.size(); ++i) ratios.push_back(theirs[i] / ours[i]);
    return spreadOf(ratios);
}

}  // namespace pm::bench
