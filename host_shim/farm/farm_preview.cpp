// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/farm/farm_preview.h"

#include <fmt/format.h>

#include "host_shim/process/plain_text.h"
#include "host_shim/report/report_command.h"

namespace pm::host {
namespace {

std::vector<int> tasksOf(const FarmPlan& plan, FarmTask::Kind kind) {
    std::vector<int> tasks;
    for (int number = 1; number <= static_cast<int>(plan.tasks.size()); ++number)
        if (plan.task(number).kind == kind) tasks.push_back(number);
    return tasks;
}

std::string mergeCommands(const FarmPlan& plan) {
    std::string text;
    for (std::size_t frame = 0; frame < plan.frames.size(); ++frame) {
        Arguments words{plan.program.string(), "merge"};
        for (const FarmTask& task : plan.tasks)
            if (task.kind == FarmTask::Kind::kRun && task.frame == frame)
                words.push_back(task.product.string());
        const auto& more = plan.frames[frame].mergeWords;
        words.insert(words.end(), more.begin(), more.end());
        text +=
            fmt::format("cd {} && {}\n", shellCommand({plan.folder.string()}), shellCommand(words));
    }
    return text;
}

}  // namespace

std::string farmPreview(const FarmPlan& plan, const JobFolder& folder, const Engine* engine) {
    std::string text =
        fmt::format("job {}\ninstruction set {}\n", folder.path().string(), plan.isa);
    for (int number = 1; number <= static_cast<int>(plan.tasks.size()); ++number) {
        const FarmTask& task = plan.task(number);
        text += fmt::format("task {}: {}", number, plan.what(number));
        if (task.kind == FarmTask::Kind::kRun)
            text += fmt::format(", {:.3g} thread-seconds predicted", task.predictedCost);
        text += "\n";
    }
    if (engine != nullptr)
        text += engine->preview({tasksOf(plan, FarmTask::Kind::kPhotons),
                                 tasksOf(plan, FarmTask::Kind::kRun),
                                 {}}) +
                mergeCommands(plan);
    else
        text += farmCommands(plan, folder);
    return plainLines(text);
}

std::string farmCommands(const FarmPlan& plan, const JobFolder& folder) {
    std::string text;
    int stage = 0;
    for (const auto& [kind, name] : {std::pair{FarmTask::Kind::kPhotons, "photons"},
                                     {FarmTask::Kind::kRun, "runs of buckets"}}) {
        const std::vector<int> tasks = tasksOf(plan, kind);
        if (tasks.empty()) continue;
        text += fmt::format("# stage {}: {}\n", ++stage, name);
        for (const int task : tasks)
            text +=
                "sh " + shellCommand({folder.runScript().string(), std::to_string(task)}) + "\n";
    }
    return text + fmt::format("# stage {}: pictures\n", ++stage) + mergeCommands(plan);
}

}  // namespace pm::host
