// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <functional>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "host_shim/cli/options.h"
#include "host_shim/colour/colour_pipeline.h"
#include "host_shim/colour/display_picture.h"
#include "host_shim/colour/exposure.h"
#include "host_shim/log/log.h"
#include "host_shim/pictures/picture.h"
#include "host_shim/pictures/picture_io.h"
#include "host_shim/process/temporary_folder.h"
#include "host_shim/render/render_run.h"
#include "host_shim/render/scene_memory.h"
#include "host_shim/render/tiled_output.h"
#include "host_shim/report/report_pictures.h"
#include "host_shim/session/report.h"
#include "host_shim/session/statistics.h"

namespace pm::host {

class MaterialBuilder;
class MergeRun;

// One rendering from files to files, or one merging of parts.
class Session {
  public:
    Session(const Options& options, Log& log);

    // Renders or merges, and writes; returns the exit code. Statistics are written on failure too.
    int run();
    // Whether writeAgain() may come in place of a render of a frame for which areSameRender():
    // run() ended well, nothing but files came of it, and none of the frame's is to be looked into
    // first.
    bool canWriteAgain(const Options& frame) const;
    // Writes the files of run() again under a frame's names, with its command line; returns the
    // exit code. ofFrame: the number of the frame that run() was for.
    int writeAgain(const Options& frame, std::int64_t ofFrame);
    // That the render's errors are of, stops; nothing before it has planned.
    std::optional<std::int32_t> errorScale() const { return m_statistics.errorScaleStops(); }
    // Of pm_host watch: writes the pictures with the buckets that are there; the others are
    // transparent black, and pm:complete is 0. isShown: the answer is the display picture, for a
    // page; else empty. Errors: as run's, thrown.
    EmbeddedPicture writeIncomplete(const MergeRun& parts, bool isShown);

  private:
    int render();
    void checkBeforeReading();
    void readReference(const ColourPipeline& colour);
    void readDisplayReference();
    // Puts the reference's name before what check throws.
    void namingReference(const std::function<void()>& check) const;
    void buildScene(const ColourPipeline& colour, TemporaryFolder& folder,
                    std::optional<PluginScene>& scene);
    void handOver(SceneData& data, const CameraPose& camera, const ColourPipeline& colour,
                  TemporaryFolder& folder, std::optional<PluginScene>& scene);
    void noteFiles(const SceneData& data);
    // SCENE.pm.json (session_sidecar.cpp). Errors: kUsage where it may not be written.
    void checkSidecar() const;
    void writeSidecar(const SceneData& data);
    int renderScene(const ColourPipeline& colour, const PluginContext& context);
    int renderBuilt(const ColourPipeline& colour, const PluginScene& scene);
    // For another frame, after the render (session_again.cpp).
    void writeFilesAgain(const Options& frame);
    void copyFiles(const Options& frame);
    void noteCommandLine(const Options& options);
    // Statistics and report; 0, or the exit code of the first that failed.
    int writePages();
    int merge();
    void checkBeforeMerging();
    void warnOfVendors(const std::vector<std::string>& vendors);
    PmrContextDesc contextDesc(const Plugin& plugin);
    // Camera, light and exposure (session_look.cpp).
    CameraPose frameScene(const SceneData& data);
    void buildLit(SceneData& data, const CameraPose& camera, const ColourPipeline& colour,
                  MaterialBuilder& materials, std::optional<PluginScene>& scene);
    // A pilot of the scene with unasked alpha taken, where there is any; what it built is gone.
    void meterWithAlpha(SceneData& data, const std::function<void()>& build,
                        const ColourPipeline& colour, MaterialBuilder& materials,
                        std::optional<PluginScene>& scene);
    // Whether its own light shows what is seen; tells where it does but little of it.
    bool isLit(const Picture& seen, const ColourPipeline& colour);
    const Picture& pilot(const PluginScene& scene, const ColourPipeline& colour);
    bool measuresExposure(const ColourPipeline& colour) const;
    bool exposes() const;
    void expose(const PluginScene& scene, const ColourPipeline& colour,
                std::optional<DisplayTransform>& display);
    void exposeAsParts(const std::string& notes, const ColourPipeline& colour,
                       DisplayTransform& display);
    void tellExposure();
    // What comes after the render (session_pictures.cpp).
    [[noreturn]] static void throwStopped(PmrStatus status);
    int finishPhotons(PmrStatus status);
    int finish(const PictureSource& source, PmrStatus status, const ColourPipeline& colour,
               const std::optional<DisplayTransform>& display);
    // The same for a render whose buckets went to files as they came (session_tiles.cpp).
    int finishTiles(PmrStatus status, TiledOutput& output);
    void noteEnd();
    // No picture is black without a word (session_dark.cpp).
    void lookForLight(const Picture& picture);
    void warnOfBlack();
    bool standsInClosedSpace() const;
    void lookForDarkness(const std::filesystem::path& file, const Picture& picture,
                         const DisplayPicture& shown);
    void warnOfClamped(const std::filesystem::path& file, const ExrReport& report);
    // " estimated relMSE ..." for lines that tell what was written.
    std::string errorText() const;
    std::optional<SeenError> seenError(const PictureSource& source, const Picture& picture,
                                       const DisplayTransform& display) const;
    // A picture's file, and what is to be told of it once it is written.
    struct Written {
        std::filesystem::path file;
        std::optional<HostError> failure{};
        ExrReport exr{};
        std::optional<DisplayResult> shown{};
    };
    void writeOutputs(const Picture& picture, const std::optional<DisplayTransform>& display);
    std::vector<std::future<Written>> beginOutputs(
        const Picture& picture, bool complete,
        const std::optional<DisplayTransform>& display) const;
    void endOutputs(const Picture& picture, std::vector<std::future<Written>>& written);
    void write(const Picture& picture, const std::optional<DisplayTransform>& display,
               Written& done) const;
    void tellOf(const Written& done, const Picture& picture);
    int compareWithReference(const Picture& picture);
    int compareWithDisplayReference(const Picture& picture, const DisplayTransform& display);
    int judgeAgainstLimit(const std::string& name, std::optional<double> value);
    // Tells of samples that are no light; the exit code, which is 3 with --strict.
    int judgeSamples();
    // A result, to standard output.
    void print(const std::string& result);
    void printPixel(const Picture& picture) const;
    void writeStatistics();
    void writeReport();
    // Runs work and notes how long it took.
    void phase(const std::string& name, const std::function<void()>& work);
    void warn(Warning code, const std::string& text);

    Options m_options;
    Log& m_log;
    std::string m_explanation;  // of the scene, by its reader
    Statistics m_statistics;
    Report m_report;                              // gathers only where one is wanted
    std::optional<HostMemory> m_memory;           // of a scene that is read
    std::vector<std::filesystem::path> m_inputs;  // of the command line and of the scene
    std::string m_results;                        // that were printed
    std::optional<Picture> m_reference;
    std::optional<DisplayPicture> m_displayReference;  // in place of it
    std::optional<Picture> m_pilot;      // of the scene as it is rendered; see pilot()
    Exposure m_exposure;                 // of display pictures
    std::optional<CameraPose> m_camera;  // nothing before the scene is read, and of merges
    Bounds m_bounds;                     // of the scene
    bool m_hasLight{};                   // of its own
    bool m_hasSky{};
    bool m_hasBackground{};  // what is seen where the scene is not
    bool m_isFramed{};       // nobody said where the camera stands
    bool m_hasCameraLight{};
    bool m_isIncomplete{};  // on purpose: what can't be seen yet is no fault
    // Statistics and report; not before it is known that they overwrite no input.
    bool m_mayWriteStatistics{};
};

}  // namespace pm::host
