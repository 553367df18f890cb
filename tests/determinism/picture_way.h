// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// One picture, made in as many ways as a host may choose: what varies is named by a Way, and what
// comes out is compared bit by bit.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "plugin/include/pm_plugin.h"
#include "tests/determinism/transport_scene.h"

namespace pm::test {

using Settings = std::map<std::string, std::string>;

// A layer's pixels over the window of its picture, row by row, channels side by side.
struct LayerPixels {
    std::string name;
    std::string channels;  // separated by commas
    std::size_t channelCount = 0;
    std::vector<float> values;
};

struct LayeredPicture {
    PmrRectangle window{};
    std::vector<LayerPixels> layers;
};

// What must not change a bit.
struct Way {
    int threads = 1;
    int bucketSize = 32;
    std::string order = "row";
    PmrRectangle window{};  // of the frame, a crop or more than the frame
    bool isCropped = false;
    // The last of its renders is cancelled within the second pass and gone on with by so many
    // threads and with so large buckets; 0 threads: it is not cancelled.
    int resumeThreads = 0;
    int resumeBucketSize = 32;      // not looked at where the picture is in parts: theirs are alike
    bool isInParts = false;         // three of them, or as many as there are buckets
    bool flushesDenormals = false;  // the host does, and rounds towards zero
    std::string locale{};           // of the host; empty: "C"

    std::string text() const;
};

// How far a cancelled render had come, as its checkpoint says.
struct Interruptions {
    int withinAPass = 0, betweenPasses = 0, tooLate = 0;
};

// Renders the scene of transportScene() over the way's window, with all layers. The host's modes
// and locale hold from the making of the scene to the reading of the pixels, and are put back.
// folder: where checkpoints and parts may go for the while. Errors fail the test that calls.
LayeredPicture makePicture(const Way& way, const Settings& settings, const SceneChoice& scene,
                           const std::string& folder, Interruptions& interruptions);

// Empty when all layers of both have the same bits wherever both windows are; otherwise the first
// pixel, layer and channel that differ, the two values and the number of pixels.
std::string difference(const LayeredPicture& picture, const LayeredPicture& expected);

}  // namespace pm::test
