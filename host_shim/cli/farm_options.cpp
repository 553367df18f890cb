// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/cli/farm_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

#include "host_shim/cli/option_values.h"
#include "host_shim/pictures/frame_numbers.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

constexpr int kMostRuns = 10'000;
constexpr int kMostTries = 100;
constexpr int kMostAtOnce = 1024;

const std::string* valueOf(const FarmOptions& farm, std::string_view name) {
    for (const GivenOption& option : farm.given)
        if (option.name == name && !option.values.empty()) return &option.values.back();
    return nullptr;
}

bool isGiven(const FarmOptions& farm, std::string_view name) {
    return std::ranges::any_of(farm.given,
                               [&](const GivenOption& option) { return option.name == name; });
}

void checkGoesTogether(const FarmOptions& farm) {
    for (const char* option :
         {"--buckets", "--checkpoint", "--resume", "--keep-checkpoint", "--photons-only",
          "--time-limit", "--error-target", "--only-pixel", "--explain", "--list",
          "--write-sidecar", "--bucket-times", "--strict"})
        if (isGiven(farm, option))
            throw HostError(ExitCode::kUsage,
                            fmt::format("farm does not go together with {}", option));
    for (const auto& [option, value] :
         {std::pair{"--bucket-order", "correlated"}, {"--bucket-size", "auto"}})
        if (const std::string* given = valueOf(farm, option); given && *given == value)
            throw HostError(ExitCode::kUsage,
                            fmt::format("farm does not go together with {} {}", option, value));
}

void readEngine(const Typed& typed, FarmOptions& farm) {
    constexpr std::array<std::string_view, 3> kEngines{"slurm", "parallel", "commands"};
    farm.engine = typed.engine;
    if (std::ranges::find(kEngines, typed.engine) == kEngines.end())
        throw HostError(
            ExitCode::kUsage,
            fmt::format("--engine '{}': allowed are slurm, parallel, commands", typed.engine));
    const auto refuse = [&](bool isGiven, const char* option, const char* engine) {
        if (isGiven && farm.engine != engine)
            throw HostError(ExitCode::kUsage, fmt::format("{} is of --engine {}", option, engine));
    };
    refuse(!typed.sshLogins.empty(), "--sshlogin", "parallel");
    refuse(!typed.atOnce.empty(), "--at-once", "parallel");
    refuse(!typed.slurmOptions.empty(), "--slurm-option", "slurm");
    farm.sshLogins = typed.sshLogins;
    farm.slurmOptions = typed.slurmOptions;
}

// The file of tasks has one a line.
void checkLines(const FarmOptions& farm, const std::string& job) {
    const auto check = [](const std::string& name, const std::string& value) {
        if (value.find('\n') == std::string::npos) return;
        throw HostError(ExitCode::kUsage,
                        fmt::format("{} '{}': of a farm's names and values none can have a line "
                                    "break",
                                    name, value));
    };
    check("--job", std::filesystem::absolute(job).string());
    for (const GivenOption& option : farm.given)
        for (const std::string& value : option.values) check(option.name, value);
}

}  // namespace

std::vector<GivenOption> givenOptions(const CLI::App& app) {
    std::vector<GivenOption> given;
    for (const CLI::Option* option : app.get_options()) {
        if (option->count() == 0) continue;
        const bool isFlag = option->get_items_expected_max() == 0;
        const std::string name =
            option->get_positional() ? option->get_name(true) : "--" + option->get_lnames().front();
        given.push_back({name, isFlag ? std::vector<std::string>{} : option->results()});
    }
    return given;
}

void readFrames(Typed& typed, Options& options) {
    if (typed.frames.empty()) return;
    if (!typed.frame.empty())
        throw HostError(ExitCode::kUsage, "--frames and --frame: it is one or the other");
    options.frames = frameNumbers("--frames", typed.frames);
    typed.frame = std::to_string(options.frames.front());
}

void readFarm(const Typed& typed, Options& options) {
    FarmOptions& farm = *options.farm;
    checkGoesTogether(farm);
    if (!options.part.empty())
        throw HostError(ExitCode::kUsage, "-o: farm makes pictures, no .pmpart");
    readEngine(typed, farm);
    if (typed.job.empty())
        throw HostError(ExitCode::kUsage,
                        "farm needs --job FOLDER, where plan, photons, parts and logs are kept");
    checkLines(farm, typed.job);
    farm.job = typed.job;
    if (!typed.runs.empty() && typed.runs != "auto")
        farm.runs = static_cast<int>(integerValue("--runs", typed.runs, 1, kMostRuns));
    if (!typed.tries.empty())
        farm.tries = static_cast<int>(integerValue("--tries", typed.tries, 1, kMostTries));
    if (!typed.atOnce.empty())
        farm.atOnce = static_cast<int>(integerValue("--at-once", typed.atOnce, 1, kMostAtOnce));
}

}  // namespace pm::host
