// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Our own renders of a neutral scene at rising numbers of passes.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "tests/bench/run/picture_error.h"
#include "tests/bench/run/plugin_host.h"

namespace pm::bench {

struct LadderRequest {
    std::string integrator = "photon";
    std::string levels = "4";  // of anti-aliasing: N, or MIN:MAX
    int threads = 2;
    bool twice = true;  // two seeds for each step, so that the bias can be told from the noise
    int largestPasses = 256;
    double seconds = 12;  // no render is begun that should take longer on an idle machine
};

// One number of passes: each a whole render from an empty context to pixels. Errors and seconds are
// the means of the two renders.
struct LadderStep {
    int passes = 0;
    double samples = 0;                   // camera samples a pixel, all passes
    double error = 0;                     // relMSE
    std::optional<double> estimated;      // what the library says of itself, without a reference
    std::optional<double> estimatedBias;  // its share of that; trimmed or not, the same
    std::optional<double> common;         // of the two renders: bias, and the reference's own noise
    double mean = 0;                      // over the reference's
    double seconds = 0, processorSeconds = 0;
    std::array<std::vector<double>, 2> pictures;  // the second is empty when not twice
};

// 1, 2, 4, ... passes. Errors: those of PluginHost::render.
std::vector<LadderStep> climb(const PluginHost& host, const NeutralScene& scene,
                              const Yardstick& yardstick, const LadderRequest& request);

// Settings of one render of a ladder.
Settings settingsFor(const LadderRequest& request, int passes, int seed);

}  // namespace pm::bench
