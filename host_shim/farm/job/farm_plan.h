// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host_shim/cli/options.h"

namespace pm::host {

// What one process on one machine does, and what is there when it is done.
struct FarmTask {
    enum class Kind { kPhotons, kRun };
    Kind kind{Kind::kRun};
    std::size_t frame{};             // of FarmPlan::frames
    std::uint32_t first{}, last{};   // of a run: its buckets, half-open
    double predictedCost{};          // thread-seconds of the pilot, scaled up; of photons 0
    std::filesystem::path product;   // the part or the photon map
    std::vector<std::string> words;  // for pm_host
    // "photons" or "buckets A:B", and of which frame where there are several.
    std::string what(const std::optional<std::int64_t>& frameNumber) const;
};

struct FarmFrame {
    std::optional<std::int64_t> number;
    std::vector<std::string> mergeWords;  // for pm_host, but for the parts
};

// All that a farm does, as it was decided once: a task is known by its number, from 1, its place in
// tasks; first come the photons of all frames.
struct FarmPlan {
    std::vector<GivenOption> given;  // what decides on the picture
    std::filesystem::path program;   // pm_host
    std::filesystem::path folder;    // where names begin
    std::string isa;
    std::uint32_t bucketCount{};  // of a frame
    std::vector<FarmFrame> frames;
    std::vector<FarmTask> tasks;

    const FarmTask& task(int number) const {
        return tasks.at(static_cast<std::size_t>(number) - 1);
    }
    std::string what(int number) const;
    // The number of the task that makes the photons of a frame; 0 where none is needed.
    int photonsOf(std::size_t frame) const;

    // Of toJson(), white space left out.
    static std::string beginning();
    std::string toJson() const;
    // Errors: kBadInput for anything else than toJson() gives; Interrupted. file: for messages.
    static FarmPlan fromJson(std::string_view text, const std::filesystem::path& file);
};

}  // namespace pm::host
