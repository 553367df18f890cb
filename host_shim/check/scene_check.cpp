// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/check/scene_check.h"

#include <fmt/format.h>

#include <algorithm>

#include "host_shim/pictures/picture_io.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

constexpr double kCodeRounding = 1e-3;  // codes are floats here

std::string list(const std::vector<fs::path>& files) {
    std::string text;
    for (const fs::path& file : files) text += (text.empty() ? "" : ", ") + file.string();
    return text;
}

// A new display picture against the stored one. wanted: what today's config makes of the stored
// scene-linear picture, where no noise is in the way.
struct DisplayCheck {
    const DisplayPicture &stored, &picture, &wanted;
    const DisplayNoise& noise;
    double codeLimit{};
    std::string view;  // "", "view NAME: "
};

void compareDisplays(const DisplayCheck& check, const PixelRect& window, Verdict& verdict) {
    const auto found = [&](const char* measure, const std::string& text) {
        verdict.findings.push_back({measure, check.view + text});
    };
    const DisplayPicture stored = asCodes(check.stored), picture = asCodes(check.picture);
    if (stored.width != picture.width || stored.height != picture.height)
        return found("size", fmt::format("display picture {}x{} in place of {}x{}", picture.width,
                                         picture.height, stored.width, stored.height));
    const double limit = check.codeLimit + kCodeRounding;
    const DisplayDifference transform = compareDisplay(stored, asCodes(check.wanted));
    if (transform.most > limit)
        found(
            "display transform",
            fmt::format("display and view make another picture of the stored one: {} (limit {:g})",
                        describe(transform), check.codeLimit));
    const DisplayDifference difference = compareDisplay(stored, picture);
    if (verdict.isSameBuild) {
        if (difference.most > limit)
            found("display codes",
                  fmt::format("{} (limit {:g})", describe(difference), check.codeLimit));
        return;
    }
    compareCodes(picture, window, check.noise, check.codeLimit, check.view, verdict);
    if (difference.visiblePixels > check.noise.visibleLimit)
        found("visible", fmt::format("{} pixels visibly different (limit {})",
                                     difference.visiblePixels, check.noise.visibleLimit));
}

void compareAllDisplays(const Suite& suite, const SceneOutcome& outcome, const fs::path& png,
                        const Reference& reference, Verdict& verdict) {
    const SuiteScene& scene = *outcome.scene;
    const ReferenceFiles files = referenceFiles(suite, scene);
    if (scene.hasDisplay) {
        const DisplayPicture stored = readDisplayPicture(files.display),
                             picture = readDisplayPicture(png),
                             wanted = SceneDisplay(suite, scene).shown(*outcome.stored);
        compareDisplays({stored, picture, wanted, reference.display, scene.codeLimit, ""},
                        reference.window, verdict);
    }
    for (std::size_t i = 0; i < scene.views.size(); ++i) {
        const SuiteView& view = scene.views[i];
        const SceneDisplay display(suite, scene, &view);
        const auto noise = reference.views.find(view.name);
        if (noise == reference.views.end()) {
            verdict.findings.push_back(
                {"reference", fmt::format("knows no view {}; --update makes it", view.name)});
            continue;
        }
        const DisplayPicture stored = readDisplayPicture(files.views[i]),
                             picture = display.shown(*outcome.picture),
                             wanted = display.shown(*outcome.stored);
        compareDisplays({stored, picture, wanted, noise->second, scene.codeLimit,
                         fmt::format("view {}: ", view.name)},
                        reference.window, verdict);
    }
}

bool isMissing(const ReferenceFiles& files, SceneOutcome& outcome) {
    std::vector<fs::path> missing;
    std::error_code ignored;
    const auto want = [&](const fs::path& file) {
        if (!fs::exists(file, ignored)) missing.push_back(file);
    };
    want(files.picture);
    want(files.numbers);
    if (outcome.scene->hasDisplay) want(files.display);
    for (const fs::path& view : files.views) want(view);
    // References of an earlier version have none.
    if (missing.empty() && readReference(files.numbers).pairs) want(files.noise);
    if (missing.empty()) return false;
    outcome.status = SceneOutcome::Status::kMissing;
    outcome.findings.push_back({"reference", list(missing) + ": missing (--update makes it)"});
    return true;
}

std::string pairText(const Reference& reference, const Verdict& verdict) {
    if (!reference.pairs)
        return "the reference has no twins, so regions are compared by the spread of seeds alone; "
               "--update makes them";
    if (!verdict.correlation)
        return "one of the pictures has no noise, so regions are compared by the spread of seeds";
    return fmt::format(
        "the noise is not the reference's (correlation {:.2f}, above {:g} it would "
        "be), so regions are compared by the spread of seeds",
        *verdict.correlation, kPairedCorrelation);
}

// What the render and its scene say of themselves.
void compareFacts(const Reference& reference, const RenderFacts& facts, Verdict& verdict,
                  SceneOutcome& outcome) {
    const std::string changed =
        reference.inputs ? differences(*reference.inputs, facts.inputs) : std::string();
    if (verdict.isSameBuildOfAnotherScene && !verdict.hasSameBits) {
        const auto input = std::ranges::find(verdict.findings, "input", &Finding::measure);
        if (input != verdict.findings.end())
            input->text += !reference.inputs ? "; of what, the reference doesn't know"
                           : changed.empty() ? "; of nothing that has a name"
                                             : "; changed are: " + changed;
    } else if (!changed.empty()) {
        outcome.notes.push_back("of the input has changed: " + changed);
    }
    if (!verdict.isSameBuild && !verdict.hasSameBits && !verdict.isPaired)
        outcome.notes.push_back(pairText(reference, verdict));
    if (!reference.warnings) return;
    for (const std::string& text : newWarnings(*reference.warnings, facts.warnings))
        verdict.findings.push_back({"new warning", text});
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
    ReferenceFiles files{file(".exr"), file(".png"), file(".json"), file(".noise.exr"), {}};
    for (const SuiteView& view : scene.views)
        files.views.push_back(suite.references / (scene.name + "." + view.name + ".png"));
    return files;
}

std::vector<fs::path> ReferenceFiles::pictures() const {
    std::vector<fs::path> all{picture, display, noise};
    all.insert(all.end(), views.begin(), views.end());
    return all;
}

fs::path scenePage(const fs::path& folder, const SuiteScene& scene) {
    return folder / "scene" / (scene.name + ".html");
}

fs::path reportPage(const fs::path& folder, const SuiteScene& scene) {
    return folder / "render" / (scene.name + ".html");
}

std::string seenText(const SceneOutcome& outcome) {
    return outcome.seenChange > 0
               ? fmt::format("regions from {:.2g} % on", 100 * outcome.seenChange)
               : std::string();
}

std::vector<std::string> remarksOf(const SceneOutcome& outcome) {
    std::vector<std::string> lines;
    if (outcome.isCoarse())
        lines.push_back(
            fmt::format("COARSE: a change is found from {:.2g} % of a region on; more "
                        "--passes find less",
                        100 * outcome.seenChange));
    for (const std::string& text : outcome.warnings) lines.push_back("warning: " + text);
    for (const std::string& text : outcome.notes) lines.push_back("note: " + text);
    return lines;
}

std::string noiseText(const SceneOutcome& outcome) {
    const std::string seen = seenText(outcome);
    return fmt::format("furthest region at {:.0f} % of its limit{}{}", 100 * outcome.shareOfLimit,
                       seen.empty() ? "" : "; found are ", seen);
}

void checkScene(const Suite& suite, const RenderedFiles& render, SceneOutcome& outcome) {
    const ReferenceFiles files = referenceFiles(suite, *outcome.scene);
    outcome.picture = readExr(render.exr);
    const RenderFacts facts =
        readFacts(render.statistics, render.log, *outcome.picture, suite.folder);
    outcome.warnings = facts.warnings;
    outcome.errorWords = facts.errorWords;
    if (isMissing(files, outcome)) return;
    const Reference reference = readReference(files.numbers);
    if (!reference.reasons.empty()) outcome.because = reference.reasons.back().because;
    outcome.stored = readExr(files.picture);
    std::optional<Picture> noise;
    if (reference.pairs) noise = readExr(files.noise);
    Verdict verdict =
        comparePictures(*outcome.stored, *outcome.picture, reference, noise ? &*noise : nullptr);
    if (verdict.findings.empty())
        compareAllDisplays(suite, outcome, render.png, reference, verdict);
    compareFacts(reference, facts, verdict, outcome);
    outcome.findings = verdict.findings;
    outcome.shareOfLimit = verdict.shareOfLimit;
    outcome.seenChange = verdict.seenChange;
    outcome.status = !verdict.findings.empty() ? SceneOutcome::Status::kDifferent
                     : verdict.hasSameBits     ? SceneOutcome::Status::kSame
                                               : SceneOutcome::Status::kWithinNoise;
}

}  // namespace pm::host
