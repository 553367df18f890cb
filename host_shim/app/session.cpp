// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/app/session.h"

#include "host_shim/app/guarded.h"
#include "host_shim/app/interrupt.h"
#include "host_shim/app/outputs.h"
#include "host_shim/app/picture_assembly.h"
#include "host_shim/app/scene_builder.h"
#include "host_shim/app/session_files.h"
#include "host_shim/colour/display_picture.h"
#include "host_shim/ingest/obj_reader.h"
#include "host_shim/pictures/compare.h"
#include "host_shim/pictures/picture_io.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

namespace pm::host {
namespace {

namespace fs = std::filesystem;

constexpr int kErrorLimitPassed = 6;

}  // namespace

Session::Session(const Options& options, Log& log) : m_options(options), m_log(log) {
    m_statistics.commandLine = options.commandLine;
    m_statistics.commandLine.insert(m_statistics.commandLine.begin(), "pm_host");
    m_statistics.scene = options.scene.string();
    if (m_options.onlyPixel) {
        const auto [x, y] = *m_options.onlyPixel;
        m_options.crop = PixelRect{x, y, x + 1, y + 1};
    }
}

void Session::warn(Warning code, const std::string& text) {
    m_log.warning(static_cast<int>(code), text);
}

void Session::phase(const std::string& name, const std::function<void()>& work) {
    throwIfInterrupted();
    const auto start = std::chrono::steady_clock::now();
    try {
        work();
    } catch (...) {
        throwIfInterrupted();  // what failed was given up
        throw;
    }
    m_statistics.phaseSeconds[name] +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

int Session::run() {
    ignoreBrokenPipes();
    m_statistics.exitCode = guarded(
        m_log, [this] { return render(); }, &m_statistics.error);
    if (m_statistics.exitCode == 130) m_statistics.stopReason = "interrupted";
    if (m_statistics.exitCode == 143) m_statistics.stopReason = "terminated";
    m_log.reportHiddenWarnings();
    const bool toFile = m_options.statistics != "-";
    int written = 0;
    const auto write = [&](void (Session::*work)()) {
        const int code = guarded(m_log, [&] {
            (this->*work)();
            return 0;
        });
        if (written == 0) written = code;
    };
    if (!m_options.statistics.empty() && (!toFile || m_mayWriteStatistics))
        write(&Session::writeStatistics);
    if (!m_options.report.empty() && m_mayWriteStatistics) write(&Session::writeReport);
    return m_statistics.exitCode != 0 ? m_statistics.exitCode : written;
}

int Session::render() {
    if (!m_options.merge.empty()) return merge();
    checkBeforeReading();
    const ColourPipeline colour(m_options.colour);
    m_statistics.colourConfig = colour.configName();
    m_statistics.renderingSpace = colour.renderingSpace();
    for (const std::string& text : colour.warnings()) warn(Warning::kOutput, text);
    if (!m_options.reference.empty()) readReference(colour);
    const Plugin plugin(m_options.plugin);
    const PluginContext context(plugin, contextDesc(plugin));
    m_log.message(Level::kDebug,
                  fmt::format("{}: {}; colour config {}, rendering space {}",
                              m_statistics.pluginFile, m_statistics.pluginVersion,
                              m_statistics.colourConfig, m_statistics.renderingSpace));
    return renderScene(colour, context);
}

PmrContextDesc Session::contextDesc(const Plugin& plugin) {
    m_statistics.pluginFile = plugin.file().string();
    m_statistics.pluginVersion = plugin.api().versionText();
    auto desc = PMR_INIT(PmrContextDesc);
    desc.message = logPluginMessage;
    desc.user = &m_log;
    desc.isa = m_options.isa.empty() ? nullptr : m_options.isa.c_str();
    desc.threads = m_options.threads;
    return desc;
}

void Session::checkBeforeReading() {
    // Of a fault in the scene and one in the outputs, people look for the first.
    const fs::path& scene = m_options.scene;
    checkNotInputs(allOutputs(m_options), inputsOf(m_options, nullptr));
    checkOutputs({}, otherOutputs(m_options), m_options.makeOutputPath);
    m_mayWriteStatistics = true;
    checkSceneFile(scene);
    if (scene.extension() != ".obj" && scene.extension() != ".OBJ") {
        throw HostError(ExitCode::kBadInput,
                        fmt::format("{}: '{}' is no scene format that can be read; allowed is .obj",
                                    scene.string(), scene.extension().string()));
    }
    const bool toExr = std::ranges::any_of(m_options.outputs, [](const fs::path& file) {
        return !isDisplayReferred(pictureFormat(file));
    });
    const bool canHoldLayers = toExr || !m_options.part.empty();
    if (!m_options.layers.empty() && !canHoldLayers && !m_options.onlyPixel && !m_options.explain) {
        throw HostError(ExitCode::kUsage,
                        fmt::format("--aov {}: layers go into an .exr, and no output is one",
                                    m_options.layers));
    }
    checkOutputs(m_options.explain ? std::vector<fs::path>{} : m_options.outputs,
                 otherOutputs(m_options), m_options.makeOutputPath);
    if (!m_options.log.empty()) m_log.openFile(m_options.log);
}

void Session::readReference(const ColourPipeline& colour) {
    m_reference = readExr(m_options.reference);
    for (const char* channel : {"R", "G", "B"}) {
        if (m_reference->find(channel) == nullptr) {
            throw HostError(
                ExitCode::kBadInput,
                fmt::format("{}: the reference has no channel {}; R, G and B are wanted",
                            m_options.reference.string(), channel));
        }
    }
    try {
        checkWindows(*m_reference, m_options.width, m_options.height, dataWindowOf(m_options));
    } catch (const HostError& fault) {
        throw HostError(ExitCode::kBadInput,
                        fmt::format("{}: {}", m_options.reference.string(), fault.what()));
    }
    if (const std::string* space = renderingSpaceOf(*m_reference);
        space != nullptr && *space != colour.renderingSpace()) {
        throw HostError(ExitCode::kBadInput,
                        fmt::format("{}: the reference is in rendering space '{}', the picture in "
                                    "'{}'; they must be the same (--rendering-space)",
                                    m_options.reference.string(), *space, colour.renderingSpace()));
    }
}

int Session::renderScene(const ColourPipeline& colour, const PluginContext& context) {
    const WarningSink sink = [this](Warning code, const std::string& text) { warn(code, text); };
    std::optional<DisplayTransform> display;
    if (wantsDisplay(m_options)) display = colour.displayTransform();
    TemporaryFolder folder;
    MaterialBuilder materials(context, colour, folder, sink);
    PluginScene scene(context);
    {
        SceneData data;
        phase("readSceneSeconds",
              [&] { data = readObjFile(m_options.scene, sink, throwIfInterrupted); });
        m_mayWriteStatistics = false;
        checkNotInputs(allOutputs(m_options), inputsOf(m_options, &data));
        m_mayWriteStatistics = true;
        CameraOptions cameraOptions = m_options.camera;
        cameraOptions.fromNegativeZ = opensTowardsNegativeZ(data);
        const CameraPose camera = frameCamera(
            cameraOptions, data.bounds, static_cast<double>(m_options.width) / m_options.height);
        if (camera.upWasReplaced) {
            warn(Warning::kCamera, "--up is parallel to the view; another direction is taken");
        }
        m_log.message(
            Level::kDebug,
            fmt::format("{} meshes, {} faces, {} materials from {} libraries; eye {:g}, "
                        "{:g}, {:g}, looking at {:g}, {:g}, {:g}",
                        data.meshes.size(), data.faceCount, data.materials.size(),
                        data.materialFiles.size(), camera.eye[0], camera.eye[1], camera.eye[2],
                        camera.lookAt[0], camera.lookAt[1], camera.lookAt[2]));
        phase("buildSceneSeconds", [&] {
            const InterruptWatch watch([&] { context.api().cancelBuilds(context.handle(), 1); });
            scene.build(data, m_options.scene.string(), m_options.subdivide, camera, colour,
                        materials, sink);
        });
    }
    Progress progress(m_options.progress, m_options.quiet, m_log);
    RenderRun run(scene, m_options, colourIdentity(colour), m_log, progress,
                  m_options.report.empty() ? nullptr : &m_report.bucketTimes());
    std::optional<TiledOutput> tiles;
    if (run.deliversBuckets()) {
        const std::string whole = needsWholePicture(m_options);
        if (whole.empty())
            run.setTaker(&tiles.emplace(run, m_options, colour));
        else
            run.keepFrame(whole + " needs the whole picture at once");
    }
    if (m_options.explain) {
        std::fputs(run.explain().c_str(), stdout);
        m_statistics.stopReason = "finished";
        return 0;
    }
    PmrStatus status = PMR_OK;
    phase("renderCallSeconds", [&] { status = run.run(); });
    m_statistics.library = run.statistics();
    if (m_options.photonsOnly) return finishPhotons(status);
    return tiles ? finishTiles(status, *tiles) : finish(run, status, colour, display);
}

int Session::finishPhotons(PmrStatus status) {
    if (status != PMR_OK) {
        throwIfInterrupted();
        throw HostError(static_cast<ExitCode>(exitCodeOf(status)), "the render was cancelled");
    }
    m_statistics.outputs.push_back(m_options.photonMap.string());
    m_statistics.stopReason = m_statistics.libraryStopReason();
    m_log.info(
        fmt::format("wrote {}: {}", m_options.photonMap.string(), m_statistics.photonMapText()));
    return 0;
}

int Session::finish(const PictureSource& source, PmrStatus status, const ColourPipeline& colour,
                    const std::optional<DisplayTransform>& display) {
    const bool complete = status == PMR_OK;
    const auto start = m_log.elapsedSeconds();
    const Picture picture = assemblePicture(source, m_options, colour, complete);
    const auto report = [&] {
        if (m_options.report.empty()) return;
        m_report.takePicture(source, picture, m_reference ? &*m_reference : nullptr,
                             display.value(), colour.luminanceWeights());
    };
    try {
        writeOutputs(picture, complete, display);
    } catch (...) {
        report();
        throw;
    }
    report();
    m_statistics.phaseSeconds["writePicturesSeconds"] = m_log.elapsedSeconds() - start;
    if (!complete) {
        throwIfInterrupted();
        throw HostError(static_cast<ExitCode>(exitCodeOf(status)), "the render was cancelled");
    }
    if (!m_options.part.empty()) {
        m_statistics.outputs.push_back(m_options.part.string());
        m_log.info("wrote " + m_options.part.string());
    }
    // Only now that all is written nothing is lost without it.
    std::error_code ignored;
    if (!m_options.checkpoint.empty() && !m_options.keepCheckpoint)
        fs::remove(m_options.checkpoint, ignored);
    m_statistics.stopReason = m_statistics.libraryStopReason();
    if (m_statistics.stopReason == "error target" || m_statistics.stopReason == "time limit")
        m_log.info("stopped by the " + m_statistics.stopReason);
    if (isBlackThoughHit(picture)) warnOfBlack();
    if (m_options.onlyPixel) printPixel(picture);
    return m_reference ? compareWithReference(picture) : 0;
}

void Session::warnOfBlack() {
    warn(Warning::kBlackPicture,
         "the picture is black though it shows surfaces: no light reaches their seen side; a "
         "room that is closed all round is seen from inside with --eye and --look-at only");
}

void Session::warnOfClamped(const fs::path& file, const ExrReport& report) {
    if (report.clampedToHalf > 0)
        warn(Warning::kOutput, fmt::format("{}: {} values are beyond half's 65504 and clamped",
                                           file.string(), report.clampedToHalf));
}

std::string Session::errorText() const {
    const auto estimate = m_statistics.estimatedRelMse();
    if (!estimate) return "";
    return fmt::format(", estimated relMSE {:.2e} (noise and bias, from what passes differ by)",
                       *estimate);
}

void Session::writeOutputs(const Picture& picture, bool complete,
                           const std::optional<DisplayTransform>& display) {
    const std::string error = errorText();
    // One that fails must not take the others with it.
    std::optional<HostError> failure;
    for (const fs::path& output : m_options.outputs) {
        const fs::path file = complete ? output : partialName(output);
        try {
            writeOutput(file, picture, display);
        } catch (const HostError& fault) {
            if (failure) m_log.message(Level::kError, failure->what());
            failure = fault;
            continue;
        }
        m_statistics.outputs.push_back(file.string());
        m_log.info(fmt::format("wrote {}{}", file.string(), error));
    }
    if (failure) throw *failure;
}

void Session::writeOutput(const fs::path& file, const Picture& picture,
                          const std::optional<DisplayTransform>& display) {
    if (!isDisplayReferred(pictureFormat(file))) {
        warnOfClamped(file, writeExr(file, picture, {m_options.exrHalf}));
        return;
    }
    const DisplayResult result = makeDisplayPicture(picture, display.value());
    const auto bad = result.cleaning.nanCount + result.cleaning.infiniteCount;
    if (bad > 0) {
        warn(Warning::kOutput, fmt::format("{}: {} values were not finite", file.string(), bad));
    }
    writeDisplayPicture(file, result.picture);
}

int Session::compareWithReference(const Picture& picture) {
    const ErrorReport report = compareRelMse(*m_reference, picture);
    if (!report.relMse) {
        std::fputs("relMSE nan\n", stdout);
        warn(Warning::kOutput,
             fmt::format("{} values of the picture and {} of the reference are not finite",
                         report.badInPicture, report.badInReference));
    } else {
        std::fputs(fmt::format("relMSE {}\n", *report.relMse).c_str(), stdout);
        m_statistics.referenceRelMse = report.relMse;
    }
    if (!m_options.errorLimit) return 0;
    if (report.relMse && *report.relMse <= *m_options.errorLimit) return 0;
    m_statistics.stopReason = "error limit";
    m_statistics.error = report.relMse ? fmt::format("relMSE {} is above the limit {}",
                                                     *report.relMse, *m_options.errorLimit)
                                       : "a value is not finite";
    m_log.message(Level::kError, m_statistics.error);
    return kErrorLimitPassed;
}

void Session::printPixel(const Picture& picture) const {
    for (const Channel& channel : picture.channels) {
        std::fputs(fmt::format("{} {}\n", channel.name, channel.values.at(0)).c_str(), stdout);
    }
    std::fflush(stdout);
}

void Session::writeStatistics() {
    const std::string text = m_statistics.toJson(m_log);
    if (m_options.statistics == "-") {
        std::fwrite(text.data(), 1, text.size(), stdout);
        std::fflush(stdout);
    } else {
        writeFinishedFile(m_options.statistics, text);
    }
}

void Session::writeReport() {
    writeFinishedFile(m_options.report, m_report.page(m_statistics.toJson(m_log)));
    m_log.info("wrote " + m_options.report.string());
}

}  // namespace pm::host
