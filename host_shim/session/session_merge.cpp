// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Session::merge: pm_host merge PART... -o FILE.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "host_shim/cli/option_values.h"
#include "host_shim/colour/display_picture.h"
#include "host_shim/pictures/picture_io.h"
#include "host_shim/process/interrupt.h"
#include "host_shim/process/outputs.h"
#include "host_shim/render/merge_run.h"
#include "host_shim/render/picture_assembly.h"
#include "host_shim/session/session.h"
#include "host_shim/session/session_files.h"

namespace pm::host {
namespace {

// Takes from the parts what a command line says of a render.
void takeFrame(const MergeRun& run, Options& options) {
    constexpr std::int32_t kMost = 1 << 24;
    const auto pixels = [&](const char* setting) {
        return static_cast<std::int32_t>(integerValue(setting, run.settingText(setting), 1, kMost));
    };
    options.width = pixels("width");
    options.height = pixels("height");
    const std::string crop = run.settingText("crop");
    if (!crop.empty()) options.crop = cropValue("crop", crop);
}

// The first few of the lines A:B, for a message.
std::string shownRanges(const std::string& lines) {
    constexpr std::ptrdiff_t kShown = 8;
    const auto count = std::ranges::count(lines, '\n');
    std::size_t end = 0;
    for (std::ptrdiff_t i = 0; i < std::min(count, kShown); ++i) end = lines.find('\n', end) + 1;
    std::string text = lines.substr(0, end > 0 ? end - 1 : lines.size());
    std::ranges::replace(text, '\n', ' ');
    return count > kShown ? text + fmt::format(" and {} more", count - kShown) : text;
}

}  // namespace

// The same bits are promised among processors of one vendor.
void Session::warnOfVendors(const std::vector<std::string>& vendors) {
    if (vendors.size() > 1)
        warn(Warning::kFarm,
             fmt::format("merge: the parts were made by processors of unlike vendors ({}); the "
                         "picture is right, but need not have the bytes of a render on one of them",
                         fmt::join(vendors, ", ")));
}

void Session::checkBeforeMerging() {
    checkNotInputs(allOutputs(m_options), inputsOf(m_options, nullptr));
    checkOutputs({}, otherOutputs(m_options), m_options.makeOutputPath);
    m_mayWriteStatistics = true;
    checkOutputs(m_options.outputs, otherOutputs(m_options), m_options.makeOutputPath);
    if (!m_options.log.empty()) m_log.openFile(m_options.log);
}

int Session::merge() {
    checkBeforeMerging();
    const Plugin plugin(m_options.plugin);
    const PluginContext context(plugin, contextDesc(plugin));
    MergeRun run(context);
    phase("mergeSeconds", [&] { run.add(m_options.merge, m_log); });
    if (const std::string missing = run.missing(); !missing.empty()) {
        std::fputs(missing.c_str(), stdout);
        throw HostError(ExitCode::kBadInput,
                        fmt::format("merge: buckets are missing: {}; make them with --buckets A:B "
                                    "-o NAME.pmpart",
                                    shownRanges(missing)));
    }
    takeFrame(run, m_options);
    const ColourPipeline colour = colourOfParts(run.settingText("hostIdentity"), m_options.colour);
    m_statistics.colourConfig = colour.configName();
    m_statistics.renderingSpace = colour.renderingSpace();
    if (!m_options.reference.empty()) readReference(colour);
    std::optional<DisplayTransform> display;
    if (wantsDisplay(m_options)) {
        display = colour.displayTransform();
        exposeAsParts(run.settingText("hostNote"), colour, *display);
    }
    m_statistics.library = run.statistics();
    warnOfVendors(m_statistics.processorVendors());
    return finish(run, PMR_OK, colour, display);
}

EmbeddedPicture Session::writeIncomplete(const MergeRun& parts, bool isShown) {
    constexpr std::size_t kMostBytes = std::size_t{2} << 20;  // in a page
    m_isIncomplete = true;
    takeFrame(parts, m_options);
    const ColourPipeline colour =
        colourOfParts(parts.settingText("hostIdentity"), m_options.colour);
    std::optional<DisplayTransform> display;
    if (isShown || wantsDisplay(m_options)) {
        display = colour.displayTransform();
        exposeAsParts(parts.settingText("hostNote"), colour, *display);
    }
    const Picture picture = assemblePicture(parts, m_options, colour, false);
    writeOutputs(picture, display);  // under their own names
    if (!isShown) return {};
    return embedded(makeDisplayPicture(picture, *display).picture, kMostBytes);
}

}  // namespace pm::host
