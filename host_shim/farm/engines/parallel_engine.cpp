// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/farm/engines/parallel_engine.h"

#include <fmt/format.h>

#include "host_shim/farm/engines/machine_question.h"
#include "host_shim/formats/warnings.h"
#include "host_shim/report/report_command.h"
#include "host_shim/values/host_error.h"

namespace pm::host {

ParallelEngine::ParallelEngine(const FarmOptions& options, const JobFolder& folder, Log& log)
    : m_options(options), m_folder(folder), m_log(log) {}

std::vector<FarmMachine> ParallelEngine::machines() {
    std::vector<std::string> ask{"parallel", "--will-cite", "--nonall"};
    if (m_options.sshLogins.empty()) ask = {"sh", "-c"};
    for (const std::string& login : m_options.sshLogins)
        ask.insert(ask.end(), {"--sshlogin", login});
    ask.push_back(machineQuestion());
    const ProgramEnd answer = runProgram(ask, kToAnswer);
    std::vector<FarmMachine> machines = machineAnswers(answer.out);
    if (machines.empty())
        throw HostError(ExitCode::kUsage,
                        fmt::format("--sshlogin: no machine answers: {}", answer.err));
    if (machines.size() < m_options.sshLogins.size())
        m_log.warning(static_cast<int>(Warning::kFarm),
                      fmt::format("{} of {} machines answer: {}", machines.size(),
                                  m_options.sshLogins.size(), answer.err));
    return machines;
}

std::vector<std::string> ParallelEngine::words(const std::vector<int>& tasks) const {
    std::vector<std::string> words{"parallel", "--will-cite", "--jobs",
                                   std::to_string(m_options.atOnce)};
    if (!m_options.sshLogins.empty()) words.emplace_back("--filter-hosts");
    for (const std::string& login : m_options.sshLogins)
        words.insert(words.end(), {"--sshlogin", login});
    // Of the command parallel replaces whatever looks like {} or {=...=}; not of what it puts
    // there.
    words.insert(words.end(), {"sh {1} {2}", ":::", m_folder.runScript().string(), ":::"});
    for (const int task : tasks) words.push_back(std::to_string(task));
    return words;
}

// parallel gives a task to whoever is free first; machines to avoid it can't be told but by leaving
// them out altogether.
void ParallelEngine::start(const Order& order) {
    if (!order.first.empty()) m_waiting.push_back({order.first, false});
    if (!order.then.empty()) m_waiting.push_back({order.then, !order.first.empty()});
    if (!m_program) startNext();
}

void ParallelEngine::startNext() {
    while (!m_waiting.empty()) {
        m_current = m_waiting.front();
        m_waiting.pop_front();
        if (m_current.needsTheLast && m_lastFailed) continue;  // they would fail
        m_program =
            std::make_unique<BackgroundProgram>(words(m_current.tasks), m_folder.engineLog());
        return;
    }
}

std::set<int> ParallelEngine::unfinished() {
    if (m_program) {
        if (const auto code = m_program->ended()) {
            m_lastFailed = *code != 0;
            m_program.reset();
            startNext();
        }
    }
    std::set<int> tasks;
    if (m_program) tasks.insert(m_current.tasks.begin(), m_current.tasks.end());
    for (const Batch& batch : m_waiting) tasks.insert(batch.tasks.begin(), batch.tasks.end());
    return tasks;
}

void ParallelEngine::cancel() {
    m_waiting.clear();
    if (m_program) m_program->end();
    m_program.reset();
}

std::string ParallelEngine::preview(const Order& order) const {
    std::string text;
    for (const std::vector<int>& tasks : {order.first, order.then})
        if (!tasks.empty()) text += shellCommand(words(tasks)) + "\n";
    return text;
}

}  // namespace pm::host
