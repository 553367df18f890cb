// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/cli/command_line.h"

#include "host_shim/cli/not_available.h"
#include "host_shim/cli/option_values.h"
#include "host_shim/cli/piece_options.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <ranges>

namespace pm::host {
namespace {

// Options as they were typed; what they mean is found afterwards, by option_values, since CLI11
// reads numbers through the locale.
struct Typed {
    std::string scene, frame, size, eye, lookAt, up, fov, crop, aa, seed, subdivide, onlyPixel,
        errorLimit, progress, checkpoint, photonMap;
    std::vector<std::string> outputs, context, layers, parts;
    std::map<std::string, std::string> settings;  // option -> text
};

// Options that are settings of the library, by another name.
struct SettingOption {
    const char* option;
    const char* setting;
    const char* placeholder;
};
constexpr std::array<SettingOption, 17> kSettingOptions{{
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
    {"--seed", "seed", "N|frame"},
    {"--memory-limit", "memoryLimitGib", "GIB"},
}};

void addText(CLI::App& app, const std::string& name, std::string& target,
             const std::string& placeholder, const std::string& help) {
    app.add_option(name, target, help)->type_name(placeholder)->take_last();
}

void addOutputOptions(CLI::App& app, Typed& typed, Options& options) {
    app.add_option("-o,--output", typed.outputs,
                   "picture to write, may be repeated: .exr is scene-linear, .png .jpg .tif go "
                   "through display and view, .pmpart is a part for pm_host merge (SCENE.exr in "
                   "the working folder)")
        ->type_name("FILE")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    addText(app, "--frame", typed.frame, "N", "fills #### and %04d in SCENE and outputs");
    app.add_flag("--make-output-path", options.makeOutputPath, "make missing output folders");
    app.add_flag("--exr-half", options.exrHalf, "store colour as half; data stays float");
}

void addSceneOptions(CLI::App& app, Typed& typed, Options& options) {
    addText(app, "SCENE", typed.scene, "FILE", "the scene, an .obj");
    addOutputOptions(app, typed, options);
    addText(app, "--size", typed.size, "WxH", "pixels (640x480)");
    addText(app, "--eye", typed.eye, "x,y,z", "where the camera stands (framed from the bounds)");
    addText(app, "--look-at", typed.lookAt, "x,y,z", "what it looks at (centre of the bounds)");
    addText(app, "--up", typed.up, "x,y,z", "up in the picture (0,1,0)");
    addText(app, "--fov", typed.fov, "DEG", "vertical field of view, above 0 and below 180 (40)");
    addText(app, "--crop", typed.crop, "x0,y0,x1,y1", "half-open pixels; may exceed the frame");
    addText(app, "--subdivide", typed.subdivide, "all|tagged|none",
            "which groups become Catmull-Clark limit surfaces (tagged)");
    app.add_option("--aov", typed.layers, "extra channels in the EXR, see --list aovs")
        ->type_name("NAME[,NAME]")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void addRenderOptions(CLI::App& app, Typed& typed, Options& options, const SettingHelp& help) {
    for (const SettingOption& setting : kSettingOptions) {
        addText(app, setting.option, typed.settings[setting.option], setting.placeholder,
                help ? help(setting.setting) : "");
    }
    addText(app, "--isa", options.isa, "NAME",
            "instruction set, for the same bits on unlike machines: best, sse2, sse4.2, avx, avx2, "
            "avx512 (best)");
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
    addText(app, "--rendering-space", colour.renderingSpace, "NAME", "(the config's scene_linear)");
    addText(app, "--material-space", colour.materialSpace, "NAME",
            "space of the numbers of materials (linear Rec.709)");
    addText(app, "--texture-space", colour.textureSpace, "NAME", "space of colour textures");
    addText(app, "--display", colour.display, "NAME", "see --list views (the config's own)");
    addText(app, "--view", colour.view, "NAME", "see --list views (the display's own)");
    addText(app, "--look", colour.look, "NAME", "look to apply before the view");
    app.add_option("--context", typed.context, "variable of the config, may be repeated")
        ->type_name("KEY=VALUE")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void addReportOptions(CLI::App& app, Typed& typed, Options& options) {
    app.add_option("--reference", options.reference, "EXR to report relMSE against")
        ->type_name("FILE");
    addText(app, "--error-limit", typed.errorLimit, "X",
            "exit 6 when the relMSE against --reference is above, or a value is not finite");
    addText(app, "--stats", options.statistics, "FILE", "statistics as JSON; - = standard output");
    app.add_option("--log", options.log, "all messages, also to a file")->type_name("FILE");
    app.add_option("--report", options.report,
                   "a page to look at: status, picture, error, time of the buckets")
        ->type_name("FILE.html");
    app.add_flag("-q,--quiet", options.quiet, "only warnings and errors");
    app.add_flag("-v,--verbose", options.verbose, "more messages");
    app.add_option("--plugin", options.plugin,
                   "the library (else $PM_PLUGIN_PATH, else beside pm_host)")
        ->type_name("FILE");
    app.add_flag("-h,--help", options.help, "print and stop");
}

void addPrintingOptions(CLI::App& app, Typed& typed, Options& options) {
    app.add_flag("--explain", options.explain, "print what the scene needs, and stop");
    addText(app, "--list", options.list, "views|spaces|aovs|orders|settings", "print and stop");
    app.add_flag("--version", options.version, "print and stop");
    addText(app, "--progress", typed.progress, "auto|bar|plain|json|alf|none",
            "how progress is shown (auto)");
    addText(app, "--only-pixel", typed.onlyPixel, "X,Y", "render and print that one");
}

void addAll(CLI::App& app, Typed& typed, Options& options, const SettingHelp& help) {
    app.set_help_flag();
    app.option_defaults()->always_capture_default(false);
    addSceneOptions(app, typed, options);
    addRenderOptions(app, typed, options, help);
    addPieceOptions(app, typed, options);
    addColourOptions(app, typed, options);
    addReportOptions(app, typed, options);
    addPrintingOptions(app, typed, options);
}

// pm_host merge PART... -o FILE
void addAllOfMerge(CLI::App& app, Typed& typed, Options& options) {
    app.set_help_flag();
    app.option_defaults()->always_capture_default(false);
    app.add_option("PART", typed.parts, "parts of one picture, that -o NAME.pmpart made")
        ->type_name("FILE...");
    addOutputOptions(app, typed, options);
    addColourOptions(app, typed, options);
    addReportOptions(app, typed, options);
}

template <typename Value>
Value chosen(const std::string& option, const std::string& text, Value standard,
             const std::vector<std::pair<std::string, Value>>& choices) {
    if (text.empty()) return standard;
    std::string allowed;
    for (const auto& [name, value] : choices) {
        if (name == text) return value;
        allowed += (allowed.empty() ? "" : ", ") + name;
    }
    throw HostError(ExitCode::kUsage,
                    fmt::format("{} '{}': allowed are {}", option, text, allowed));
}

void readCamera(const Typed& typed, Options& options) {
    if (!typed.size.empty()) {
        const auto size = sizeValue("--size", typed.size);
        options.width = size[0];
        options.height = size[1];
    }
    CameraOptions& camera = options.camera;
    if (!typed.eye.empty()) camera.eye = pointValue("--eye", typed.eye);
    if (!typed.lookAt.empty()) camera.lookAt = pointValue("--look-at", typed.lookAt);
    if (!typed.up.empty()) camera.up = pointValue("--up", typed.up);
    if (camera.up && *camera.up == std::array<double, 3>{}) {
        throw HostError(ExitCode::kUsage, "--up 0,0,0 has no direction");
    }
    if (!typed.fov.empty()) {
        camera.verticalFovDegrees = numberValue("--fov", typed.fov, 1e-6, 179.999999);
    }
    if (!typed.onlyPixel.empty()) options.onlyPixel = pixelValue("--only-pixel", typed.onlyPixel);
    if (!typed.crop.empty()) options.crop = cropValue("--crop", typed.crop);
}

// N is N:N, a level for all pixels.
void readAntiAliasing(const std::string& text, Options& options) {
    const auto colon = text.find(':');
    const auto least = integerValue("--aa", text.substr(0, colon), 0, 6);
    const auto most =
        colon == std::string::npos ? least : integerValue("--aa", text.substr(colon + 1), 0, 6);
    if (least > most) {
        throw HostError(ExitCode::kUsage, fmt::format("--aa '{}': MIN is above MAX", text));
    }
    options.settings.push_back({"--aa", "aaLevel", std::to_string(least)});
    options.settings.push_back({"--aa", "aaLevelMost", std::to_string(most)});
}

std::string settingValue(const std::string& option, const std::string& text,
                         std::optional<std::int64_t> frame) {
    const bool canBeAuto =
        option == "--photons" || option == "--gather-rays" || option == "--bucket-size";
    if (canBeAuto && text == "auto") return "0";
    if (option == "--seed" && text == "frame") {
        if (!frame) throw HostError(ExitCode::kUsage, "--seed frame needs --frame N");
        return std::to_string(*frame);
    }
    return text;
}

void readSettings(const Typed& typed, std::optional<std::int64_t> frame, Options& options) {
    for (const SettingOption& setting : kSettingOptions) {
        const std::string& text = typed.settings.at(setting.option);
        if (text.empty()) continue;
        if (std::string_view(setting.option) == "--aa") {
            readAntiAliasing(text, options);
            continue;
        }
        options.settings.push_back(
            {setting.option, setting.setting, settingValue(setting.option, text, frame)});
        if (std::string_view(setting.setting) == "threads") {
            options.threads =
                static_cast<std::uint32_t>(integerValue(setting.option, text, 0, 1024));
        }
    }
}

void readFiles(const Typed& typed, std::optional<std::int64_t> frame, Options& options) {
    options.scene = withFrame("SCENE", typed.scene, frame);
    for (const std::string& output : typed.outputs) {
        if (output.empty()) throw HostError(ExitCode::kUsage, "-o '': a file name is wanted");
        options.outputs.emplace_back(withFrame("-o", output, frame));
    }
    options.statistics = withFrame("--stats", options.statistics, frame);
    options.log = withFrame("--log", options.log.string(), frame);
    options.report = withFrame("--report", options.report.string(), frame);
    const auto pageType = options.report.extension();
    if (!options.report.empty() && pageType != ".html" && pageType != ".htm") {
        throw HostError(ExitCode::kUsage,
                        fmt::format("--report '{}': its name must end in .html or .htm",
                                    options.report.string()));
    }
    for (const std::string& part : typed.parts) {
        options.merge.emplace_back(withFrame("PART", part, frame));
    }
}

void addDefaultOutput(Options& options) {
    if (options.outputs.empty() && !options.onlyPixel && !options.photonsOnly &&
        !options.scene.empty()) {
        options.outputs.push_back(options.scene.stem().string() + ".exr");
    }
}

void readChoices(const Typed& typed, Options& options) {
    options.subdivide = chosen<Subdivide>(
        "--subdivide", typed.subdivide, Subdivide::kTagged,
        {{"all", Subdivide::kAll}, {"tagged", Subdivide::kTagged}, {"none", Subdivide::kNone}});
    options.progress = chosen<ProgressStyle>("--progress", typed.progress, ProgressStyle::kAuto,
                                             {{"auto", ProgressStyle::kAuto},
                                              {"bar", ProgressStyle::kBar},
                                              {"plain", ProgressStyle::kPlain},
                                              {"json", ProgressStyle::kJson},
                                              {"alf", ProgressStyle::kAlf},
                                              {"none", ProgressStyle::kNone}});
    chosen<int>("--list", options.list, 0,
                {{"views", 0}, {"spaces", 0}, {"aovs", 0}, {"orders", 0}, {"settings", 0}});
    for (const std::string& layers : typed.layers) {
        options.layers += (options.layers.empty() ? "" : ",") + layers;
    }
    for (const std::string& variable : typed.context) {
        options.colour.context.push_back(parseContextVariable(variable));
    }
    if (!typed.errorLimit.empty()) {
        options.errorLimit =
            numberValue("--error-limit", typed.errorLimit, 0, std::numeric_limits<double>::max());
        if (options.reference.empty()) {
            throw HostError(ExitCode::kUsage, "--error-limit needs --reference FILE");
        }
    }
}

std::string oneLine(std::string text) {
    std::ranges::replace(text, '\n', ' ');
    return text;
}

}  // namespace

Options parseCommandLine(const std::vector<std::string>& arguments) {
    refuseWhatIsNotAvailableYet(arguments);
    const bool isMerge = !arguments.empty() && arguments.front() == "merge";
    Options options;
    Typed typed;
    CLI::App app("", "pm_host");
    if (isMerge)
        addAllOfMerge(app, typed, options);
    else
        addAll(app, typed, options, nullptr);
    try {
        // CLI11 takes them from the end.
        app.parse(
            std::vector<std::string>(arguments.rbegin(), arguments.rend() - (isMerge ? 1 : 0)));
    } catch (const CLI::ParseError& error) {
        throw HostError(ExitCode::kUsage, oneLine(error.what()) + " (see pm_host -h)");
    }
    if (options.help || options.version) return options;
    std::optional<std::int64_t> frame;
    if (!typed.frame.empty()) {
        frame = integerValue("--frame", typed.frame, 0, std::numeric_limits<std::int32_t>::max());
    }
    readFiles(typed, frame, options);
    readChoices(typed, options);
    if (isMerge) {
        checkMerge(options);
        return options;
    }
    readCamera(typed, options);
    readSettings(typed, frame, options);
    readPhotonMap(typed.photonMap, typed.settings, frame, options);
    addDefaultOutput(options);
    readPieces(typed.checkpoint, frame, options);
    checkBuckets(typed.settings, options);
    if (options.scene.empty() && options.list.empty()) {
        throw HostError(ExitCode::kUsage,
                        "no SCENE given; usage: pm_host SCENE [options], see "
                        "pm_host -h");
    }
    return options;
}

std::string helpText(const SettingHelp& settingHelp) {
    Options options;
    Typed typed;
    CLI::App app("pm: a photon-mapping bucket renderer", "pm_host");
    addAll(app, typed, options, settingHelp);
    Typed mergeTyped;
    CLI::App merge("pm_host merge: puts parts of one picture together", "pm_host merge");
    addAllOfMerge(merge, mergeTyped, options);
    return app.help() + "\n" + merge.help();
}

}  // namespace pm::host
