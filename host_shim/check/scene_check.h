// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <optional>
#include <string>

#include "host_shim/check/scene_display.h"
#include "host_shim/check/suite.h"
#include "host_shim/check/verdict.h"

namespace pm::host {

// What one scene of a suite came to.
struct SceneOutcome {
    enum class Status { kSame, kWithinNoise, kDifferent, kMissing, kFailed, kOutOfTime };
    const SuiteScene* scene{};
    Status status{Status::kOutOfTime};
    std::vector<Finding> findings;
    double seconds{};
    double shareOfLimit{}, seenChange{};
    std::string command;  // that repeats the render
    std::string because;  // of the reference
    std::optional<Picture> stored, picture;
    std::vector<std::string> warnings;  // of the render
    std::vector<std::string> notes;     // what else is to be known of the comparison
    std::string errorWords;             // of the render's own error; empty where it isn't known

    bool isRight() const { return status == Status::kSame || status == Status::kWithinNoise; }
    // Whether only coarse changes of the scene would be found.
    bool isCoarse() const { return seenChange > kCoarseChange; }

    static constexpr double kCoarseChange = 0.1;  // of one region
};

// "regions from 2.4 % on"; empty where that is not known.
std::string seenText(const SceneOutcome& outcome);
// What else is to be told of it, a line each: how coarse its reference is, warnings of the render,
// notes.
std::vector<std::string> remarksOf(const SceneOutcome& outcome);
// What "within noise" rests on: the furthest region as a share of its limit, and seenText().
std::string noiseText(const SceneOutcome& outcome);

const char* nameOf(SceneOutcome::Status status);

// A scene's files beside the suite.
struct ReferenceFiles {
    std::filesystem::path picture, display, numbers;      // NAME.exr, NAME.png, NAME.json
    std::filesystem::path noise;                          // NAME.noise.exr, see pixelNoiseOf
    std::vector<std::filesystem::path> views;             // NAME.VIEW.png, as the scene has them
    std::vector<std::filesystem::path> pictures() const;  // all but the numbers
};
ReferenceFiles referenceFiles(const Suite& suite, const SuiteScene& scene);

// In a folder of pages: a scene's own, and the report of its render.
std::filesystem::path scenePage(const std::filesystem::path& folder, const SuiteScene& scene);
std::filesystem::path reportPage(const std::filesystem::path& folder, const SuiteScene& scene);

// What a render left. png: only where the scene has a display picture.
struct RenderedFiles {
    std::filesystem::path exr, png, statistics, log;
};

// A render against its references.
void checkScene(const Suite& suite, const RenderedFiles& render, SceneOutcome& outcome);

}  // namespace pm::host
