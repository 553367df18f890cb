// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host_shim/cli/options.h"

namespace pm::host {

// What a small render of the same scene tells of the large one.
struct PilotFindings {
    std::vector<double> bucketSeconds;  // thread-seconds a pass of its buckets, in their order
    double pixels{};                    // that it rendered
    double startSeconds{};              // of the process, until its first pass
    double mapSeconds{};                // a pass
    double photonSeconds{};             // of tracing, a pass
    std::string isa;                    // of this machine, or the one that was asked for
    bool hasPhotons{};                  // the render reads photons
    bool measuresExposure{};            // a render with these options would measure its exposure
};

// Renders it as a process of its own, words: options for pm_host that decide on the picture.
// Errors: those of the render, kBadInput where it fails otherwise; Interrupted.
PilotFindings renderFarmPilot(const Options& options, std::vector<std::string> words,
                              std::int32_t bucketSize);

// The error scale that a render with these words finds, stops: of the frame as large as it is,
// since to a pixel it hangs on that; of it one bucket is rendered. Errors: as of renderFarmPilot.
std::int32_t findFarmErrorScale(const Options& options, std::vector<std::string> words);

}  // namespace pm::host
