// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/farm/task_board.h"

#include <fmt/format.h>

#include <algorithm>

#include "host_shim/farm/job/task_events.h"
#include "host_shim/formats/warnings.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

constexpr std::chrono::seconds kLateFiles{3};
// What a run costs before its first bucket, as a share of all, so that photons count for something.
constexpr double kPhotonShare = 0.05;

// Another machine or another try could not do better: docs/farm.md has the table.
bool isFinal(int exitCode) {
    return exitCode == static_cast<int>(ExitCode::kUsage) ||
           exitCode == static_cast<int>(ExitCode::kBadInput);
}

std::string endText(const std::vector<TaskAttempt>& attempts) {
    if (attempts.empty()) return "it was never started";
    const TaskAttempt& last = attempts.back();
    if (last.exitCode) return fmt::format("exit {} on {}", *last.exitCode, last.machine);
    return fmt::format("killed on {}", last.machine);
}

}  // namespace

TaskBoard::TaskBoard(const FarmPlan& plan, const JobFolder& folder, int tries, Log& log)
    : m_plan(plan), m_folder(folder), m_mostTries(tries), m_log(log) {
    for (int task = 1; task <= static_cast<int>(plan.tasks.size()); ++task) m_open.insert(task);
}

std::vector<int> TaskBoard::lookForProducts() {
    std::vector<int> found;
    for (const int task : m_open) {
        std::error_code failed;
        if (std::filesystem::exists(m_plan.task(task).product, failed)) found.push_back(task);
    }
    for (const int task : found) m_open.erase(task);
    return found;
}

TaskBoard::Batches TaskBoard::batches(const std::set<int>& tasks) const {
    Batches batches;
    for (const int task : tasks) {
        const FarmTask& its = m_plan.task(task);
        const int photons = m_plan.photonsOf(its.frame);
        if (its.kind == FarmTask::Kind::kPhotons)
            batches.photons.push_back(task);
        else if (!m_open.contains(photons))
            batches.runs.push_back(task);
        else if (tasks.contains(photons))
            batches.runsAfter.push_back(
                task);  // else photons are made already: when these are done
    }
    return batches;
}

// Where one of the tasks has just failed, and another machine may do better.
std::set<std::string> TaskBoard::failedOn(const std::set<int>& tasks) const {
    std::set<std::string> machines;
    for (const int task : tasks) {
        const std::vector<TaskAttempt> attempts = readAttempts(m_folder.events(task));
        if (!m_tries.contains(task) || attempts.empty()) continue;
        const std::optional<int>& code = attempts.back().exitCode;
        if (code && *code > 0 && *code < 128) machines.insert(attempts.back().machine);
    }
    return machines;
}

void TaskBoard::start(const std::set<int>& tasks, Engine& engine) {
    const Batches batches = this->batches(tasks);
    for (const auto& started : {batches.photons, batches.runsAfter, batches.runs})
        for (const int task : started)
            m_attemptsBefore[task] = readAttempts(m_folder.events(task)).size();
    const std::set<std::string> avoid = failedOn(tasks);
    if (!batches.runs.empty()) engine.start({batches.runs, {}, avoid});
    if (!batches.photons.empty()) engine.start({batches.photons, batches.runsAfter, avoid});
    for (const int task : tasks) m_goneSince.erase(task);
}

// A task that has ended without its product.
void TaskBoard::judge(int task) {
    const std::vector<TaskAttempt> attempts = readAttempts(m_folder.events(task));
    const bool isNew = attempts.size() > m_attemptsBefore[task];
    const std::string said = lastMessage(m_folder.log(task));
    const std::string text = fmt::format("task {} ({}): {}{}", task, m_plan.what(task),
                                         endText(attempts), said.empty() ? "" : ": " + said);
    const int code = isNew && attempts.back().exitCode ? *attempts.back().exitCode : 1;
    if (isNew && isFinal(code))
        throw HostError(static_cast<ExitCode>(code),
                        fmt::format("{}; {} has more", text, m_folder.log(task).string()));
    const int tries = ++m_tries[task];
    if (tries >= m_mostTries)
        throw HostError(static_cast<ExitCode>(code > 0 && code < 128 ? code : 1),
                        fmt::format("{}; after {} tries (--tries); {} has more", text, tries,
                                    m_folder.log(task).string()));
    m_log.warning(static_cast<int>(Warning::kFarm), text + "; it is started again");
}

std::set<int> TaskBoard::lost(const std::set<int>& unfinished) {
    const auto now = std::chrono::steady_clock::now();
    std::set<int> lost;
    for (const int task : m_open) {
        if (unfinished.contains(task)) {
            m_goneSince.erase(task);
            continue;
        }
        const auto since = m_goneSince.emplace(task, now).first->second;
        if (now - since < kLateFiles) continue;
        const FarmTask& its = m_plan.task(task);
        const int photons = m_plan.photonsOf(its.frame);
        const bool waitsForPhotons = its.kind == FarmTask::Kind::kRun && m_open.contains(photons);
        if (waitsForPhotons && unfinished.contains(photons)) continue;
        // That its photons failed is no fault of a run.
        if (!waitsForPhotons && m_attemptsBefore.contains(task)) judge(task);
        lost.insert(task);
    }
    return lost;
}

double TaskBoard::fraction() const {
    double all = 0, done = 0;
    for (const FarmTask& task : m_plan.tasks) all += task.predictedCost;
    const auto photonTasks = static_cast<double>(
        std::ranges::count(m_plan.tasks, FarmTask::Kind::kPhotons, &FarmTask::kind));
    const auto runTasks = static_cast<double>(m_plan.tasks.size()) - photonTasks;
    for (int number = 1; number <= static_cast<int>(m_plan.tasks.size()); ++number) {
        const FarmTask& task = m_plan.task(number);
        const bool isRun = task.kind == FarmTask::Kind::kRun;
        const double ofRuns = photonTasks > 0 ? 1 - kPhotonShare : 1;
        const double share = !isRun    ? kPhotonShare / photonTasks
                             : all > 0 ? ofRuns * task.predictedCost / all
                                       : ofRuns / runTasks;
        done += share * (m_open.contains(number) ? readProgress(m_folder.log(number)) : 1);
    }
    return std::min(done, 1.0);
}

}  // namespace pm::host
