// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "host_shim/formats/scene_data.h"
#include "host_shim/log/log.h"
#include "host_shim/pictures/display_compare.h"
#include "host_shim/pictures/error_words.h"

namespace pm::host {

// Samples that were NaN, infinite or negative, and count as black.
struct BadSampleNote {
    std::string text;       // how many of each kind, and where the first was
    std::int64_t x{}, y{};  // its pixel
};

// What is written as --stats: one JSON object, "schema": "pm-stats/1". Units stand in the key
// names; keys are only ever added.
struct Statistics {
    std::vector<std::string> commandLine;
    std::string scene;
    std::optional<std::int64_t> sameAsFrame;  // whose render it is; the seconds are of that one
    std::vector<MaterialFile> materialFiles;
    std::string pluginFile;
    std::string pluginVersion;
    std::string colourConfig;
    std::string renderingSpace;
    std::optional<double> exposureStops;              // of display pictures, where there are any
    std::map<std::string, std::string> textureFiles;  // prepared one -> the scene's own
    std::vector<std::string> outputs;                 // that were written
    std::map<std::string, double> phaseSeconds;       // readSceneSeconds, ...
    // passes done, error target, time limit, finished (without a render), error limit, interrupted,
    // terminated, failed
    std::string stopReason{"failed"};
    std::string error;
    std::optional<double> referenceRelMse;
    std::int32_t referenceErrorScale{};               // stops, of that
    std::optional<SeenError> seenError;               // of the display picture, where there is one
    std::optional<DisplayDifference> referenceCodes;  // of a display picture
    std::string library;  // the plugin's own statistics, JSON, empty when there was no render
    int exitCode{1};

    // Estimated relMSE of the picture, from the plugin's statistics.
    std::optional<double> estimatedRelMse() const;
    // That it is of, stops; nothing before the plugin has planned.
    std::optional<std::int32_t> errorScaleStops() const;
    // Of what the render doesn't see pixel by pixel.
    struct BiasNote {
        double most{};        // relMSE of bias, with two standard errors of it, and of what was cut
        double offset{};      // of relMSE's denominator, in the picture's own unit
        bool isLowerBound{};  // of the error, for light finer than the estimates' radii
    };
    BiasNote estimatedBias() const;
    // What the error looks like, for people; empty where it isn't known.
    std::string errorWords() const;
    // How far that is to be trusted, for people; empty where there is nothing to say.
    std::string estimateDoubts() const;
    // Why the library's render ended, in its words; "finished" when it doesn't say.
    std::string libraryStopReason() const;
    // Of the processors that rendered, each once.
    std::vector<std::string> processorVendors() const;
    // Of a photon map that was written, for people.
    std::string photonMapText() const;
    // None where there were no bad samples.
    std::optional<BadSampleNote> badSamples() const;
    std::string toJson(const Log& log) const;
};

}  // namespace pm::host
