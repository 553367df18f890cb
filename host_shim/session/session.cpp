// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/session/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <future>
#include <memory>

#include "host_shim/colour/display_picture.h"
#include "host_shim/formats/all/scene_readers.h"
#include "host_shim/formats/lamps.h"
#include "host_shim/formats/scene_twin.h"
#include "host_shim/formats/source_file.h"
#include "host_shim/log/guarded.h"
#include "host_shim/pictures/compare.h"
#include "host_shim/pictures/display_compare.h"
#include "host_shim/pictures/picture_io.h"
#include "host_shim/process/interrupt.h"
#include "host_shim/process/outputs.h"
#include "host_shim/process/plain_text.h"
#include "host_shim/process/side_work.h"
#include "host_shim/render/picture_assembly.h"
#include "host_shim/render/scene_builder.h"
#include "host_shim/render/scene_memory.h"
#include "host_shim/render/texture_setup.h"
#include "host_shim/session/read_rules.h"
#include "host_shim/session/session_files.h"
#include "host_shim/sky/sky_light.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

bool timesBuckets(const Options& options) {
    return !options.report.empty() || !options.bucketTimes.empty();
}

}  // namespace

void Session::noteCommandLine(const Options& options) {
    m_statistics.commandLine = {"pm_host"};
    for (const std::string& word : options.commandLine)
        m_statistics.commandLine.push_back(withoutPasswords(word));
}

Session::Session(const Options& options, Log& log) : m_options(options), m_log(log) {
    noteCommandLine(options);
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
    // Told already; the statistics say so as well.
    if (m_statistics.exitCode == 0 && m_log.fileFailed()) {
        m_statistics.exitCode = static_cast<int>(ExitCode::kFile);
        m_statistics.error = m_options.log.string() + ": can't be written";
    }
    const int written = writePages();
    return m_statistics.exitCode != 0 ? m_statistics.exitCode : written;
}

int Session::writePages() {
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
    if (written == 0 && m_log.fileFailed()) written = static_cast<int>(ExitCode::kFile);
    return written;
}

int Session::render() {
    if (!m_options.merge.empty()) return merge();
    checkBeforeReading();
    // To load the library takes as long as to make the colours ready.
    std::future<std::unique_ptr<const Plugin>> loading =
        doBeside(m_options.threads != 1, [file = m_options.plugin] {
            return std::unique_ptr<const Plugin>(std::make_unique<Plugin>(file));
        });
    const ColourPipeline colour(m_options.colour);
    m_statistics.colourConfig = colour.configName();
    m_statistics.renderingSpace = colour.renderingSpace();
    for (const std::string& text : colour.warnings()) warn(Warning::kOutput, text);
    if (!m_options.reference.empty()) readReference(colour);
    const std::unique_ptr<const Plugin> loaded = loading.get();
    const Plugin& plugin = *loaded;
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
    checkSidecar();
    checkNotInputs(allOutputs(m_options), inputsOf(m_options, nullptr));
    checkOutputs({}, otherOutputs(m_options), m_options.makeOutputPath);
    m_mayWriteStatistics = true;
    checkSceneFile(scene, sceneKinds());
    sceneReaderFor(scene);
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

void Session::readDisplayReference() {
    m_displayReference = readDisplayPicture(m_options.reference);
    const PixelRect window = dataWindowOf(m_options);
    namingReference([&] {
        checkSameSize(m_displayReference->width, m_displayReference->height, window.width(),
                      window.height());
    });
}

void Session::namingReference(const std::function<void()>& check) const {
    try {
        check();
    } catch (const HostError& fault) {
        throw HostError(ExitCode::kBadInput,
                        fmt::format("{}: {}", m_options.reference.string(), fault.what()));
    }
}

void Session::readReference(const ColourPipeline& colour) {
    if (isDisplayReference(m_options)) return readDisplayReference();
    m_reference = readExr(m_options.reference);
    for (const char* channel : {"R", "G", "B"}) {
        if (m_reference->find(channel) == nullptr) {
            throw HostError(
                ExitCode::kBadInput,
                fmt::format("{}: the reference has no channel {}; R, G and B are wanted",
                            m_options.reference.string(), channel));
        }
    }
    namingReference([&] {
        checkWindows(*m_reference, m_options.width, m_options.height, dataWindowOf(m_options));
    });
    if (const std::string* space = renderingSpaceOf(*m_reference);
        space != nullptr && *space != colour.renderingSpace()) {
        throw HostError(ExitCode::kBadInput,
                        fmt::format("{}: the reference is in rendering space '{}', the picture in "
                                    "'{}'; they must be the same (--rendering-space)",
                                    m_options.reference.string(), *space, colour.renderingSpace()));
    }
}

void Session::noteFiles(const SceneData& data) {
    if (!data.sidecar.empty())
        m_log.info(
            fmt::format("{}: is read with the scene (--no-sidecar leaves it out)", data.sidecar));
    m_statistics.materialFiles = data.materialFiles;
    m_explanation = data.explanation;
    for (const MaterialFile& library : data.materialFiles)
        m_log.message(Level::kDebug, fmt::format("{}: MTL as {} writes it: {}", library.file,
                                                 library.dialect, library.reason));
}

// Reads the scene's file and builds what is rendered; what was read is free again at the end.
void Session::buildScene(const ColourPipeline& colour, TemporaryFolder& folder,
                         std::optional<PluginScene>& scene) {
    const WarningSink sink = [this](Warning code, const std::string& text) { warn(code, text); };
    SceneData data;
    const MemoryNote takes = takeForReading(m_options.scene, sidecarInUse(m_options), *m_memory);
    phase("readSceneSeconds",
          [&] { data = readScene(m_options, sink, m_options.camera.eye, takes); });
    giveBackFreed();
    noteFiles(data);
    warnOfLampsWithoutArea(data, m_options.scene.string(), sink);
    addBackSides(data);
    m_mayWriteStatistics = false;
    m_inputs = inputsOf(m_options, &data);
    checkNotInputs(allOutputs(m_options), m_inputs);
    m_mayWriteStatistics = true;
    const CameraPose camera = frameScene(data);
    m_camera = camera;
    m_bounds = data.bounds;
    m_hasLight = data.hasLight();
    m_hasSky = data.sky.has_value();
    m_hasBackground = m_hasSky || data.environment.has_value();
    m_isFramed = !m_options.camera.eye && data.cameras.empty();
    if (camera.upWasReplaced) {
        const bool isOfFile = !m_options.camera.up && !data.cameras.empty();
        warn(Warning::kCamera,
             fmt::format("{} is parallel to the view; another direction is taken",
                         isOfFile ? data.sidecar + ": up of the camera" : "--up"));
    }
    m_log.message(Level::kDebug,
                  fmt::format("{} meshes, {} faces, {} materials from {} libraries; eye {:g}, "
                              "{:g}, {:g}, looking at {:g}, {:g}, {:g}",
                              data.meshes.size(), data.faceCount, data.materials.size(),
                              data.materialFiles.size(), camera.eye[0], camera.eye[1],
                              camera.eye[2], camera.lookAt[0], camera.lookAt[1], camera.lookAt[2]));
    TemporaryFolder ofSky;
    // Not before the camera is found: of views that are alike it may find another.
    if (m_options.twin != 0) makeTwin(m_options.twin, data);
    makeSky(camera.up[2] > std::abs(camera.up[1]), ofSky, data);
    handOver(data, camera, colour, folder, scene);
    if (m_options.writeSidecar) writeSidecar(data);
}

// Gives what was read to the library. folder: for textures that can't be kept.
void Session::handOver(SceneData& data, const CameraPose& camera, const ColourPipeline& colour,
                       TemporaryFolder& folder, std::optional<PluginScene>& scene) {
    const PluginContext& context = scene->context();
    takeForBuilding(m_options, data, *m_memory);
    // The builder keeps a reference to it.
    const WarningSink sink = [this](Warning code, const std::string& text) { warn(code, text); };
    MaterialBuilder materials(
        context, colour,
        [&] {
            TextureSettings settings = textureSettings(m_options, *m_memory);
            settings.otherCache = [&](const std::string& why) {
                return openRunsCache(m_options, why, folder, m_log);
            };
            return TexturePreparer(colour, openTextureCache(m_options, folder, m_log), settings,
                                   throwIfInterrupted);
        },
        sink);
    buildLit(data, camera, colour, materials, scene);
    m_statistics.textureFiles = materials.preparedFiles();
    const TextureCounts textures = materials.textureCounts();
    if (textures.found + textures.converted > 0)
        m_log.message(Level::kDebug,
                      fmt::format("textures: {} found prepared, {} made, {} originals opened",
                                  textures.found, textures.converted, textures.originalsOpened));
}

int Session::renderScene(const ColourPipeline& colour, const PluginContext& context) {
    m_memory.emplace(m_options, context.api());
    TemporaryFolder folder;
    std::optional<PluginScene> scene;
    scene.emplace(context, m_log);
    buildScene(colour, folder, scene);
    giveBackFreed();
    m_options.settings.push_back({"", "hostPeakGib", fmt::format("{:.6f}", m_memory->peakGib())});
    try {
        return renderBuilt(colour, *scene);
    } catch (const HostError& error) {
        const std::string step = m_memory->refused();
        if (error.code() != ExitCode::kMemory || step.empty()) throw;
        throw HostError(ExitCode::kMemory, fmt::format("{}; {}", step, error.what()));
    }
}

int Session::renderBuilt(const ColourPipeline& colour, const PluginScene& scene) {
    std::optional<DisplayTransform> display;
    if (wantsDisplay(m_options)) display = colour.displayTransform();
    expose(scene, colour, display);
    Progress progress(m_options.progress, m_options.quiet, m_log);
    RenderRun run(scene, m_options, colourIdentity(colour), m_log, progress,
                  timesBuckets(m_options) ? &m_report.bucketTimes() : nullptr);
    std::optional<TiledOutput> tiles;
    if (run.deliversBuckets()) {
        const std::string whole = needsWholePicture(m_options);
        if (whole.empty())
            run.setTaker(&tiles.emplace(run, m_options, colour));
        else
            run.keepFrame(whole + " needs the whole picture at once");
    }
    if (m_options.explain) {
        std::fputs(
            plainLines(m_explanation + run.explain() + explainMaterials(m_statistics.materialFiles))
                .c_str(),
            stdout);
        m_statistics.stopReason = "finished";
        return 0;
    }
    PmrStatus status = PMR_OK;
    phase("renderCallSeconds", [&] { status = run.run(); });
    m_statistics.library = run.statistics();
    if (!m_options.bucketTimes.empty())
        writeFinishedFile(m_options.bucketTimes, m_report.bucketTimes().csv());
    if (m_options.photonsOnly) return finishPhotons(status);
    const int code = tiles ? finishTiles(status, *tiles) : finish(run, status, colour, display);
    const int ofSamples = judgeSamples();
    return code != 0 ? code : ofSamples;
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
