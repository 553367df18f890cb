// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/cli/piece_options.h"

#include <fmt/format.h>

#include <algorithm>

#include "host_shim/cli/option_values.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

bool isPart(const std::filesystem::path& file) {
    return file.extension() == ".pmpart";
}

}  // namespace

void readPieces(const std::string& checkpoint, const FrameNumber& frame, Options& options) {
    for (const auto& output : options.outputs) {
        if (!isPart(output)) continue;
        if (!options.part.empty())
            throw HostError(ExitCode::kUsage, "-o: one .pmpart at most can be written");
        options.part = output;
    }
    std::erase_if(options.outputs, isPart);
    options.checkpoint = withFrame("--checkpoint", checkpoint, frame);
    if (!options.checkpoint.empty() && options.photonsOnly)
        throw HostError(ExitCode::kUsage, "--photons-only does not go together with --checkpoint");
    if (options.checkpoint.empty() && (options.resume || options.keepCheckpoint))
        throw HostError(ExitCode::kUsage,
                        fmt::format("{} needs --checkpoint FILE",
                                    options.resume ? "--resume" : "--keep-checkpoint"));
    const auto give = [&](const char* option, const char* setting, const std::string& value) {
        if (!value.empty()) options.settings.push_back({option, setting, value});
    };
    give("-o", "part", options.part.string());
    give("--checkpoint", "checkpoint", options.checkpoint.string());
    give("--resume", "resume", options.resume ? "1" : "");
}

void readPhotonMap(const std::string& photonMap, const std::map<std::string, std::string>& typed,
                   const FrameNumber& frame, Options& options) {
    options.photonMap = options.photonsOnly ? withFrame("--photon-map", photonMap, frame)
                                            : withFrameOfInput("--photon-map", photonMap, frame);
    if (!options.photonMap.empty())
        options.settings.push_back({"--photon-map", "photonMap", options.photonMap.string()});
    if (!options.photonsOnly) return;
    if (options.photonMap.empty())
        throw HostError(ExitCode::kUsage, "--photons-only needs --photon-map FILE, to be written");
    options.settings.push_back({"--photons-only", "photonsOnly", "1"});
    const auto refuse = [](bool isGiven, const std::string& option) {
        if (isGiven)
            throw HostError(
                ExitCode::kUsage,
                "--photons-only makes no picture and does not go together with " + option);
    };
    refuse(!options.outputs.empty(), "-o");
    refuse(!options.reference.empty(), "--reference");
    refuse(!options.report.empty(), "--report");
    refuse(options.onlyPixel.has_value(), "--only-pixel");
    refuse(!options.layers.empty(), "--aov");
    for (const char* option : {"--buckets", "--time-limit", "--error-target"})
        refuse(!typed.at(option).empty(), option);
}

void checkBuckets(const std::map<std::string, std::string>& typed, const Options& options) {
    if (typed.at("--buckets").empty()) return;
    const auto refuse = [](const std::string& text) {
        throw HostError(ExitCode::kUsage, "--buckets " + text);
    };
    if (options.part.empty() || !options.outputs.empty())
        refuse("needs -o NAME.pmpart and no other output: pm_host merge makes the picture");
    for (const auto& [option, value] : std::map<std::string, std::string>{
             {"--bucket-order", "correlated"}, {"--bucket-size", "auto"}})
        if (typed.at(option) == value) refuse("does not go together with " + option + " " + value);
    for (const char* option : {"--time-limit", "--error-target"})
        if (!typed.at(option).empty()) refuse(std::string("does not go together with ") + option);
    if (!options.reference.empty()) refuse("does not go together with --reference");
}

void checkMerge(const Options& options) {
    if (options.merge.empty() || options.outputs.empty()) {
        throw HostError(ExitCode::kUsage,
                        "usage: pm_host merge PART... -o FILE [options], see pm_host -h");
    }
    checkPicturesOnly("merge", options);
}

void checkPicturesOnly(const std::string& verb, const Options& options) {
    if (std::ranges::any_of(options.outputs, isPart))
        throw HostError(ExitCode::kUsage, fmt::format("-o: {} makes pictures, no .pmpart", verb));
}

}  // namespace pm::host
