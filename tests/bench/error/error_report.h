// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What pm_bench_speed_error measures and how it is shown.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/bench/plot/error_curve.h"
#include "tests/bench/plot/report.h"
#include "tests/bench/run/ladder.h"

namespace pm::bench {

struct ErrorBenchOptions {
    std::filesystem::path peers = PM_SHARED_PEERS;  // folder of scenes.json and the references
    std::string csvFile, docsFile, picturesFolder;
    std::string scenes = "ABC";
    std::vector<std::string> integrators = {"photon", "path"};
    std::vector<std::string> aaLevels = {"3:5", "3"};  // the first as the library has it untold
    int passes = 256;
    int threads = 2;
    double seconds = 12, peerSeconds = 30;
    bool quick = false;  // only our own renders, and half the seconds
};

class ErrorBench {
  public:
    explicit ErrorBench(const ErrorBenchOptions& options);

    // Throws Error, or what reading the scenes throws.
    void run();

  private:
    struct Job {
        NeutralScene scene;
        Yardstick yardstick;
    };

    void readJobs();
    void measureOurs(const Job& job);
    void addStep(const std::string& name, const LadderStep& step);
    bool hasPeers() const;
    void measurePeers();
    void keepEarlierPeers();
    void measureCycles(const Job& job, const std::filesystem::path& folder);
    void measurePovray(const Job& job, const std::filesystem::path& folder);
    void measureTessellated();
    void measurePlan();
    void summarize();
    void plot(const Job& job);
    void writeStepPictures(const Job& job, const std::string& name, const LadderStep& step) const;
    std::filesystem::path scenesFile() const { return m_options.peers / "scenes.json"; }
    std::filesystem::path peersFile() const;

    // What the tessellated form is held against: the last step of the best ladder of a scene.
    struct Best {
        const Job* job;
        LadderRequest request;
        LadderStep step;
    };

    ErrorBenchOptions m_options;
    PluginHost m_host;
    Report m_report{"pm_bench_speed_error"}, m_peersReport{"pm_bench_speed_error_peers"};
    std::vector<Job> m_jobs;
    std::vector<Best> m_best;
    std::vector<ErrorCurve> m_ours, m_peers;
};

}  // namespace pm::bench
