// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/watch/part_list.h"

#include <fmt/format.h>

#include <algorithm>

#include "host_shim/farm/job/job_folder.h"
#include "host_shim/farm/job/task_events.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> partsIn(const fs::path& folder) {
    std::vector<fs::path> parts;
    std::error_code failed;
    for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end;
         entry.increment(failed))
        if (entry->path().extension() == ".pmpart") parts.push_back(entry->path());
    std::ranges::sort(parts);
    return parts;
}

std::vector<ListedPart> namedParts(const std::vector<fs::path>& names) {
    std::vector<ListedPart> parts;
    std::error_code failed;
    for (const fs::path& name : names) {
        if (!fs::is_directory(name, failed)) {
            parts.push_back({name, {}, {}, false, 0});
            continue;
        }
        for (const fs::path& file : partsIn(name)) parts.push_back({file, {}, {}, false, 0});
    }
    return parts;
}

std::size_t frameOf(const FarmPlan& plan, const WatchOptions& watch) {
    if (!watch.frame && plan.frames.size() == 1) return 0;
    std::string numbers;
    for (std::size_t i = 0; i < plan.frames.size(); ++i) {
        const auto& number = plan.frames[i].number;
        if (watch.frame && number == watch.frame) return i;
        if (number) numbers += fmt::format("{}{}", numbers.empty() ? "" : ", ", *number);
    }
    throw HostError(ExitCode::kUsage,
                    fmt::format("--job {}: --frame N chooses one of its frames; they are {}",
                                watch.job.string(), numbers.empty() ? "without number" : numbers));
}

void addAttempts(const JobFolder& folder, int task, ListedPart& part) {
    const std::vector<TaskAttempt> attempts = readAttempts(folder.events(task));
    if (attempts.empty()) return;
    // Of several the one that made it, else the last.
    const auto made = std::ranges::find_if(
        attempts, [](const TaskAttempt& attempt) { return attempt.exitCode == 0; });
    const TaskAttempt& attempt = made == attempts.end() ? attempts.back() : *made;
    part.machine = attempt.machine;
    part.isUnderWay = !attempt.end;
    if (part.isUnderWay) part.progress = readProgress(folder.log(task));
}

std::vector<ListedPart> partsOfJob(const WatchOptions& watch) {
    const JobFolder folder(watch.job);
    const auto plan = folder.readPlan();
    if (!plan) return {};
    const std::size_t frame = frameOf(*plan, watch);
    std::vector<ListedPart> parts;
    for (int number = 1; number <= static_cast<int>(plan->tasks.size()); ++number) {
        const FarmTask& task = plan->task(number);
        if (task.kind != FarmTask::Kind::kRun || task.frame != frame) continue;
        ListedPart& part = parts.emplace_back();
        part.file = task.product;
        part.what = fmt::format("{}:{}", task.first, task.last);
        addAttempts(folder, number, part);
    }
    return parts;
}

}  // namespace

std::vector<ListedPart> listParts(const Options& options) {
    return options.watch->job.empty() ? namedParts(options.merge) : partsOfJob(*options.watch);
}

}  // namespace pm::host
