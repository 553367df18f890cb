// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/cli/not_available.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

constexpr std::array<std::string_view, 1> kLaterOptions{"--denoise"};

}  // namespace

void refuseWhatIsNotAvailableYet(const std::vector<std::string>& arguments) {
    for (const std::string& argument : arguments) {
        const std::string_view name = std::string_view(argument).substr(0, argument.find('='));
        if (std::ranges::find(kLaterOptions, name) != kLaterOptions.end()) {
            throw HostError(ExitCode::kUsage, fmt::format("{}: not available yet", name));
        }
    }
}

}  // namespace pm::host
