// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/cli/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>
#include <optional>
#include <ranges>

#include "host_shim/cli/check_options.h"
#include "host_shim/cli/copies_options.h"
#include "host_shim/cli/farm_options.h"
#include "host_shim/cli/option_table.h"
#include "host_shim/cli/option_values.h"
#include "host_shim/cli/piece_options.h"
#include "host_shim/cli/unknown_words.h"
#include "host_shim/cli/verbs.h"
#include "host_shim/cli/watch_options.h"
#include "host_shim/colour/exposure.h"
#include "host_shim/formats/mtl/mtl_dialect.h"
#include "host_shim/formats/scene_url.h"
#include "host_shim/formats/text_lines.h"
#include "host_shim/pictures/picture_io.h"

namespace pm::host {
namespace {

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

// Beyond the frame there is nothing to look at, unless a crop asks for it.
void checkOnlyPixel(const Options& options) {
    if (!options.onlyPixel) return;
    const auto [x, y] = *options.onlyPixel;
    const auto isIn = [x = x, y = y](const PixelRect& r) {
        return x >= r.x0 && x < r.x1 && y >= r.y0 && y < r.y1;
    };
    if (isIn({0, 0, options.width, options.height}) || (options.crop && isIn(*options.crop)))
        return;
    throw HostError(
        ExitCode::kUsage,
        fmt::format(
            "--only-pixel '{},{}': is outside the picture; X from 0 to {} and Y from 0 to {} "
            "are wanted, or a --crop that holds it",
            x, y, options.width - 1, options.height - 1));
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
    checkOnlyPixel(options);
}

void readSky(const Typed& typed, SkyOptions& sky) {
    constexpr double kMostStrength = 1e6;
    sky.environment = typed.environment;
    if (!typed.sun.empty()) sky.sun = sunValue("--sun", typed.sun);
    if (sky.sun && !sky.environment.empty())
        throw HostError(ExitCode::kUsage,
                        "--sun makes a sky of its own; it is that or --environment");
    const auto read = [](const char* option, const std::string& text, double low, double high,
                         bool isFor, const char* what, std::optional<double>& value) {
        if (text.empty()) return;
        if (!isFor) throw HostError(ExitCode::kUsage, fmt::format("{} needs {}", option, what));
        value = numberValue(option, text, low, high);
    };
    const bool hasPicture = !sky.environment.empty(), hasSun = sky.sun.has_value();
    read("--turbidity", typed.turbidity, 1.7, 10, hasSun, "--sun", sky.turbidity);
    read("--environment-rotation", typed.environmentRotation, -360, 360, hasPicture,
         "--environment", sky.rotation);
    read("--environment-strength", typed.environmentStrength, 0, kMostStrength,
         hasPicture || hasSun, "--environment or --sun", sky.strength);
}

// N is N:N, a level for all pixels.
void readAntiAliasing(const std::string& text, Options& options) {
    const auto colon = text.find(':');
    const auto refuse = [&text](const char* what) {
        throw HostError(ExitCode::kUsage,
                        fmt::format("--aa '{}': {}N or MIN:MAX with 0 <= MIN <= MAX <= 6 is wanted",
                                    text, what));
    };
    const auto level = [&](const std::string& part) {
        std::int64_t value = 0;
        if (!parseInteger(part, value) || value < 0 || value > 6) refuse("");
        return value;
    };
    const auto least = level(text.substr(0, colon));
    const auto most = colon == std::string::npos ? least : level(text.substr(colon + 1));
    if (least > most) refuse("MIN is above MAX; ");
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
    for (const SettingOption& setting : settingOptions()) {
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

void readFiles(const Typed& typed, const FrameNumber& frame, Options& options) {
    options.scene = withFrameOfInput("SCENE", typed.scene, frame);
    for (const std::string& output : typed.outputs) {
        if (output.empty()) throw HostError(ExitCode::kUsage, "-o '': a file name is wanted");
        // A pack is a folder.
        options.outputs.emplace_back(options.pack ? output : withFrame("-o", output, frame));
    }
    options.statistics = withFrame("--stats", options.statistics, frame);
    options.log = withFrame("--log", options.log.string(), frame);
    options.report = withFrame("--report", options.report.string(), frame);
    options.bucketTimes = withFrame("--bucket-times", typed.bucketTimes, frame);
    const std::string pageType = lowerCaseExtension(options.report);
    if (!options.report.empty() && pageType != ".html" && pageType != ".htm") {
        throw HostError(ExitCode::kUsage,
                        fmt::format("--report '{}': its name must end in .html or .htm",
                                    options.report.string()));
    }
    // That need not be there yet.
    const auto isFolder = [&](const std::string& part) {
        return options.watch &&
               !std::filesystem::path(part).filename().string().ends_with(".pmpart");
    };
    for (const std::string& part : typed.parts) {
        options.merge.emplace_back(isFolder(part) ? part : withFrameOfInput("PART", part, frame));
    }
}

ExposureOption exposureValue(const Typed& typed) {
    ExposureOption exposure;
    exposure.kind = typed.exposure.empty()     ? ExposureOption::Kind::kNotGiven
                    : typed.exposure == "auto" ? ExposureOption::Kind::kAuto
                                               : ExposureOption::Kind::kStops;
    if (exposure.kind == ExposureOption::Kind::kStops)
        exposure.stops = numberValue("--exposure", typed.exposure, -kMostExposureStops,
                                     kMostExposureStops, " or auto");
    const auto buckets = typed.settings.find("--buckets");
    exposure.mayBeMeasured = typed.frame.empty() && typed.crop.empty() &&
                             (buckets == typed.settings.end() || buckets->second.empty());
    return exposure;
}

void addDefaultOutput(Options& options) {
    if (options.outputs.empty() && !options.onlyPixel && !options.photonsOnly &&
        !options.scene.empty()) {
        const std::string scene = options.scene.string();
        options.outputs.push_back(
            (isSceneUrl(scene) ? nameOfSceneUrl(scene) : options.scene.stem().string()) + ".exr");
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
                                              {"openjd", ProgressStyle::kOpenJd},
                                              {"none", ProgressStyle::kNone}});
    chosen<int>("--list", options.list, 0,
                {{"views", 0},
                 {"looks", 0},
                 {"spaces", 0},
                 {"aovs", 0},
                 {"orders", 0},
                 {"settings", 0},
                 {"parameters", 0}});
    readSky(typed, options.sky);
    options.cameraLight = chosen<CameraLight>(
        "--camera-light", typed.cameraLight, CameraLight::kAuto,
        {{"auto", CameraLight::kAuto}, {"on", CameraLight::kOn}, {"off", CameraLight::kOff}});
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

void readReadRules(const Typed& typed, Options& options) {
    ReadRules& rules = options.reading;
    if (!typed.twin.empty())
        options.twin = static_cast<std::uint32_t>(integerValue("--twin", typed.twin, 1, 1000000));
    if (options.inputHashes) options.settings.push_back({"--input-hashes", "inputHashes", "1"});
    if (!typed.mtlDialect.empty()) {
        const auto dialect = dialectByName(typed.mtlDialect);
        if (!dialect)
            throw HostError(ExitCode::kUsage, fmt::format("--mtl-dialect '{}': allowed are {}",
                                                          typed.mtlDialect, allDialectNames()));
        rules.mtlDialect = nameOf(*dialect).name;
    }
    for (const std::string& folder : typed.searchPaths)
        rules.files.searchPaths.emplace_back(folder);
}

void readTextureCache(const Typed& typed, Options& options) {
    constexpr double kMostGib = 1 << 20;
    options.textureCache = typed.textureCache;
    if (!typed.textureCacheSize.empty())
        options.textureCacheGib =
            numberValue("--texture-cache-size", typed.textureCacheSize, 0, kMostGib);
}

std::string oneLine(std::string text) {
    std::ranges::replace(text, '\n', ' ');
    return text;
}

[[noreturn]] void refuseWords(const std::string& about) {
    throw HostError(ExitCode::kUsage, about + " (see pm_host -h)");
}

// Which words belong to which option; what they mean is read from typed.
void readWords(const std::vector<std::string>& arguments, Command command, Typed& typed,
               Options& options) {
    CLI::App app("", "pm_host");
    if (command == Command::kMerge)
        addAllOfMerge(app, typed, options);
    else if (command == Command::kWatch)
        addAllOfWatch(app, typed, options);
    else if (command == Command::kCache)
        addAllOfCache(app, typed, options);
    else if (command == Command::kCheck)
        addAllOfCheck(app, typed, options);
    else if (command == Command::kFarm)
        addAllOfFarm(app, typed, options, nullptr);
    else
        addAll(app, typed, options, nullptr);
    if (const std::string about = aboutSigns(app, arguments); !about.empty()) refuseWords(about);
    const bool isRender = command == Command::kRender;
    try {
        // CLI11 takes them from the end.
        app.parse(
            std::vector<std::string>(arguments.rbegin(), arguments.rend() - (isRender ? 0 : 1)));
    } catch (const CLI::ParseError& error) {
        const std::string about = isRender ? aboutVerbs(arguments, true) : std::string();
        if (!about.empty()) refuseWords(about);
        const bool isUnknown = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
        refuseWords(isUnknown ? aboutUnknownWords(app, app.remaining()) : oneLine(error.what()));
    }
    if (const std::string about = isRender ? aboutVerbs(arguments, false) : std::string();
        !about.empty())
        refuseWords(about);
    if (command == Command::kFarm) options.farm->given = givenOptions(app);
}

}  // namespace

Options parseCommandLine(const std::vector<std::string>& arguments, bool areNamesFilled) {
    const Command command = commandOf(arguments);
    const bool isMerge = command == Command::kMerge;
    Options options;
    Typed typed;
    if (command == Command::kCheck) options.check.emplace();
    if (command == Command::kFarm) options.farm.emplace();
    if (command == Command::kWatch) options.watch.emplace();
    readWords(arguments, command, typed, options);
    options.helpOfMerge = options.help && isMerge;
    options.helpOfCache = options.help && command == Command::kCache;
    options.helpOfCheck = options.help && command == Command::kCheck;
    options.helpOfFarm = options.help && command == Command::kFarm;
    options.helpOfWatch = options.help && command == Command::kWatch;
    options.helpOfPack = options.help && command == Command::kPack;
    if (options.help || options.version) return options;
    if (command == Command::kCheck) {
        readCheck(typed, *options.check);
        return options;
    }
    options.pack = command == Command::kPack;
    readTextureCache(typed, options);
    readCopies(typed, options);
    if (command == Command::kCache) {
        if (!options.cacheList && !options.cacheClear && !options.cacheVerify)
            throw HostError(ExitCode::kUsage,
                            "usage: pm_host cache --list|--verify|--clear [--texture-cache DIR], "
                            "see pm_host cache -h");
        return options;
    }
    std::optional<std::int64_t> frame;
    readFrames(typed, options);
    if (!typed.frame.empty()) {
        frame = integerValue("--frame", typed.frame, 0, std::numeric_limits<std::int32_t>::max());
    }
    readFiles(typed, {frame, areNamesFilled}, options);
    options.exposure = exposureValue(typed);
    readChoices(typed, options);
    if (options.watch) {
        readWatch(typed, {frame, areNamesFilled}, options);
        return options;
    }
    if (isMerge) {
        checkMerge(options);
        return options;
    }
    readReadRules(typed, options);
    options.reading.pov.frame = frame;
    readCamera(typed, options);
    readSettings(typed, frame, options);
    readPhotonMap(typed.photonMap, typed.settings, {frame, areNamesFilled}, options);
    if (options.pack) checkPack(options);
    addDefaultOutput(options);
    readPieces(typed.checkpoint, {frame, areNamesFilled}, options);
    checkBuckets(typed.settings, options);
    if (options.scene.empty() && options.list.empty()) {
        throw HostError(ExitCode::kUsage,
                        "no SCENE given; usage: pm_host SCENE [options], see "
                        "pm_host -h");
    }
    if (options.farm) readFarm(typed, options);
    return options;
}

}  // namespace pm::host
