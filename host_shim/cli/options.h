// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host_shim/colour/colour_pipeline.h"
#include "host_shim/formats/scene_reader.h"
#include "host_shim/look/framing.h"
#include "host_shim/pictures/picture.h"

namespace pm::host {

enum class Subdivide { kAll, kTagged, kNone };
// --exposure, and whether its default may be measured: not where several pictures are to match.
struct ExposureOption {
    enum class Kind { kNotGiven, kStops, kAuto };
    Kind kind{Kind::kNotGiven};
    double stops{};
    bool mayBeMeasured{};
};
enum class CameraLight { kAuto, kOn, kOff };
enum class ProgressStyle { kAuto, kBar, kPlain, kJson, kAlf, kOpenJd, kNone };

// A setting of the library that the command line gave a value to.
struct GivenSetting {
    std::string option;  // as it was typed, for messages
    std::string name;    // of the library
    std::string value;
};

// pm_host check SUITE.json.
struct CheckOptions {
    std::filesystem::path suite;
    bool update{};                  // references are made anew
    std::string because;            // why; not empty then
    int seeds{16};                  // others that a reference is measured by
    std::vector<std::string> only;  // names of scenes, or tag:NAME; empty: all
    std::filesystem::path failed;   // of an earlier --junit: what was not right there; empty: none
    int jobs{1};                    // renders at once
    std::optional<double> timeBudgetSeconds;
    std::optional<std::uint64_t> seed;  // in place of the references' own
    std::filesystem::path junit, html;  // empty: none
    std::filesystem::path plugin;
};

// An option as it was typed: its longest name ("SCENE" of the scene), and its values, none of a
// flag.
struct GivenOption {
    std::string name;
    std::vector<std::string> values;
};

// pm_host farm SCENE [options].
struct FarmOptions {
    std::string engine;                     // slurm, parallel or commands
    int runs{0};                            // of each frame; 0 = by predicted cost
    std::filesystem::path job;              // the folder that keeps what is done
    bool photonsEach{};                     // each run traces its photons
    bool dryRun{};                          // prints what would be done
    int tries{3};                           // of a task
    int atOnce{1};                          // of parallel: tasks on a machine
    std::vector<std::string> sshLogins;     // of parallel
    std::vector<std::string> slurmOptions;  // of slurm, for sbatch
    std::vector<GivenOption> given;         // all that was typed
};

// pm_host watch PART... or --job FOLDER.
struct WatchOptions {
    std::filesystem::path job;  // of pm_host farm; empty: Options::merge names the parts
    std::optional<std::int64_t> frame;
    std::filesystem::path page;  // empty: none
    double intervalSeconds{2};
};

// A light that is infinitely far, in place of what the scene has.
struct SkyOptions {
    std::filesystem::path environment;         // a picture; empty: none
    std::optional<std::array<double, 2>> sun;  // azimuth, elevation; degrees
    std::optional<double> rotation, strength, turbidity;
};

// What the command line says, checked as far as it can be without files.
struct Options {
    std::vector<std::string> commandLine;
    std::filesystem::path scene;
    std::vector<std::filesystem::path> outputs;
    std::int32_t width{640};
    std::int32_t height{480};
    CameraOptions camera;
    std::string cameraName;  // of those that the scene describes; empty: its first
    std::optional<PixelRect> crop;
    std::vector<GivenSetting> settings;
    std::string isa;
    std::uint32_t threads{0};  // 0 = all allowed
    Subdivide subdivide{Subdivide::kTagged};
    ReadRules reading;
    bool noSidecar{};        // SCENE.pm.json is not read
    bool bumpIsNormal{};     // bump maps are normal maps, where a material has no other
    bool alphaOfPictures{};  // of map_Kd counts as map_d, where a material has none
    bool writeSidecar{};     // and is written
    std::uint32_t twin{};    // 0: the scene as it is; else see makeTwin
    std::string layers;      // separated by commas
    ColourOptions colour;
    ExposureOption exposure;
    CameraLight cameraLight{CameraLight::kAuto};
    SkyOptions sky;
    std::filesystem::path reference;
    std::optional<double> errorLimit;
    std::string statistics;  // file, "-" = standard output, empty = none
    bool inputHashes{};      // statistics have them
    std::filesystem::path log;
    std::filesystem::path report;       // a page, empty = none
    std::filesystem::path bucketTimes;  // how long each bucket took, empty = none
    bool strict{};                      // bad samples are an error
    bool explain{};
    std::string list;  // empty, views, looks, spaces, aovs, orders, settings or parameters
    bool version{};
    bool help{};
    bool helpOfMerge{};
    ProgressStyle progress{ProgressStyle::kAuto};
    bool quiet{};
    bool verbose{};
    std::optional<std::array<std::int32_t, 2>> onlyPixel;
    std::filesystem::path plugin;
    bool makeOutputPath{};
    bool exrHalf{};
    std::filesystem::path part;        // of the outputs the one that ends in .pmpart
    std::filesystem::path checkpoint;  // empty: none
    std::filesystem::path photonMap;   // empty: none
    bool photonsOnly{};                // it is written, and no picture
    bool resume{};
    bool keepCheckpoint{};
    std::filesystem::path textureCache;             // empty: the user's own
    std::optional<double> textureCacheGib;          // the most that it may hold
    bool cacheList{}, cacheClear{}, cacheVerify{};  // pm_host cache
    bool helpOfCache{};
    std::optional<CheckOptions> check;
    bool helpOfCheck{};
    std::filesystem::path copies;     // of scenes that are fetched; empty: the user's own
    std::optional<double> copiesGib;  // the most that they may take
    bool pack{};                      // pm_host pack: the one output is a folder
    bool helpOfPack{};
    std::vector<std::int64_t> frames;  // --frames, of which this is the first; empty: none
    std::optional<FarmOptions> farm;
    bool helpOfFarm{};
    std::optional<WatchOptions> watch;
    bool helpOfWatch{};
    std::vector<std::filesystem::path> merge;  // parts to put together, instead of a scene
};

}  // namespace pm::host
