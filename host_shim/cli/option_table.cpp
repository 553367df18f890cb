// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/cli/option_table.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <string_view>

#include "host_shim/formats/mtl/mtl_dialect.h"
#include "host_shim/pictures/picture_io.h"

namespace pm::host {
namespace {

constexpr std::array<SettingOption, 20> kSettingOptions{{
    {"--threads", "threads", "N"},
    {"--bucket-size", "bucketSize", "N|auto"},
    {"--bucket-order", "bucketOrder", "NAME"},
    {"--buckets", "buckets", "A:B|I/N"},
    {"--aa", "aaLevel", "N|MIN:MAX"},
    {"--aa-threshold", "aaThreshold", "T"},
    {"--filter", "filter", "box|gaussian"},
    {"--integrator", "integrator", "photon|path"},
    {"--plan", "plan", "auto|everything"},
    {"--photons", "photons", "N|auto"},
    {"--estimate-photons", "estimatePhotons", "K"},
    {"--gather-rays", "gatherRays", "N|auto"},
    {"--passes", "passes", "N"},
    {"--time-limit", "timeLimitSeconds", "SECONDS"},
    {"--error-target", "errorTarget", "RELMSE"},
    {"--error-scale", "errorScale", "STOPS|auto"},
    {"--seed", "seed", "N|frame"},
    {"--memory-limit", "memoryLimitGib", "GIB"},
    {"--photon-pages", "photonPagesMib", "MIB"},
    {"--scratch", "scratchFolder", "FOLDER"},
}};

// What is wrong with a value: an empty one, of a script's variable perhaps, is not the same as
// none; and the option that follows is not the value that was forgotten.
std::string valueFault(const std::string& text) {
    constexpr std::array<std::string_view, 4> kShort{"-o", "-q", "-v", "-h"};
    if (text.empty()) return "its value is empty";
    if (text.starts_with("--") || std::ranges::find(kShort, text) != kShort.end())
        return "its value is missing; '" + text + "' is an option";
    return {};
}

void addText(CLI::App& app, const std::string& name, std::string& target,
             const std::string& placeholder, const std::string& help) {
    app.add_option(name, target, help)->type_name(placeholder)->take_last()->check(valueFault);
}

// An option that may be given again, each time with one more value.
CLI::Option* addList(CLI::App& app, const std::string& name, std::vector<std::string>& target,
                     const std::string& placeholder, const std::string& help) {
    return app.add_option(name, target, help)
        ->type_name(placeholder)
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->check(valueFault);
}

void addOutputOptions(CLI::App& app, Typed& typed, Options& options, bool isMerge) {
    const std::string picture = "picture to write, may be repeated: " + usualEndings(false) +
                                " is scene-linear, " + usualEndings(true) +
                                " go through display and view";
    addList(app, "-o,--output", typed.outputs, "FILE",
            picture + (isMerge ? ""
                               : ", .pmpart is a part for pm_host merge (SCENE.exr in the "
                                 "working folder)"));
    addText(app, "--frame", typed.frame, "N",
            std::string("fills #### and %04d in the names of ") + (isMerge ? "PART" : "SCENE") +
                " and outputs, not of folders; an input of that very name wins");
    if (!isMerge)
        addText(app, "--frames", typed.frames, "A-BxS",
                "renders one frame after the other: 1-10, 1-10x2 or 1-5,8");
    app.add_flag("--make-output-path", options.makeOutputPath, "make missing output folders");
    app.add_flag("--exr-half", options.exrHalf, "store colour as half; data stays float");
}

void addUntrusted(CLI::App& app, Options& options) {
    app.add_flag_callback(
        "--untrusted", [&options] { options.reading.files.isTrusted = false; },
        "the scene reads only below its own folder, --search-path and the folder of the colour "
        "config");
}

void addSceneOptions(CLI::App& app, Typed& typed, Options& options) {
    addText(app, "SCENE", typed.scene, "FILE",
            "the scene, an .obj or .pov, or http://, https:// or file:// to the manifest.json of "
            "one that "
            "pm_host pack made");
    addOutputOptions(app, typed, options, false);
    addText(app, "--size", typed.size, "WxH", "pixels, 1 to 65536 each (640x480)");
    addText(app, "--camera", options.cameraName, "NAME",
            "one of the cameras that the sidecar of the scene describes (its first)");
    addText(app, "--eye", typed.eye, "x,y,z", "where the camera stands (framed from the bounds)");
    addText(app, "--look-at", typed.lookAt, "x,y,z", "what it looks at (centre of the bounds)");
    addText(app, "--up", typed.up, "x,y,z", "up in the picture (0,1,0)");
    addText(app, "--fov", typed.fov, "DEG", "vertical field of view, above 0 and below 180 (40)");
    addText(app, "--crop", typed.crop, "x0,y0,x1,y1", "half-open pixels; may exceed the frame");
    app.add_flag("--no-sidecar", options.noSidecar,
                 "leave out SCENE.pm.json, which is read where it stands beside SCENE");
    app.add_flag("--write-sidecar", options.writeSidecar,
                 "write the camera and light that were found for the scene to SCENE.pm.json");
    addText(app, "--subdivide", typed.subdivide, "all|tagged|none",
            "which groups become Catmull-Clark limit surfaces (tagged)");
    addText(app, "--twin", typed.twin, "N",
            "moves vertices by up to 1e-7 of their coordinates, N says which way: what rounds "
            "otherwise, as another build does, differs by as much (none)");
    addText(app, "--mtl-dialect", typed.mtlDialect, "NAME",
            "which program's MTL it is: " + allDialectNames() + " (by the headers of the files)");
    app.add_flag("--bump-is-normal", options.bumpIsNormal,
                 "take the pictures of map_Bump as normal maps, as in Blender's files they are");
    app.add_flag("--alpha-of-pictures", options.alphaOfPictures,
                 "take the alpha of map_Kd's pictures as map_d, where a material has none");
    addList(app, "--search-path", typed.searchPaths, "DIR",
            "where libraries and textures are looked for that are not found beside the scene; may "
            "be repeated");
    addUntrusted(app, options);
    addText(app, "--pov-library", options.reading.pov.library, "DIR",
            "where the include files of POV-Ray are (/usr/share/povray-3.7/include)");
    app.add_flag("--allow-write", options.reading.pov.mayWrite,
                 "let #fopen of a POV-Ray scene write files");
    addText(app, "--camera-light", typed.cameraLight, "auto|on|off",
            "a point light at the camera; auto: where the scene has no light, or where no --eye is "
            "given and its own light reaches nothing that is seen (auto)");
    addText(app, "--environment", typed.environment, "FILE",
            "light from all around by a latitude-longitude picture, .hdr or .exr");
    addText(app, "--sun", typed.sun, "AZIMUTH,ELEVATION",
            "a clear sky with the sun there, degrees: azimuth 0 is -z, or +y where z is up, 90 is "
            "+x");
    addText(app, "--turbidity", typed.turbidity, "T",
            "how hazy the sky of --sun is, 1.7 to 10 (3)");
    addText(app, "--environment-rotation", typed.environmentRotation, "DEG",
            "turns --environment about y, anticlockwise from above; -90 is as Blender has it (0)");
    addText(app, "--environment-strength", typed.environmentStrength, "S",
            "factor of --environment or of --sun with its sky (1)");
    addList(app, "--aov", typed.layers, "NAME[,NAME]",
            "extra channels in the EXR, see --list aovs");
}

void replaceAll(std::string& text, std::string_view from, std::string_view to) {
    for (auto at = text.find(from); at != text.npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
}

// What the library says of its setting, in the words of the command line.
std::string optionHelp(const SettingOption& option, const SettingHelp& help) {
    if (!help) return {};
    std::string text = help(option.setting);
    if (std::string_view(option.option) == "--aa")
        text = "MIN: " + text + " MAX: " + help("aaLevelMost");
    replaceAll(text, "aaLevelMost", "MAX");
    replaceAll(text, "aaLevel", "MIN");
    replaceAll(text, "where the host takes that (see delivery)", "where that can be");
    return text;
}

void addRenderOptions(CLI::App& app, Typed& typed, Options& options, const SettingHelp& help) {
    for (const SettingOption& setting : kSettingOptions) {
        addText(app, setting.option, typed.settings[setting.option], setting.placeholder,
                optionHelp(setting, help));
    }
    addText(app, "--isa", options.isa, "NAME",
            "instruction set, for the same bits on unlike machines: best, sse2, sse4.2, avx, avx2, "
            "avx512 (best)");
    app.add_flag("--strict", options.strict,
                 "exit 3 when a sample of this run was NaN, infinite or negative; the picture is "
                 "written, with "
                 "black in its place");
}

void addPieceOptions(CLI::App& app, Typed& typed, Options& options) {
    addText(app, "--checkpoint", typed.checkpoint, "FILE",
            "keep finished buckets on disk; removed when all is written");
    app.add_flag("--resume", options.resume,
                 "go on from the checkpoint where it is there, else begin");
    app.add_flag("--keep-checkpoint", options.keepCheckpoint,
                 "don't remove it, so that the render can go on with more passes");
    addText(app, "--photon-map", typed.photonMap, "FILE",
            "read the photons from it in place of tracing them, for the same picture");
    app.add_flag("--photons-only", options.photonsOnly,
                 "trace the photons of all passes, write --photon-map FILE and stop; no picture");
}

void addColourOptions(CLI::App& app, Typed& typed, Options& options) {
    ColourOptions& colour = options.colour;
    addText(app, "--ocio", colour.ocioFile, "FILE", "colour config (else $OCIO, else built in)");
    addText(app, "--rendering-space", colour.renderingSpace, "NAME",
            "scene-linear space to render in, see --list spaces (the config's scene_linear)");
    addText(app, "--material-space", colour.materialSpace, "NAME",
            "space of the numbers of materials (linear Rec.709)");
    addText(app, "--texture-space", colour.textureSpace, "NAME",
            "space of colour textures (by their files: float linear Rec.709, integer sRGB)");
    addText(app, "--display", colour.display, "NAME", "see --list views (the config's own)");
    addText(app, "--view", colour.view, "NAME", "see --list views (the display's own)");
    addText(
        app, "--exposure", typed.exposure, "STOPS|auto",
        "of display pictures, from -20 to 20; auto: measured on a small picture of the whole "
        "frame (auto; 0 with --view, --ocio, $OCIO, --crop, --buckets, --frame or --reference)");
    addText(app, "--look", colour.look, "NAME", "look to apply before the view (none)");
    addList(app, "--context", typed.context, "KEY=VALUE",
            "variable of the config, may be repeated");
}

void addTextureOptions(CLI::App& app, Typed& typed) {
    addText(app, "--texture-cache", typed.textureCache, "DIR",
            "where prepared textures are kept ($XDG_CACHE_HOME/pm, else ~/.cache/pm)");
    addText(app, "--texture-cache-size", typed.textureCacheSize, "GIB",
            "the most that they may take there; those not used for long go first (20)");
}

void addCopiesOptions(CLI::App& app, Typed& typed) {
    addText(app, "--copies", typed.copies, "DIR",
            "where copies of scenes that are fetched are kept ($XDG_CACHE_HOME/pm/copies, else "
            "~/.cache/pm/copies)");
    addText(app, "--copies-limit", typed.copiesLimit, "GIB",
            "the most that they may take there; those not used for long go first (20)");
}

void addReportOptions(CLI::App& app, Typed& typed, Options& options) {
    app.add_option("--reference", options.reference,
                   "EXR to report relMSE against, or a display picture, compared in codes of 255")
        ->type_name("FILE")
        ->check(valueFault);
    addText(app, "--error-limit", typed.errorLimit, "X",
            "exit 6 when the relMSE against --reference (of a display picture the rms code "
            "difference) is above, or a value is not finite");
    addText(app, "--stats", options.statistics, "FILE", "statistics as JSON; - = standard output");
    app.add_option("--log", options.log, "all messages, also to a file")
        ->type_name("FILE")
        ->check(valueFault);
    app.add_option("--report", options.report,
                   "a page to look at: status, picture, error, time of the buckets")
        ->type_name("FILE.html")
        ->check(valueFault);
    app.add_flag("-q,--quiet", options.quiet, "only warnings and errors");
    app.add_flag("-v,--verbose", options.verbose, "more messages");
    app.add_option("--plugin", options.plugin,
                   "the library (else $PM_PLUGIN_PATH, else beside pm_host)")
        ->type_name("FILE")
        ->check(valueFault);
    app.add_flag("-h,--help", options.help, "print and stop");
}

void addPrintingOptions(CLI::App& app, Typed& typed, Options& options) {
    app.add_flag("--explain", options.explain, "print what the scene needs, and stop");
    addText(app, "--list", options.list, "views|looks|spaces|aovs|orders|settings|parameters",
            "print and stop");
    app.add_flag("--version", options.version, "print and stop");
    addText(app, "--progress", typed.progress, "auto|bar|plain|json|alf|openjd|none",
            "how progress is shown (auto)");
    app.add_flag("--input-hashes", options.inputHashes,
                 "--stats has a hash of each object, material, light and texture, and of the "
                 "camera");
    addText(app, "--bucket-times", typed.bucketTimes, "FILE.csv",
            "how long each bucket took: its place in the order, its pixels, seconds, passes");
    addText(app, "--only-pixel", typed.onlyPixel, "X,Y", "render and print that one");
}

}  // namespace

std::span<const SettingOption> settingOptions() {
    return kSettingOptions;
}

void addAll(CLI::App& app, Typed& typed, Options& options, const SettingHelp& help) {
    app.set_help_flag();
    app.option_defaults()->always_capture_default(false);
    addSceneOptions(app, typed, options);
    addRenderOptions(app, typed, options, help);
    addPieceOptions(app, typed, options);
    addColourOptions(app, typed, options);
    addTextureOptions(app, typed);
    addCopiesOptions(app, typed);
    addReportOptions(app, typed, options);
    addPrintingOptions(app, typed, options);
}

void addAllOfCache(CLI::App& app, Typed& typed, Options& options) {
    app.set_help_flag();
    app.option_defaults()->always_capture_default(false);
    app.add_flag("--list", options.cacheList, "print the textures, the longest unused first");
    app.add_flag("--clear", options.cacheClear, "remove them, but for those in use");
    app.add_flag("--verify", options.cacheVerify,
                 "read them and their originals whole; remove what is damaged, exit 3 if any was");
    addTextureOptions(app, typed);
    app.add_flag("-h,--help", options.help, "print and stop");
}

void addAllOfCheck(CLI::App& app, Typed& typed, Options& options) {
    CheckOptions& check = *options.check;
    app.set_help_flag();
    app.option_defaults()->always_capture_default(false);
    addText(app, "SUITE", typed.checkSuite, "FILE.json", "the suite: scenes and their options");
    addList(app, "--only", typed.onlyScenes, "NAME[,NAME]",
            "scenes to check, or tag:NAME for all that have a tag; may be repeated (all)")
        ->delimiter(',');
    app.add_option("--failed", check.failed,
                   "scenes alone that were not right in an earlier check, by its --junit")
        ->type_name("FILE.xml")
        ->check(valueFault);
    addText(app, "--jobs", typed.jobs, "N",
            "scenes rendered at once, which share the threads; 1 to 1024 (1)");
    addText(app, "--time-budget", typed.timeBudget, "SECONDS",
            "for all; what isn't done by then counts as different (none)");
    addText(app, "--seed", typed.seed, "N",
            "another seed than the references', for a look at the noise");
    app.add_flag("--update", check.update, "make the references anew; wants --because");
    addText(app, "--because", check.because, "TEXT", "why; kept with the references");
    addText(app, "--seeds", typed.seeds, "N",
            "of --update: other seeds that a scene is rendered with to measure its noise, 4 to 64; "
            "of fewer less is found (16)");
    app.add_option("--junit", check.junit, "the outcome as JUnit's XML")
        ->type_name("FILE")
        ->check(valueFault);
    app.add_option("--html", check.html, "pages to look at: index.html, and one for each scene")
        ->type_name("FOLDER")
        ->check(valueFault);
    app.add_option("--plugin", check.plugin,
                   "the library (else $PM_PLUGIN_PATH, else beside pm_host)")
        ->type_name("FILE")
        ->check(valueFault);
    app.add_flag("-q,--quiet", options.quiet, "only warnings and errors");
    app.add_flag("-h,--help", options.help, "print and stop");
}

void addFarmOptions(CLI::App& app, Typed& typed, Options& options) {
    FarmOptions& farm = *options.farm;
    addText(app, "--engine", typed.engine, "slurm|parallel|commands",
            "what starts the tasks; commands: they are printed, for any other farm manager");
    addText(app, "--job", typed.job, "FOLDER",
            "keeps plan, photons, parts and logs where all machines see it; the same command again "
            "goes on");
    addText(app, "--runs", typed.runs, "N|auto",
            "into how many runs of buckets, of alike predicted cost, a frame is cut, 1 to 10000 "
            "(auto)");
    addText(app, "--tries", typed.tries, "N", "how often a task is started at most, 1 to 100 (3)");
    addList(app, "--sshlogin", typed.sshLogins, "[N/][USER@]HOST",
            "of parallel: a machine, as GNU parallel takes it; may be repeated (this one)");
    addText(app, "--at-once", typed.atOnce, "N",
            "of parallel: tasks at once on a machine, 1 to 1024 (1)");
    app.add_option("--slurm-option", typed.slurmOptions,
                   "of slurm: an option for sbatch, as --slurm-option=--partition=night; may be "
                   "repeated")
        ->type_name("OPTION")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    app.add_flag(
        "--photons-each", farm.photonsEach,
        "each run traces all photons; else they are traced once, and a file of them is read "
        "by all");
    app.add_flag("--dry-run", farm.dryRun, "print what would be done, and do nothing");
}

void addAllOfFarm(CLI::App& app, Typed& typed, Options& options, const SettingHelp& help) {
    addAll(app, typed, options, help);
    addFarmOptions(app, typed, options);
}

void addPackOptions(CLI::App& app, Typed& typed) {
    app.set_help_flag();
    addList(app, "-o,--output", typed.outputs, "FOLDER",
            "gets objects/, the contents by their SHA-256, and manifest.json");
}

void addAllOfMerge(CLI::App& app, Typed& typed, Options& options) {
    app.set_help_flag();
    app.option_defaults()->always_capture_default(false);
    app.add_option("PART", typed.parts, "parts of one picture, that -o NAME.pmpart made")
        ->type_name("FILE...");
    addOutputOptions(app, typed, options, true);
    addColourOptions(app, typed, options);
    addReportOptions(app, typed, options);
}

void addWatchOptions(CLI::App& app, Typed& typed) {
    addText(app, "--job", typed.job, "FOLDER",
            "the folder of a pm_host farm, whose parts are collected, in place of PART");
    addText(app, "--page", typed.page, "FILE.html",
            "a page that shows the picture, how much is there and who made it; it renews itself");
    addText(app, "--interval", typed.interval, "SECONDS",
            "between two looks for parts, 0.05 to 3600 (2)");
}

void addAllOfWatch(CLI::App& app, Typed& typed, Options& options) {
    addAllOfMerge(app, typed, options);
    addWatchOptions(app, typed);
}

}  // namespace pm::host
