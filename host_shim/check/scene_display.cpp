// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/check/scene_display.h"

#include <fmt/format.h>

#include "host_shim/cli/command_line.h"
#include "host_shim/colour/display_picture.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

std::string placeOf(const Suite& suite, const SuiteScene& scene, const SuiteView* view) {
    return fmt::format("{}: scene '{}'{}: ", suite.file.string(), scene.name,
                       view == nullptr ? "" : fmt::format(", view '{}'", view->name));
}

// What a scene's options may not ask for: the check renders one whole picture of it.
void refuseWhatIsNoPicture(const Options& options) {
    const auto refuse = [](const std::string& what) {
        throw HostError(ExitCode::kBadInput, what +
                                                 " is not for a suite: whole pictures are "
                                                 "rendered, to files of the check's own");
    };
    if (options.help || options.version || options.explain || !options.list.empty())
        refuse("what prints and stops");
    if (options.photonsOnly) refuse("--photons-only");
    if (!options.checkpoint.empty()) refuse("--checkpoint");
    if (options.onlyPixel) refuse("--only-pixel");
    if (!options.frames.empty()) refuse("--frames");
    if (options.writeSidecar) refuse("--write-sidecar");
    if (!options.bucketTimes.empty()) refuse("--bucket-times");
    const fs::path own = options.scene.stem().string() + ".exr";
    if (!options.part.empty() || options.outputs != std::vector<fs::path>{own}) refuse("-o");
}

Options parsedOptions(const Suite& suite, const SuiteScene& scene, const SuiteView* view) {
    std::vector<std::string> words{scene.scene.string()};
    words.insert(words.end(), scene.options.begin(), scene.options.end());
    if (view != nullptr) words.insert(words.end(), view->options.begin(), view->options.end());
    try {
        Options options = parseCommandLine(words);
        if (options.exposure.kind == ExposureOption::Kind::kAuto)
            throw HostError(ExitCode::kBadInput,
                            "--exposure auto: a suite's pictures are of one exposure; give STOPS");
        refuseWhatIsNoPicture(options);
        std::string& config = options.colour.ocioFile;
        if (!config.empty() && !config.starts_with("ocio://"))
            config = (suite.folder / config).string();
        return options;
    } catch (const HostError& error) {
        throw HostError(ExitCode::kBadInput, placeOf(suite, scene, view) + error.what());
    }
}

}  // namespace

void checkOptions(const Suite& suite, const SuiteScene& scene) {
    parsedOptions(suite, scene, nullptr);
    const auto check = [&](const SuiteView* view) {
        try {
            SceneDisplay(suite, scene, view);
        } catch (const HostError& error) {
            const std::string place = placeOf(suite, scene, view), text = error.what();
            throw HostError(error.code(), text.starts_with(place) ? text : place + text);
        }
    };
    if (scene.hasDisplay) check(nullptr);
    for (const SuiteView& view : scene.views) check(&view);
}

SceneDisplay::SceneDisplay(const Suite& suite, const SuiteScene& scene, const SuiteView* view) {
    const Options options = parsedOptions(suite, scene, view);
    m_transform = ColourPipeline(options.colour).displayTransform();
    m_transform->setExposureStops(options.exposure.stops);
}

DisplayPicture SceneDisplay::shown(const Picture& picture) const {
    return makeDisplayPicture(picture, *m_transform).picture;
}

std::optional<SceneDisplay> findDisplay(const Suite& suite, const SuiteScene& scene) {
    try {
        return SceneDisplay(suite, scene);
    } catch (const HostError&) {
        return std::nullopt;
    }
}

}  // namespace pm::host
