// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/check/scene_check.h"

#include <fmt/format.h>

#include "host_shim/cli/command_line.h"
#include "host_shim/colour/display_picture.h"
#include "host_shim/pictures/picture_io.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

constexpr double kCodeRounding = 1e-3;  // codes are floats here

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
    const fs::path own = options.scene.stem().string() + ".exr";
    if (!options.part.empty() || options.outputs != std::vector<fs::path>{own}) refuse("-o");
}

Options parsedOptions(const Suite& suite, const SuiteScene& scene) {
    std::vector<std::string> words{scene.scene.string()};
    words.insert(words.end(), scene.options.begin(), scene.options.end());
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
        throw HostError(ExitCode::kBadInput, fmt::format("{}: scene '{}': {}", suite.file.string(),
                                                         scene.name, error.what()));
    }
}

std::string list(const std::vector<fs::path>& files) {
    std::string text;
    for (const fs::path& file : files) text += (text.empty() ? "" : ", ") + file.string();
    return text;
}

// What today's config makes of the stored scene-linear picture is the stored display picture: no
// noise is in that.
void compareTransform(const DisplayPicture& wanted, const DisplayPicture& stored, double codeLimit,
                      Verdict& verdict) {
    const DisplayDifference difference = compareDisplay(stored, wanted);
    if (difference.most > codeLimit + kCodeRounding)
        verdict.findings.push_back(
            {"display transform",
             fmt::format("display and view make another picture of the stored one: {} (limit {:g})",
                         describe(difference), codeLimit)});
}

void compareDisplays(const Suite& suite, const SceneOutcome& outcome, const fs::path& png,
                     const Reference& reference, Verdict& verdict) {
    const SuiteScene& scene = *outcome.scene;
    const DisplayPicture stored = asCodes(readDisplayPicture(referenceFiles(suite, scene).display));
    const DisplayPicture picture = asCodes(readDisplayPicture(png));
    if (stored.width != picture.width || stored.height != picture.height) {
        verdict.findings.push_back(
            {"size", fmt::format("display picture {}x{} in place of {}x{}", picture.width,
                                 picture.height, stored.width, stored.height)});
        return;
    }
    compareTransform(asCodes(SceneDisplay(suite, scene).shown(*outcome.stored)), stored,
                     scene.codeLimit, verdict);
    const DisplayDifference difference = compareDisplay(stored, picture);
    if (verdict.isSameBuild) {
        if (difference.most > scene.codeLimit + kCodeRounding)
            verdict.findings.push_back(
                {"display codes",
                 fmt::format("{} (limit {:g})", describe(difference), scene.codeLimit)});
        return;
    }
    compareCodes(picture, reference, scene.codeLimit, verdict);
    if (difference.visiblePixels > reference.visibleLimit)
        verdict.findings.push_back(
            {"visible", fmt::format("{} pixels visibly different (limit {})",
                                    difference.visiblePixels, reference.visibleLimit)});
}

}  // namespace

const char* nameOf(SceneOutcome::Status status) {
    switch (status) {
        case SceneOutcome::Status::kSame:
            return "same bits";
        case SceneOutcome::Status::kWithinNoise:
            return "within noise";
        case SceneOutcome::Status::kDifferent:
            return "DIFFERENT";
        case SceneOutcome::Status::kMissing:
            return "NO REFERENCE";
        case SceneOutcome::Status::kFailed:
            return "FAILED";
        case SceneOutcome::Status::kOutOfTime:
            break;
    }
    return "OUT OF TIME";
}

ReferenceFiles referenceFiles(const Suite& suite, const SuiteScene& scene) {
    const auto file = [&](const char* ending) { return suite.references / (scene.name + ending); };
    return {file(".exr"), file(".png"), file(".json")};
}

void checkOptions(const Suite& suite, const SuiteScene& scene) {
    parsedOptions(suite, scene);
    if (!scene.hasDisplay) return;
    try {
        SceneDisplay(suite, scene);
    } catch (const HostError& error) {
        throw HostError(error.code(), fmt::format("{}: scene '{}': {}", suite.file.string(),
                                                  scene.name, error.what()));
    }
}

SceneDisplay::SceneDisplay(const Suite& suite, const SuiteScene& scene) {
    const Options options = parsedOptions(suite, scene);
    m_transform = ColourPipeline(options.colour).displayTransform();
    m_transform->setExposureStops(options.exposure.stops);
}

std::optional<SceneDisplay> findDisplay(const Suite& suite, const SuiteScene& scene) {
    try {
        return SceneDisplay(suite, scene);
    } catch (const HostError&) {
        return std::nullopt;
    }
}

fs::path scenePage(const fs::path& folder, const SuiteScene& scene) {
    return folder / "scene" / (scene.name + ".html");
}

fs::path reportPage(const fs::path& folder, const SuiteScene& scene) {
    return folder / "render" / (scene.name + ".html");
}

DisplayPicture SceneDisplay::shown(const Picture& picture) const {
    return makeDisplayPicture(picture, *m_transform).picture;
}

void checkScene(const Suite& suite, const fs::path& exr, const fs::path& png,
                SceneOutcome& outcome) {
    const ReferenceFiles files = referenceFiles(suite, *outcome.scene);
    std::vector<fs::path> missing;
    std::error_code ignored;
    for (const fs::path& file : {files.picture, files.numbers, files.display})
        if (!fs::exists(file, ignored) && (outcome.scene->hasDisplay || file != files.display))
            missing.push_back(file);
    outcome.picture = readExr(exr);
    if (!missing.empty()) {
        outcome.status = SceneOutcome::Status::kMissing;
        outcome.findings.push_back({"reference", list(missing) + ": missing (--update makes it)"});
        return;
    }
    const Reference reference = readReference(files.numbers);
    if (!reference.reasons.empty()) outcome.because = reference.reasons.back().because;
    outcome.stored = readExr(files.picture);
    Verdict verdict = comparePictures(*outcome.stored, *outcome.picture, reference);
    if (verdict.findings.empty() && outcome.scene->hasDisplay)
        compareDisplays(suite, outcome, png, reference, verdict);
    outcome.findings = verdict.findings;
    outcome.shareOfLimit = verdict.shareOfLimit;
    outcome.seenChange = verdict.seenChange;
    outcome.status = !verdict.findings.empty() ? SceneOutcome::Status::kDifferent
                     : verdict.hasSameBits     ? SceneOutcome::Status::kSame
                                               : SceneOutcome::Status::kWithinNoise;
}

}  // namespace pm::host
