// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host_shim/cli/options.h"

namespace pm::host {

// Of the options of `pm_host farm` those that each kind of its processes gets, as words for
// pm_host. frame: of options, given by --frame or --frames.

// The scene and all that decides on pixels, for the small render, photons and runs.
std::vector<std::string> renderWords(const Options& options, std::optional<std::int64_t> frame);
// The same without layers, which a render of photons alone has none of.
std::vector<std::string> photonWords(const Options& options, std::optional<std::int64_t> frame);
// For merge: outputs, colour and what is reported of the picture; without the parts.
std::vector<std::string> mergeWords(const Options& options);

// What decides on the plan of a job, for saying whether a command line is of this job.
std::vector<GivenOption> planOptions(const FarmOptions& farm);

// The value that was typed last; nullptr where none was.
const std::string* givenValue(const FarmOptions& farm, const std::string& name);

}  // namespace pm::host
