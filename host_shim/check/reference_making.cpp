// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/check/reference_making.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <iterator>
#include <memory>
#include <utility>

#include "host_shim/pictures/display_compare.h"
#include "host_shim/pictures/finished_file.h"
#include "host_shim/pictures/picture_io.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

constexpr double kLeastPixelLimit = 7.0;
constexpr double kBeyondOwn = 1.5;  // of what the renders are apart
constexpr int kVisibleBeyondOwn = 2;
constexpr std::int64_t kPixelsOfOneVisible = 1000;

std::string bytesOf(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    if (!stream) throw HostError(ExitCode::kFile, fmt::format("{}: can't be read", file.string()));
    return bytes;
}

void checkFinite(const Picture& picture) {
    for (const Channel& channel : picture.channels)
        if (channel.isColour &&
            !std::ranges::all_of(channel.values, [](float value) { return std::isfinite(value); }))
            throw HostError(
                ExitCode::kBadInput,
                fmt::format("a reference can't be made: {} is not finite somewhere", channel.name));
}

std::vector<RegionSpread> regionsOf(const PixelRect& window, const std::vector<Picture>& pictures) {
    std::vector<RegionSpread> spreads;
    for (const std::int32_t side : kRegionSides) {
        std::vector<std::vector<double>> means;
        for (const Picture& picture : pictures)
            means.push_back(RegionGrid(window, side).means(beautyOf(picture)));
        spreads.push_back(spreadOf(window, side, means));
    }
    return spreads;
}

DisplayNoise displayNoiseOf(const PixelRect& window, const std::vector<DisplayPicture>& pictures) {
    DisplayNoise noise;
    for (const std::int32_t side : kRegionSides) {
        std::vector<std::vector<double>> means;
        for (const DisplayPicture& picture : pictures)
            means.push_back(codeMeans(picture, window, side));
        noise.codes.push_back(spreadOf(window, side, means));
    }
    for (const DisplayPicture& picture : pictures)
        noise.visibleLimit =
            std::max(noise.visibleLimit, compareDisplay(pictures.front(), picture).visiblePixels);
    noise.visibleLimit =
        kVisibleBeyondOwn * noise.visibleLimit + window.area() / kPixelsOfOneVisible;
    return noise;
}

std::vector<Picture> picturesOf(const std::vector<RenderedFiles>& renders) {
    std::vector<Picture> pictures;
    for (const RenderedFiles& render : renders) {
        pictures.push_back(readExr(render.exr));
        checkFinite(pictures.back());
    }
    return pictures;
}

PairSpread pairsOf(const Picture& kept, const std::vector<Picture>& twins) {
    const RegionGrid grid(kept.dataWindow, kPairSide);
    std::vector<std::vector<double>> means;
    for (const Picture& twin : twins) means.push_back(grid.means(beautyOf(twin)));
    return pairSpreadOf(grid.means(beautyOf(kept)), means);
}

// Warnings of any seed are known ones: some come by chance.
void addFacts(const std::vector<RenderedFiles>& seeds, const std::vector<Picture>& pictures,
              const fs::path& folder, Reference& reference) {
    reference.warnings.emplace();
    for (std::size_t i = 0; i < seeds.size(); ++i) {
        const RenderFacts facts = readFacts(seeds[i].statistics, seeds[i].log, pictures[i], folder);
        if (!reference.inputs) reference.inputs = facts.inputs;
        for (const std::string& text : newWarnings(*reference.warnings, facts.warnings))
            reference.warnings->push_back(text);
    }
}

std::string today() {
    return fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time(nullptr)));
}

std::string versionOf(const Picture& picture) {
    const auto found = picture.attributes.find("pm:version");
    const auto* text =
        found == picture.attributes.end() ? nullptr : std::get_if<std::string>(&found->second);
    return text == nullptr ? "" : *text;
}

}  // namespace

MadeReference makeReference(const Suite& suite, const SuiteScene& scene,
                            const std::vector<RenderedFiles>& seeds,
                            const std::vector<RenderedFiles>& twins, const std::string& because) {
    const fs::path before = referenceFiles(suite, scene).numbers;
    const std::vector<Picture> pictures = picturesOf(seeds);
    const Picture& kept = pictures.front();
    MadeReference made;
    Reference& reference = made.reference;
    if (fs::exists(before)) reference.reasons = readReference(before).reasons;
    reference.reasons.push_back({because, today(), versionOf(kept)});
    reference.window = kept.dataWindow;
    reference.regions = regionsOf(reference.window, pictures);
    reference.pixelLimit = kLeastPixelLimit;
    for (const Picture& picture : pictures)
        reference.pixelLimit =
            std::max(reference.pixelLimit, kBeyondOwn * std::abs(furthestPixel(kept, picture).z));
    reference.pairs = pairsOf(kept, picturesOf(twins));
    std::vector<const Picture*> others;
    for (std::size_t i = 1; i < pictures.size(); ++i) others.push_back(&pictures[i]);
    made.noise = pixelNoiseOf(others);
    addFacts(seeds, pictures, suite.folder, reference);
    if (!seeds.front().png.empty()) {
        std::vector<DisplayPicture> shown;
        for (const RenderedFiles& render : seeds) shown.push_back(readDisplayPicture(render.png));
        reference.display = displayNoiseOf(reference.window, shown);
    }
    for (const SuiteView& view : scene.views) {
        const SceneDisplay display(suite, scene, &view);
        std::vector<DisplayPicture> shown;
        for (const Picture& picture : pictures) shown.push_back(display.shown(picture));
        reference.views[view.name] = displayNoiseOf(reference.window, shown);
        made.views.push_back(std::move(shown.front()));
    }
    return made;
}

void storeReference(const RenderedFiles& kept, const MadeReference& made,
                    const ReferenceFiles& files) {
    const fs::path noise = kept.exr.string() + ".noise.exr";
    writeExr(noise, made.noise);
    std::vector<std::pair<fs::path, std::string>> contents{{files.picture, bytesOf(kept.exr)},
                                                           {files.noise, bytesOf(noise)},
                                                           {files.numbers, textOf(made.reference)}};
    fs::remove(noise);
    for (std::size_t i = 0; i < made.views.size(); ++i) {
        const fs::path view = kept.exr.string() + ".view.png";
        writeDisplayPicture(view, made.views[i]);
        contents.emplace_back(files.views[i], bytesOf(view));
        fs::remove(view);
    }
    if (!kept.png.empty()) contents.emplace_back(files.display, bytesOf(kept.png));
    // All or none: only what is on the disk as a whole takes the names.
    std::vector<std::unique_ptr<FinishedFile>> written;
    for (const auto& [file, bytes] : contents) {
        written.push_back(std::make_unique<FinishedFile>(file));
        written.back()->write(bytes);
    }
    for (const auto& file : written) file->commit();
}

}  // namespace pm::host
