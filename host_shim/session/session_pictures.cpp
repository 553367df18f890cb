// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// A Session whose render has ended: its pictures are written and compared.
#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <vector>

#include "host_shim/colour/error_codes.h"
#include "host_shim/folders/own_folder.h"
#include "host_shim/pictures/compare.h"
#include "host_shim/pictures/display_compare.h"
#include "host_shim/process/interrupt.h"
#include "host_shim/process/outputs.h"
#include "host_shim/process/side_work.h"
#include "host_shim/render/picture_assembly.h"
#include "host_shim/report/report_command.h"
#include "host_shim/session/session.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

constexpr int kErrorLimitPassed = 6;

}  // namespace

// Of a render that ended before its time.
void Session::throwStopped(PmrStatus status) {
    throwIfInterrupted();
    throw HostError(static_cast<ExitCode>(exitCodeOf(status)), "the render was cancelled");
}

int Session::finishPhotons(PmrStatus status) {
    if (status != PMR_OK) throwStopped(status);
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
    std::vector<std::future<Written>> written = beginOutputs(picture, complete, display);
    if (complete && display) m_statistics.seenError = seenError(source, picture, *display);
    try {
        endOutputs(picture, written);
    } catch (...) {
        report();
        throw;
    }
    report();
    m_statistics.phaseSeconds["writePicturesSeconds"] = m_log.elapsedSeconds() - start;
    if (!complete) throwStopped(status);
    noteEnd();
    lookForLight(picture);
    if (m_options.onlyPixel) printPixel(picture);
    if (m_displayReference) return compareWithDisplayReference(picture, display.value());
    return m_reference ? compareWithReference(picture) : 0;
}

// All is written.
void Session::noteEnd() {
    if (!m_options.part.empty()) {
        m_statistics.outputs.push_back(m_options.part.string());
        m_log.info("wrote " + m_options.part.string());
    }
    // Only now that all is written nothing is lost without it.
    std::error_code ignored;
    constexpr std::string_view kPieceBegins = "pmpiece1";  // somebody else's may be there by now
    if (!m_options.checkpoint.empty() && !m_options.keepCheckpoint &&
        beginsWith(fs::canonical(m_options.checkpoint, ignored), kPieceBegins))
        fs::remove(m_options.checkpoint, ignored);
    m_statistics.stopReason = m_statistics.libraryStopReason();
    if (m_statistics.stopReason == "error target" || m_statistics.stopReason == "time limit")
        m_log.info("stopped by the " + m_statistics.stopReason);
}

void Session::warnOfClamped(const fs::path& file, const ExrReport& report) {
    if (report.clampedToHalf > 0)
        warn(Warning::kOutput, fmt::format("{}: {} values are beyond half's 65504 and clamped",
                                           file.string(), report.clampedToHalf));
}

std::string Session::errorText() const {
    const auto estimate = m_statistics.estimatedRelMse();
    if (!estimate) return "";
    return fmt::format(
        ", estimated relMSE {:.2e}{} (noise and bias, from what passes differ by{}): {}", *estimate,
        errorScaleText(m_statistics.errorScaleStops().value_or(0)), m_statistics.estimateDoubts(),
        m_statistics.errorWords());
}

// Of rows enough to know shares of the pixels well; nothing where no error is told.
std::optional<SeenError> Session::seenError(const PictureSource& source, const Picture& picture,
                                            const DisplayTransform& display) const {
    constexpr std::int64_t kMostPixels = 150'000;
    const PixelRect& window = picture.dataWindow;
    if (!m_statistics.estimatedRelMse() || window.empty()) return std::nullopt;
    const auto bias = m_statistics.estimatedBias();
    ErrorCodes codes(display, bias.most, bias.offset);
    const auto step = static_cast<std::int32_t>(1 + (window.area() - 1) / kMostPixels);
    const auto width = static_cast<std::size_t>(window.width());
    std::vector<float> values(3 * width), halfDifferences(values.size());
    const std::array<const Channel*, 3> beauty{picture.find("R"), picture.find("G"),
                                               picture.find("B")};
    for (std::int32_t y = window.y0; y < window.y1; y += step) {
        const std::size_t first = static_cast<std::size_t>(y - window.y0) * width;
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] = beauty[i % 3]->values[first + i / 3];
        source.readPixels({window.x0, y, window.x1, y + 1}, "halfdiff", halfDifferences.data());
        codes.add(values, halfDifferences);
    }
    SeenError seen = codes.result();
    seen.isLowerBound = bias.isLowerBound;
    return seen;
}

void Session::writeOutputs(const Picture& picture, const std::optional<DisplayTransform>& display) {
    std::vector<std::future<Written>> written = beginOutputs(picture, true, display);
    endOutputs(picture, written);
}

// Each in a thread of its own: packing takes longer than all else that comes after a render.
std::vector<std::future<Session::Written>> Session::beginOutputs(
    const Picture& picture, bool complete, const std::optional<DisplayTransform>& display) const {
    std::vector<std::future<Written>> written;
    for (const fs::path& output : m_options.outputs)
        written.push_back(
            doBeside(m_options.threads != 1,
                     [this, &picture, &display, file = complete ? output : partialName(output)] {
                         Written done{.file = file};
                         try {
                             write(picture, display, done);
                         } catch (const HostError& fault) {
                             done.failure = fault;
                         }
                         return done;
                     }));
    return written;
}

void Session::endOutputs(const Picture& picture, std::vector<std::future<Written>>& written) {
    const std::string error = errorText();
    // One that fails must not take the others with it.
    std::optional<HostError> failure;
    for (std::future<Written>& one : written) {
        const Written done = one.get();
        if (done.failure) {
            if (failure) m_log.message(Level::kError, failure->what());
            failure = done.failure;
            continue;
        }
        tellOf(done, picture);
        m_statistics.outputs.push_back(done.file.string());
        m_log.info(fmt::format("wrote {}{}", done.file.string(), error));
    }
    if (failure) throw *failure;
}

void Session::write(const Picture& picture, const std::optional<DisplayTransform>& display,
                    Written& done) const {
    if (!isDisplayReferred(pictureFormat(done.file))) {
        done.exr = writeLinearPicture(done.file, picture, {m_options.exrHalf});
        return;
    }
    done.shown = makeDisplayPicture(picture, display.value());
    DisplayWriteOptions how;
    how.exposure = exposureText(m_exposure);
    writeDisplayPicture(done.file, done.shown->picture, how);
}

void Session::tellOf(const Written& done, const Picture& picture) {
    warnOfClamped(done.file, done.exr);
    if (!done.shown) return;
    const auto bad = done.shown->cleaning.nanCount + done.shown->cleaning.infiniteCount;
    if (bad > 0)
        warn(Warning::kOutput,
             fmt::format("{}: {} values were not finite", done.file.string(), bad));
    if (!m_isIncomplete) lookForDarkness(done.file, picture, done.shown->picture);
}

int Session::compareWithReference(const Picture& picture) {
    // Of two pictures of one scene in unlike units the error is that of the reference's.
    const std::int32_t scale =
        errorScaleOf(*m_reference).value_or(m_statistics.errorScaleStops().value_or(0));
    const ErrorReport report = compareRelMse(*m_reference, picture, errorOffset(scale));
    if (!report.relMse) {
        print("relMSE nan\n");
        warn(Warning::kOutput,
             fmt::format("{} values of the picture and {} of the reference are not finite",
                         report.badInPicture, report.badInReference));
    } else {
        print(fmt::format("relMSE {}{}\n", *report.relMse, errorScaleText(scale)));
        m_statistics.referenceRelMse = report.relMse;
        m_statistics.referenceErrorScale = scale;
    }
    return judgeAgainstLimit("relMSE", report.relMse);
}

int Session::compareWithDisplayReference(const Picture& picture, const DisplayTransform& display) {
    const DisplayResult shown = makeDisplayPicture(picture, display);
    const DisplayDifference difference =
        compareDisplay(asCodes(*m_displayReference), asCodes(shown.picture));
    print(fmt::format("code difference {}\n", describe(difference)));
    m_statistics.referenceCodes = difference;
    const bool isBad = shown.cleaning.nanCount + shown.cleaning.infiniteCount > 0;
    return judgeAgainstLimit("rms code difference",
                             isBad ? std::nullopt : std::optional(difference.rms));
}

int Session::judgeAgainstLimit(const std::string& name, std::optional<double> value) {
    if (!m_options.errorLimit) return 0;
    if (value && *value <= *m_options.errorLimit) return 0;
    m_statistics.stopReason = "error limit";
    m_statistics.error =
        value ? fmt::format("{} {} is above the limit {}", name, *value, *m_options.errorLimit)
              : "a value is not finite";
    m_log.message(Level::kError, m_statistics.error);
    return kErrorLimitPassed;
}

int Session::judgeSamples() {
    const auto bad = m_statistics.badSamples();
    if (!bad) return 0;
    Arguments words = ofOnePixel(m_statistics.commandLine);
    words.insert(words.end(), {"--only-pixel", fmt::format("{},{}", bad->x, bad->y)});
    if (m_options.crop) {  // the pixel may be beyond the frame
        const PixelRect& crop = *m_options.crop;
        words.insert(words.end(),
                     {"--crop", fmt::format("{},{},{},{}", crop.x0, crop.y0, crop.x1, crop.y1)});
    }
    const std::string text = fmt::format("samples that are no light count as black: {}; alone: {}",
                                         bad->text, shellCommand(words));
    if (!m_options.strict) {
        warn(Warning::kBadSamples, text);
        return 0;
    }
    m_statistics.stopReason = "bad samples";
    m_statistics.error = text;
    m_log.message(Level::kError, text);
    return static_cast<int>(ExitCode::kBadInput);
}

void Session::print(const std::string& result) {
    std::fputs(result.c_str(), stdout);
    m_results += result;
}

void Session::printPixel(const Picture& picture) const {
    for (const Channel& channel : picture.channels) {
        std::fputs(fmt::format("{} {}\n", channel.name, channel.values.at(0)).c_str(), stdout);
    }
    std::fflush(stdout);
}

}  // namespace pm::host
