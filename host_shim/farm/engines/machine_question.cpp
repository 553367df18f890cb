// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/farm/engines/machine_question.h"

#include <sstream>
#include <string_view>

namespace pm::host {
namespace {

constexpr std::string_view kMark = "pm-machine ";

}  // namespace

const std::string& machineQuestion() {
    static const std::string question =
        std::string("echo \"") + std::string(kMark) +
        "${SLURMD_NODENAME:-$(uname -n)} $(grep -m 1 ^flags /proc/cpuinfo | cut -d : -f 2)\"";
    return question;
}

std::vector<FarmMachine> machineAnswers(const std::string& lines) {
    std::vector<FarmMachine> machines;
    std::istringstream stream(lines);
    for (std::string line; std::getline(stream, line);) {
        if (!line.starts_with(kMark)) continue;
        line.erase(0, kMark.size());
        const std::size_t end = line.find(' ');
        machines.push_back(
            {line.substr(0, end), end == std::string::npos ? "" : line.substr(end + 1)});
    }
    return machines;
}

}  // namespace pm::host
