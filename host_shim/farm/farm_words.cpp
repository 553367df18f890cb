// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/farm/farm_words.h"

#include <algorithm>
#include <set>
#include <string_view>

namespace pm::host {
namespace {

using Names = std::set<std::string_view>;

// Of how the farm works, and what is shown of it.
const Names& ofTheFarm() {
    static const Names names{"--engine",       "--job",     "--tries",    "--at-once", "--sshlogin",
                             "--slurm-option", "--dry-run", "--progress", "--quiet",   "--verbose"};
    return names;
}

// Of the picture that is made of parts, or set anew for each task.
const Names& notOfTasks() {
    static const Names names{
        "--output",      "--stats",       "--log",         "--report",
        "--reference",   "--error-limit", "--exr-half",    "--make-output-path",
        "--frame",       "--frames",      "--runs",        "--isa",
        "--bucket-size", "--photon-map",  "--photons-each"};
    return names;
}

const Names& ofMerge() {
    static const Names names{"--exr-half",       "--make-output-path",
                             "--reference",      "--error-limit",
                             "--ocio",           "--rendering-space",
                             "--material-space", "--texture-space",
                             "--display",        "--view",
                             "--exposure",       "--look",
                             "--context",        "--plugin",
                             "--quiet",          "--verbose"};
    return names;
}

void add(const GivenOption& option, std::vector<std::string>& words) {
    if (option.name == "SCENE") {
        words.push_back(option.values.back());
    } else if (option.values.empty()) {
        words.push_back(option.name);
    } else {
        for (const std::string& value : option.values)
            words.insert(words.end(), {option.name, value});
    }
}

std::vector<std::string> taskWords(const Options& options, std::optional<std::int64_t> frame,
                                   const Names& besides) {
    std::vector<std::string> words;
    for (const GivenOption& option : options.farm->given)
        if (!ofTheFarm().contains(option.name) && !notOfTasks().contains(option.name) &&
            !besides.contains(option.name))
            add(option, words);
    if (frame) words.insert(words.end(), {"--frame", std::to_string(*frame)});
    return words;
}

}  // namespace

std::vector<std::string> renderWords(const Options& options, std::optional<std::int64_t> frame) {
    return taskWords(options, frame, {});
}

std::vector<std::string> photonWords(const Options& options, std::optional<std::int64_t> frame) {
    return taskWords(options, frame, {"--aov"});
}

std::vector<std::string> mergeWords(const Options& options) {
    std::vector<std::string> words;
    for (const GivenOption& option : options.farm->given)
        if (ofMerge().contains(option.name)) add(option, words);
    // With the number of the frame in them.
    for (const auto& output : options.outputs) words.insert(words.end(), {"-o", output.string()});
    const auto give = [&](const char* option, const std::string& value) {
        if (!value.empty()) words.insert(words.end(), {option, value});
    };
    give("--stats", options.statistics);
    give("--log", options.log.string());
    give("--report", options.report.string());
    return words;
}

std::vector<GivenOption> planOptions(const FarmOptions& farm) {
    std::vector<GivenOption> options;
    std::ranges::copy_if(farm.given, std::back_inserter(options), [](const GivenOption& option) {
        return !ofTheFarm().contains(option.name);
    });
    return options;
}

const std::string* givenValue(const FarmOptions& farm, const std::string& name) {
    for (const GivenOption& option : farm.given)
        if (option.name == name && !option.values.empty()) return &option.values.back();
    return nullptr;
}

}  // namespace pm::host
