// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/farm/farm_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <vector>

#include "host_shim/farm/job/task_events.h"
#include "host_shim/log/progress.h"
#include "host_shim/report/report_html.h"

namespace pm::host {
namespace {

constexpr double kWidth = 1000, kLeft = 160, kRowHeight = 22, kBottom = 30;  // CSS pixels

struct Stay {
    int task{};
    TaskAttempt attempt;
};

struct Timeline {
    std::vector<Stay> stays;
    double begin{}, end{};  // seconds since 1970
};

Timeline timelineOf(const FarmPlan& plan, const JobFolder& folder) {
    Timeline timeline;
    timeline.begin = std::numeric_limits<double>::infinity();
    for (int task = 1; task <= static_cast<int>(plan.tasks.size()); ++task)
        for (const TaskAttempt& attempt : readAttempts(folder.events(task))) {
            timeline.stays.push_back({task, attempt});
            timeline.begin = std::min(timeline.begin, attempt.start);
            timeline.end = std::max({timeline.end, attempt.start, attempt.end.value_or(0)});
        }
    std::ranges::stable_sort(timeline.stays, {},
                             [](const Stay& stay) { return stay.attempt.start; });
    return timeline;
}

std::string endText(const TaskAttempt& attempt, bool isDone) {
    if (attempt.exitCode) return fmt::format("exit {}", *attempt.exitCode);
    return isDone ? "killed" : "runs, or was killed";
}

const char* colourOf(const TaskAttempt& attempt) {
    if (!attempt.exitCode) return "#b0b0b0";
    return *attempt.exitCode == 0 ? "#2a7d3c" : "#b3261e";
}

// A row for each machine; more where it does several at once.
class Rows {
  public:
    std::size_t place(const std::string& machine, double start, double end) {
        auto& lanes = m_lanes[machine];
        for (auto& [row, busyUntil] : lanes)
            if (busyUntil <= start) {
                busyUntil = end;
                return row;
            }
        lanes.emplace_back(m_names.size(), end);
        m_names.push_back(machine);
        return m_names.size() - 1;
    }
    const std::vector<std::string>& names() const { return m_names; }

  private:
    std::map<std::string, std::vector<std::pair<std::size_t, double>>> m_lanes;
    std::vector<std::string> m_names;  // by row
};

std::string chart(const FarmPlan& plan, const Timeline& timeline) {
    const double length = std::max(timeline.end - timeline.begin, 1e-3);
    const auto place = [&](double time) {
        return kLeft + (time - timeline.begin) / length * (kWidth - kLeft - 1);
    };
    Rows rows;
    std::string bars;
    for (const auto& [task, attempt] : timeline.stays) {
        const double end = attempt.end.value_or(timeline.end);
        const std::size_t row = rows.place(attempt.machine, attempt.start, end);
        bars += fmt::format(
            "<rect x=\"{:.1f}\" y=\"{:.0f}\" width=\"{:.1f}\" height=\"{:.0f}\" fill=\"{}\" "
            "stroke=\"#fff\"><title>{}</title></rect>\n",
            place(attempt.start), static_cast<double>(row) * kRowHeight + 2,
            std::max(place(end) - place(attempt.start), 1.0), kRowHeight - 4, colourOf(attempt),
            escaped(fmt::format("task {}: {}", task, plan.what(task))));
    }
    std::string labels;
    for (std::size_t row = 0; row < rows.names().size(); ++row)
        labels +=
            fmt::format("<text class=\"label\" x=\"0\" y=\"{:.0f}\">{}</text>\n",
                        static_cast<double>(row) * kRowHeight + 15, escaped(rows.names()[row]));
    const double height = static_cast<double>(rows.names().size()) * kRowHeight + kBottom;
    for (const double share : {0.0, 0.5, 1.0})
        labels += fmt::format(
            "<text class=\"label\" x=\"{:.0f}\" y=\"{:.0f}\" text-anchor=\"{}\">{:.1f} s</text>\n",
            kLeft + share * (kWidth - kLeft), height - 8,
            share == 0   ? "start"
            : share == 1 ? "end"
                         : "middle",
            share * length);
    return fmt::format("<svg viewBox=\"0 0 {:.0f} {:.0f}\" width=\"{:.0f}\">\n{}{}</svg>\n", kWidth,
                       height, kWidth, bars, labels);
}

std::string stayTable(const FarmPlan& plan, const Timeline& timeline) {
    std::vector<Row> rows;
    std::error_code failed;
    for (const auto& [task, attempt] : timeline.stays) {
        const FarmTask& its = plan.task(task);
        rows.push_back(
            {std::to_string(task), escaped(plan.what(task)), escaped(attempt.machine),
             fmt::format("{:.2f}", attempt.start - timeline.begin),
             attempt.end ? fmt::format("{:.2f}", *attempt.end - attempt.start) : "",
             endText(attempt, std::filesystem::exists(its.product, failed)),
             its.kind == FarmTask::Kind::kRun ? fmt::format("{:.3g}", its.predictedCost) : ""});
    }
    return table(
        {"task", "what", "machine", "start, s", "took, s", "end", "predicted, thread-seconds"},
        rows);
}

}  // namespace

std::string farmPage(const FarmPlan& plan, const JobFolder& folder) {
    const Timeline timeline = timelineOf(plan, folder);
    std::size_t done = 0;
    std::error_code failed;
    for (const FarmTask& task : plan.tasks)
        if (std::filesystem::exists(task.product, failed)) ++done;
    std::string body = fmt::format("<h1>{}</h1>\n", escaped(folder.path().filename().string())) +
                       paragraph(fmt::format("{} of {} tasks are done; instruction set {}.", done,
                                             plan.tasks.size(), plan.isa));
    if (timeline.stays.empty()) {
        body += paragraph("No task has begun.");
    } else {
        body += paragraph(fmt::format("From the first start to the last end {}.",
                                      clockText(timeline.end - timeline.begin)));
        body += section("machines", "Machines", wideBox(chart(plan, timeline)));
        body += section("tasks", "Tasks as they were started", stayTable(plan, timeline));
    }
    return wholePage("pm farm: " + folder.path().filename().string(), body);
}

}  // namespace pm::host
