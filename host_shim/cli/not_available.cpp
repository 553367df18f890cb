// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/cli/not_available.h"

#include "host_shim/pictures/host_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace pm::host {
namespace {

constexpr std::array<std::string_view, 9> kLaterOptions{
    "--buckets", "--aa-threshold", "--filter",       "--photon-map", "--checkpoint",
    "--resume",  "--report",       "--photons-only", "--denoise"};

}  // namespace

void refuseWhatIsNotAvailableYet(const std::vector<std::string>& arguments) {
    if (!arguments.empty() && arguments.front() == "merge") {
        throw HostError(ExitCode::kUsage, "merge: not available yet");
    }
    for (const std::string& argument : arguments) {
        const std::string_view name = std::string_view(argument).substr(0, argument.find('='));
        if (std::ranges::find(kLaterOptions, name) != kLaterOptions.end()) {
            throw HostError(ExitCode::kUsage, fmt::format("{}: not available yet", name));
        }
    }
}

void refuseValueNotAvailableYet(const std::string& option, const std::string& value,
                                const std::vector<std::string>& laterValues) {
    if (std::ranges::find(laterValues, value) == laterValues.end()) return;
    throw HostError(ExitCode::kUsage, fmt::format("{} {}: not available yet", option, value));
}

}  // namespace pm::host
