// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "host_shim/cli/command_line.h"

namespace CLI {
class App;
}

namespace pm::host {

// Options as they were typed; what they mean is found afterwards, by option_values, since CLI11
// reads numbers through the locale.
struct Typed {
    std::string scene, frame, frames, size, eye, lookAt, up, fov, crop, aa, seed, subdivide,
        onlyPixel, errorLimit, progress, checkpoint, photonMap, mtlDialect, twin, textureCache,
        textureCacheSize, exposure, cameraLight, environment, environmentRotation,
        environmentStrength, sun, turbidity, checkSuite, jobs, timeBudget, seeds, engine, runs, job,
        tries, atOnce, bucketTimes, copies, copiesLimit, page, interval;
    std::vector<std::string> onlyScenes, outputs, context, layers, parts, searchPaths, sshLogins,
        slurmOptions;
    std::map<std::string, std::string> settings;  // option -> text
};

// Options that are settings of the library, by another name.
struct SettingOption {
    const char* option;
    const char* setting;
    const char* placeholder;
};
std::span<const SettingOption> settingOptions();

// Puts all options of `pm_host SCENE` into app: texts go to typed, flags and names to options,
// which must outlive it. help: of settings; may be null.
void addAll(CLI::App& app, Typed& typed, Options& options, const SettingHelp& help);
// The same of `pm_host merge PART... -o FILE`.
void addAllOfMerge(CLI::App& app, Typed& typed, Options& options);
// The same of `pm_host cache`.
void addAllOfCache(CLI::App& app, Typed& typed, Options& options);
// The same of `pm_host check SUITE.json`; options.check must be there.
void addAllOfCheck(CLI::App& app, Typed& typed, Options& options);
// The same of `pm_host farm SCENE`, which takes what a render takes; options.farm must be there.
void addAllOfFarm(CLI::App& app, Typed& typed, Options& options, const SettingHelp& help);
// The same of `pm_host watch PART... -o FILE`, which takes what merge takes; options.watch must be
// there.
void addAllOfWatch(CLI::App& app, Typed& typed, Options& options);
// Its own options alone.
void addWatchOptions(CLI::App& app, Typed& typed);
// What pm_host pack has to say of its own; it takes what a render takes.
void addPackOptions(CLI::App& app, Typed& typed);
// Its own options alone.
void addFarmOptions(CLI::App& app, Typed& typed, Options& options);

}  // namespace pm::host
