// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/pov/animation.h"

#include <algorithm>
#include <charconv>

#include "host_shim/formats/text_lines.h"

namespace pm::host {
namespace {

std::string small(std::string_view text) {
    std::string result;
    for (const char c : text)
        if (c != ' ' && c != '\t' && c != '_')
            result += static_cast<char>(c >= 'A' && c <= 'Z' ? c | 0x20 : c);
    return result;
}

std::optional<double> numberOf(std::string_view text) {
    double value = 0;
    if (text.starts_with('+')) text.remove_prefix(1);
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    return result.ec == std::errc{} ? std::optional<double>(value) : std::nullopt;
}

bool isOn(std::string_view value) {
    const std::string word = small(value);
    return word == "on" || word == "true" || word == "yes" || word == "1";
}

void put(PovIni& ini, const std::string& key, std::string_view value) {
    if (key == "declare") {
        const auto equals = value.find('=');
        if (equals != value.npos)
            ini.declared[std::string(trimmed(value.substr(0, equals)))] =
                trimmed(value.substr(equals + 1));
        return;
    }
    if (key == "cyclicanimation") {
        ini.isCyclic = isOn(value);
        return;
    }
    const auto number = numberOf(value);
    if (!number) return;
    const auto whole = static_cast<std::int64_t>(std::clamp(*number, -2e9, 2e9));
    if (key == "clock" || key == "k") ini.clock = *number;
    if (key == "initialframe" || key == "kfi") ini.firstFrame = whole;
    if (key == "finalframe" || key == "kff") ini.lastFrame = whole;
    if (key == "initialclock" || key == "ki") ini.firstClock = *number;
    if (key == "finalclock" || key == "kf") ini.lastClock = *number;
}

// +kff30 and the like.
void putSwitches(PovIni& ini, std::string_view line) {
    while (!line.empty()) {
        const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
        const std::string word = small(line.substr(0, end));
        line = trimmed(line.substr(end));
        if (!word.starts_with('+')) continue;
        const auto digits = word.find_first_of("0123456789-.", 1);
        if (digits != word.npos) put(ini, word.substr(1, digits - 1), word.substr(digits));
    }
}

}  // namespace

PovIni readPovIni(std::string_view text) {
    PovIni ini;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
        std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        line = trimmed(line.substr(0, std::min(line.find(';'), line.size())));
        const std::size_t equals = line.find('=');
        if (equals == line.npos)
            putSwitches(ini, line);
        else
            put(ini, small(line.substr(0, equals)), trimmed(line.substr(equals + 1)));
    }
    return ini;
}

std::map<std::string, double> clockOf(const PovIni& ini, std::optional<std::int64_t> frame) {
    const std::int64_t at = frame.value_or(ini.firstFrame);
    const double frames =
        static_cast<double>(ini.lastFrame - ini.firstFrame + (ini.isCyclic ? 1 : 0));
    const double step = frames > 0 ? (ini.lastClock - ini.firstClock) / frames : 0;
    double clock = ini.firstClock + step * static_cast<double>(at - ini.firstFrame);
    if (!ini.isAnimation()) clock = ini.clock.value_or(0);
    return {{"clock", clock},
            {"clock_delta", ini.isAnimation() ? step : 0},
            {"clock_on", ini.isAnimation() ? 1 : 0},
            {"frame_number", static_cast<double>(at)},
            {"initial_frame", static_cast<double>(ini.firstFrame)},
            {"final_frame", static_cast<double>(ini.lastFrame)},
            {"initial_clock", ini.firstClock},
            {"final_clock", ini.lastClock}};
}

}  // namespace pm::host
