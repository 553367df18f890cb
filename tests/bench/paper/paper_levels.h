// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The paper's second experiment (section 6, Fig. 10 and 11): ranges of levels x scenes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/bench/paper/paper_scenes.h"
#include "tests/bench/plot/report.h"
#include "tests/bench/run/picture_error.h"
#include "tests/bench/run/pictures.h"
#include "tests/bench/run/plugin_host.h"

namespace pm::bench {

struct LevelRange {
    int least = 0, most = 0;
    std::string name() const;  // "Level-0-3", as the paper has it
};

// What one range gave on one scene: each turn has a seed of its own.
struct LevelRun {
    LevelRange range;
    std::vector<double> seconds, processorSeconds, errors;  // of each turn; errors: relMSE
    double samples = 0;                                     // camera samples a pixel
    Picture picture;                                        // of the first turn
};

struct SceneLevels {
    PaperScene scene;
    Picture reference;
    double referenceNoise = 0;  // relMSE that it has itself, about
    std::vector<LevelRun> runs;
};

struct PaperLevelsOptions {
    int turns = 3;
    int threads = 2;
    int referencePasses = 12;  // of either half, 16 samples a pixel each
};

// Whole renders of 4 passes through the C interface. Ranges from level 0 on are left out where the
// library has no such level. Errors: those of PluginHost.
SceneLevels runPaperLevels(const PluginHost& host, const PaperScene& scene,
                           const PaperLevelsOptions& options);

// A table of each scene. At least one.
void reportPaperLevels(Report& report, const std::vector<SceneLevels>& scenes);

// Whether a range is in Fig. 11: the paper's, or, where there is no level 0, the fixed ones; and
// the library's own.
bool isPictured(const LevelRun& run, const SceneLevels& levels);

// paper_levels.csv, images/paper_levels.svg, images/paper_levels_error.svg and, of Fig. 11,
// images/paper_levels.png, in this folder. Throws Error(kIo).
void writePaperLevels(const std::filesystem::path& folder, const std::vector<SceneLevels>& scenes);

// Every picture of Fig. 11 by itself, SCENE_RANGE.png, and the references. Throws Error(kIo).
void writePaperPictures(const std::filesystem::path& folder,
                        const std::vector<SceneLevels>& scenes);

}  // namespace pm::bench
