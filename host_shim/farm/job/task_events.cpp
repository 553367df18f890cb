// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/farm/job/task_events.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string_view>

#include "host_shim/formats/json/json_reader.h"
#include "host_shim/formats/text_lines.h"
#include "host_shim/process/interrupt.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

constexpr std::string_view kProgressLine = "{\"progress\":";

std::vector<std::string> wordsOf(const std::string& line) {
    std::vector<std::string> words;
    std::istringstream stream(line);
    for (std::string word; stream >> word;) words.push_back(word);
    return words;
}

// The end of a file, without the line that was cut.
std::vector<std::string> lastLines(const std::filesystem::path& file) {
    constexpr std::streamoff kMost = 8192;
    std::ifstream stream(file, std::ios::binary | std::ios::ate);
    if (!stream) return {};
    const std::streamoff size = stream.tellg();
    stream.seekg(std::max(std::streamoff{0}, size - kMost));
    std::vector<std::string> lines;
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    if (size > kMost && !lines.empty()) lines.erase(lines.begin());
    return lines;
}

// Of two that run at once both are noted, so machine and process say whose end it is.
void addEnd(const std::vector<std::string>& words, double time,
            std::vector<TaskAttempt>& attempts) {
    std::int64_t code = 0;
    if (words.size() != 5 || !parseInteger(words[4], code)) return;
    const auto found = std::find_if(attempts.rbegin(), attempts.rend(), [&](const TaskAttempt& a) {
        return !a.end && a.machine == words[2] && a.process == words[3];
    });
    if (found == attempts.rend()) return;
    found->end = time;
    found->exitCode = static_cast<int>(code);
}

// None where a line is no JSON: it may have been written to while it was read.
std::optional<double> progressOf(const std::string& line, const std::filesystem::path& log) {
    try {
        const auto json = parseJson(line, log.string(), throwIfInterrupted);
        const auto progress = json.find("progress");
        if (progress == json.end() || !progress->is_number()) return std::nullopt;
        return std::clamp(progress->get<double>(), 0.0, 1.0);
    } catch (const HostError&) {
        return std::nullopt;
    }
}

}  // namespace

std::vector<TaskAttempt> readAttempts(const std::filesystem::path& file) {
    std::vector<TaskAttempt> attempts;
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);) {
        const std::vector<std::string> words = wordsOf(line);
        double time = 0;
        if (words.size() < 4 || !parseNumber(words[1], time)) continue;
        if (words[0] == "start" && words.size() == 4)
            attempts.push_back({words[2], words[3], time, std::nullopt, std::nullopt});
        else if (words[0] == "end")
            addEnd(words, time, attempts);
    }
    return attempts;
}

double readProgress(const std::filesystem::path& log) {
    const std::vector<std::string> lines = lastLines(log);
    for (auto line = lines.rbegin(); line != lines.rend(); ++line) {
        if (!line->starts_with(kProgressLine)) continue;
        if (const auto progress = progressOf(*line, log)) return *progress;
    }
    return 0;
}

std::string lastMessage(const std::filesystem::path& log) {
    const std::vector<std::string> lines = lastLines(log);
    for (auto line = lines.rbegin(); line != lines.rend(); ++line)
        if (!line->empty() && !line->starts_with(kProgressLine)) return *line;
    return {};
}

}  // namespace pm::host
