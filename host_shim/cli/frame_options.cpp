// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/cli/frame_options.h"

#include <fmt/format.h>

#include <map>

#include "host_shim/cli/command_line.h"
#include "host_shim/pictures/file_ending.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

constexpr std::string_view kFrames = "--frames";

std::vector<std::string> withFrameNumber(const std::vector<std::string>& words,
                                         std::int64_t frame) {
    std::vector<std::string> changed;
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (words[i] == kFrames)
            ++i;
        else if (!words[i].starts_with(std::string(kFrames) + "="))
            changed.push_back(words[i]);
    }
    changed.insert(changed.end(), {"--frame", std::to_string(frame)});
    return changed;
}

std::vector<std::filesystem::path> filesOf(const Options& options) {
    std::vector<std::filesystem::path> files = options.outputs;
    for (const std::filesystem::path& file :
         {options.log, options.report, options.bucketTimes, options.part, options.checkpoint,
          std::filesystem::path(options.statistics == "-" ? "" : options.statistics),
          options.photonsOnly ? options.photonMap : std::filesystem::path()})
        if (!file.empty()) files.push_back(file);
    return files;
}

// But for names of files that are written.
std::vector<std::pair<std::string, std::string>> settingsOf(const Options& options) {
    std::vector<std::pair<std::string, std::string>> settings;
    for (const GivenSetting& given : options.settings) {
        const bool isWritten = given.name == "part" || given.name == "checkpoint" ||
                               (given.name == "photonMap" && options.photonsOnly);
        if (!isWritten) settings.emplace_back(given.name, given.value);
    }
    return settings;
}

}  // namespace

std::vector<Options> perFrame(const Options& options) {
    if (options.frames.empty()) return {options};
    std::vector<Options> frames;
    std::map<std::filesystem::path, std::int64_t> writers;
    for (const std::int64_t frame : options.frames) {
        const std::vector<std::string> words = withFrameNumber(options.commandLine, frame);
        Options one = parseCommandLine(words);
        one.commandLine = words;
        for (const std::filesystem::path& file : filesOf(one)) {
            const auto [known, isNew] = writers.emplace(file.lexically_normal(), frame);
            if (!isNew && known->second != frame)
                throw HostError(
                    ExitCode::kUsage,
                    fmt::format("--frames: {} would be written by frames {} and {}; its name "
                                "needs #### or %04d",
                                file.string(), known->second, frame));
        }
        frames.push_back(std::move(one));
    }
    return frames;
}

bool tellsErrorScale(const Options& options) {
    bool tells = false;
    for (const GivenSetting& given : options.settings)
        if (given.name == "errorScale") tells = given.value != "auto";
    return tells;
}

Options ofErrorScale(Options frame, std::optional<std::int32_t> stops) {
    if (!stops || !frame.merge.empty() || tellsErrorScale(frame)) return frame;
    const std::string text = std::to_string(*stops);
    frame.settings.push_back({"--error-scale", "errorScale", text});
    frame.commandLine.insert(frame.commandLine.begin(), {"--error-scale", text});
    return frame;
}

bool areSameRender(const Options& frame, const Options& other) {
    // The frame's number is the clock of scenes of POV-Ray's.
    const bool isSameClock = lowerCaseExtension(frame.scene) != ".pov" ||
                             frame.reading.pov.frame == other.reading.pov.frame;
    return isSameClock && frame.scene == other.scene && frame.merge == other.merge &&
           settingsOf(frame) == settingsOf(other);
}

}  // namespace pm::host
