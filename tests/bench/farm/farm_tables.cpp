// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/farm/farm_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "tests/bench/plot/log_plot.h"

namespace pm::bench {

namespace {

constexpr double kHour = 3600;
// Shorter ones are of no use to a farm; so long is a heavy frame on one machine of 64 threads.
constexpr std::array kLengths{kHour, 64 * kHour};
constexpr std::array kWorkers{1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024};
constexpr double kMegabit = 1e6 / 8, kLatencySeconds = 0.5e-3;

struct Network {
    const char* name;
    double serverRate, linkRate;  // bytes a second
};
constexpr std::array kNetworks{
    Network{"0.1 Gbit/s for all", 94 * kMegabit, 94 * kMegabit},
    Network{"1 Gbit/s", 940 * kMegabit, 940 * kMegabit},
    Network{"server 10, workers 1 Gbit/s", 9400 * kMegabit, 940 * kMegabit},
    Network{"server 100, workers 10 Gbit/s", 94000 * kMegabit, 9400 * kMegabit}};
constexpr Network kUsual = kNetworks[2];

std::string percent(double share) {
    return fmt::format("{:.1f} %", 100 * share);
}

// Where Slurm is not installed, as it was measured elsewhere: docs/lab/farm_scale.md.
FarmRules latenciesOf(const MeasuredFarm& farm) {
    if (farm.realFrame) return farm.latencies;
    FarmRules rules;
    rules.submitSeconds = rules.afterPhotons = rules.dispatchSeconds = rules.noticeSeconds = 1;
    return rules;
}

FarmRules rulesOf(const MeasuredFarm& farm, int workers, const Network& network, bool photonsOnce) {
    FarmRules rules = latenciesOf(farm);
    rules.workers = workers;
    rules.photonsOnce = photonsOnce;
    rules.serverRate = network.serverRate;
    rules.linkRate = network.linkRate;
    rules.latencySeconds = kLatencySeconds;
    return rules;
}

double efficiency(const FarmCosts& costs, const FarmRules& rules) {
    return efficiencyOf(costs, replayFarm(costs, rules), rules.workers);
}

std::string lengthName(double seconds) {
    return fmt::format("{:.0f} h", seconds / kHour);
}

// Ways that exist for a frame: with photons once or each.
std::vector<bool> waysOf(const MeasuredFrame& frame) {
    return frame.costs.photonSeconds > 0 ? std::vector{true, false} : std::vector{true};
}

std::string wayName(const MeasuredFrame& frame, bool once) {
    if (frame.costs.photonSeconds <= 0) return frame.name;
    return frame.name + (once ? ", traced once" : ", traced by each run");
}

// Calls tell(frame, once, costs, row) for each way of each frame of both lengths, and reports the
// row, which begins with their names.
template <typename Tell>
void forEachWay(const MeasuredFarm& farm, Report& report, const Tell& tell) {
    for (const double length : kLengths)
        for (const MeasuredFrame& frame : farm.frames)
            for (const bool once : waysOf(frame)) {
                std::vector<std::string> row{wayName(frame, once), lengthName(length)};
                tell(frame, once, frame.lastingFor(length), row);
                report.row(row);
            }
}

// From how long a frame on so many workers has such an efficiency; as text.
std::string longEnough(const MeasuredFarm& farm, const MeasuredFrame& frame, bool once, int workers,
                       double wanted) {
    for (double length = kHour / 4; length <= 1024 * kHour; length *= 2) {
        const FarmCosts costs = frame.lastingFor(length);
        if (efficiency(costs, rulesOf(farm, workers, kUsual, once)) >= wanted)
            return fmt::format("{:g} h", length / kHour);
    }
    return "never";
}

}  // namespace

void tellCosts(const MeasuredFarm& farm, Report& report) {
    report.table(
        "Processor seconds of one thread for each frame, and bytes. Start: of each process, "
        "until the first pass begins; maps: of each run, photons read and maps made of them "
        "in all passes; pilot: the small picture from which runs are cut",
        {"frame", "pixels", "passes", "buckets", "buckets' seconds", "photons", "start", "maps",
         "maps, share of the frame", "pilot", "merge", "photon file MB", "parts MB"});
    for (const MeasuredFrame& frame : farm.frames) {
        const FarmCosts& c = frame.costs;
        const double buckets = std::accumulate(c.buckets.begin(), c.buckets.end(), 0.0);
        report.row(
            {frame.name, frame.size, std::to_string(frame.passes), std::to_string(c.buckets.size()),
             show(buckets), show(c.photonSeconds), show(c.startSeconds), show(c.mapSeconds),
             percent(c.mapSeconds / (c.localSeconds() - c.startSeconds)), show(c.pilotSeconds),
             show(c.mergeSeconds), show(c.photonBytes / 1e6), show(c.partBytes / 1e6)});
    }
}

void tellReal(const MeasuredFarm& farm, Report& report) {
    if (!farm.realFrame) {
        report.paragraph("No farm was timed: Slurm is not installed.");
        return;
    }
    const FarmRules& l = farm.latencies;
    report.paragraph(fmt::format(
        "Slurm's latencies, measured on a small frame: {:.2f} s from the plan to the first task, "
        "{:.2f} s from the photons' end to the first run, {:.2f} s from a run's end to the next "
        "one's start (median), {:.2f} s from the last run's end to merging. With all {} processors "
        "at work a thread has {:.2f} of the speed of one alone.",
        l.submitSeconds, l.afterPhotons, l.dispatchSeconds, l.noticeSeconds, farm.cores,
        farm.sharedSpeed));
    report.table(fmt::format("Farms on Slurm, {}, {} passes, {} runs, nodes of one thread that "
                             "share {} processors: timed and replayed. Others: processors that "
                             "other programs kept busy meanwhile, which the replay takes away",
                             farm.realFrame->size, farm.realFrame->passes,
                             farm.realFarms.front().runs, farm.cores),
                 {"workers", "timed, s", "replayed, s", "error", "runs alone: timed, s",
                  "replayed, s", "error", "others"});
    for (const RealFarm& real : farm.realFarms) {
        FarmRules rules = l;
        rules.workers = real.workers;
        rules.runs = real.runs;
        rules.cores = std::max(0.1, farm.cores - real.others);
        rules.sharedSpeed = farm.sharedSpeed;
        const FarmReplay replay = replayFarm(farm.realFrame->costs, rules);
        report.row({std::to_string(real.workers), show(real.seconds), show(replay.seconds),
                    fmt::format("{:+.1f} %", 100 * (replay.seconds / real.seconds - 1)),
                    show(real.runSeconds), show(replay.runSeconds),
                    fmt::format("{:+.1f} %", 100 * (replay.runSeconds / real.runSeconds - 1)),
                    show(real.others)});
    }
}

void tellScale(const MeasuredFarm& farm, Report& report) {
    std::vector<std::string> header{"frame", "on one worker"};
    for (const int workers : kWorkers) header.push_back(std::to_string(workers));
    report.table(
        fmt::format("Efficiency by workers: time on one worker without a farm over workers "
                    "times the farm's time, from the command to the picture; network: {}, "
                    "{} ms; in brackets the runs that pm_host farm cuts",
                    kUsual.name, kLatencySeconds * 1e3),
        header);
    forEachWay(
        farm, report,
        [&](const MeasuredFrame&, bool once, const FarmCosts& costs,
            std::vector<std::string>& row) {
            for (const int workers : kWorkers) {
                const FarmReplay replay = replayFarm(costs, rulesOf(farm, workers, kUsual, once));
                row.push_back(fmt::format("{:.1f} % ({})",
                                          100 * efficiencyOf(costs, replay, workers), replay.runs));
            }
        });
}

void tellNetworks(const MeasuredFarm& farm, Report& report) {
    constexpr int kMany = 64;
    std::vector<std::string> header{"frame", "on one worker"};
    for (const Network& network : kNetworks) header.emplace_back(network.name);
    for (const char* more :
         {"1 run a worker", "2 runs", "6 runs", "a tenth of workers at half speed"})
        header.emplace_back(more);
    header.emplace_back("95 % from, on one worker");
    report.table(fmt::format("Efficiency of {} workers by network; then with {} by the number of "
                             "runs, and with slow workers; and how long a frame has to be",
                             kMany, kUsual.name),
                 header);
    forEachWay(
        farm, report,
        [&](const MeasuredFrame& frame, bool once, const FarmCosts& costs,
            std::vector<std::string>& row) {
            for (const Network& network : kNetworks)
                row.push_back(percent(efficiency(costs, rulesOf(farm, kMany, network, once))));
            FarmRules rules = rulesOf(farm, kMany, kUsual, once);
            for (const int each : {1, 2, 6}) {
                rules.runs = each * kMany;
                row.push_back(percent(efficiency(costs, rules)));
            }
            rules.runs = 0;
            rules.slowShare = 0.1;
            rules.slowSpeed = 0.5;
            row.push_back(percent(efficiency(costs, rules)));
            row.push_back(longEnough(farm, frame, once, kMany, 0.95));
        });
}

void tellPaper(const MeasuredFarm& farm, Report& report) {
    constexpr double kMinutes = 10;
    report.table(
        fmt::format("One to eight computers as the paper had them: a frame of {:g} minutes "
                    "on one, network {}; seconds, replayed, and the share of the time "
                    "that twice the computers save (mean) and eight save over one; the "
                    "paper says 37 % and up to 85 %",
                    kMinutes, kNetworks[0].name),
        {"frame", "1", "2", "4", "8", "twice save", "eight save"});
    for (const MeasuredFrame& frame : farm.frames)
        for (const bool once : waysOf(frame)) {
            const FarmCosts costs = frame.lastingFor(60 * kMinutes);
            std::vector<std::string> row{wayName(frame, once)};
            std::vector<double> seconds;
            for (const int workers : {1, 2, 4, 8}) {
                const FarmRules rules = rulesOf(farm, workers, kNetworks[0], once);
                seconds.push_back(replayFarm(costs, rules).seconds);
                row.push_back(show(seconds.back()));
            }
            double saved = 0;
            for (std::size_t i = 1; i < seconds.size(); ++i)
                saved += (1 - seconds[i] / seconds[i - 1]) / 3;
            row.push_back(percent(saved));
            row.push_back(percent(1 - seconds.back() / seconds.front()));
            report.row(row);
        }
}

void tellFaults(const MeasuredFarm& farm, Report& report) {
    report.paragraph(
        fmt::format("Ended by SIGTERM after every {:.0f} processor seconds and gone on with from "
                    "its checkpoint, "
                    "a render of {:.1f} s took {:.1f} s ({} starts): {:.1f} % more.",
                    farm.preemptedEvery, farm.wholeSeconds, farm.preemptedSeconds,
                    farm.preemptedStarts, 100 * (farm.preemptedSeconds / farm.wholeSeconds - 1)));
    report.table(
        "What is lost where every task is ended each 30 s: time of the runs of 8 workers over "
        "that without, replayed",
        {"frame", "on one worker", "lost"});
    for (const MeasuredFrame& frame : farm.frames) {
        const FarmCosts costs = frame.lastingFor(kHour);
        FarmRules rules = rulesOf(farm, 8, kUsual, true);
        const double calm = replayFarm(costs, rules).runSeconds;
        rules.preemptedEvery = 30;
        const std::string lost = percent(1 - calm / replayFarm(costs, rules).runSeconds);
        report.row({frame.name, lengthName(kHour), lost});
    }
}

void plotScale(const MeasuredFarm& farm, const std::filesystem::path& file) {
    LogPlot plot{"An hour's frame on a farm, replayed; photons by each run",
                 "workers",
                 "times as fast as one worker",
                 {},
                 0,
                 ""};
    PlotLine ideal{"all of it", {}, true};
    for (const int workers : kWorkers) ideal.points.emplace_back(workers, workers);
    plot.lines.push_back(ideal);
    for (const MeasuredFrame& frame : farm.frames) {
        const FarmCosts costs = frame.lastingFor(kHour);
        PlotLine line{frame.name, {}, false};
        for (const int workers : kWorkers)
            line.points.emplace_back(
                workers, workers * efficiency(costs, rulesOf(farm, workers, kUsual, false)));
        plot.lines.push_back(line);
    }
    writeSvg(file, plot);
}

}  // namespace pm::bench
