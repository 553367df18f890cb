// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Other renderers on the neutral scenes. Each is a program of its own that may not be there.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/bench/run/neutral_scene.h"

namespace pm::bench {

struct PeerPicture {
    std::string budget;  // "64 samples", "quality 2"
    double seconds = 0, processorSeconds = 0;
    std::filesystem::path file;  // linear EXR
};

struct PeerRequest {
    std::filesystem::path scenesFile;  // scenes.json
    std::filesystem::path folder;      // for pictures, scene files and logs
    int threads = 2;
    double seconds = 30;  // no render is begun that should take longer on an idle machine
};

// Pictures at rising budgets; none when the program is not installed (findProgram says so). Throw
// Error(kInternal), with the last line of what the program said, when it fails.

// Blender's Cycles, path tracing with next-event estimation. Seconds are those of the render call.
std::vector<PeerPicture> renderWithCycles(const NeutralScene& scene, const PeerRequest& request);

// POV-Ray 3.7 with radiosity and, where there are spheres, photons. Seconds are the whole
// program's.
std::vector<PeerPicture> renderWithPovray(const NeutralScene& scene, const PeerRequest& request);

}  // namespace pm::bench
