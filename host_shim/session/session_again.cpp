// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// A Session whose files are wanted once more, for a frame that is the same render.
#include <fmt/format.h>

#include <cstdio>
#include <fstream>
#include <string_view>

#include "host_shim/log/guarded.h"
#include "host_shim/pictures/finished_file.h"
#include "host_shim/process/interrupt.h"
#include "host_shim/process/outputs.h"
#include "host_shim/session/session.h"
#include "host_shim/session/session_files.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

// Files that a render leaves and that hold nothing of their own names.
std::vector<fs::path> filesToCopy(const Options& options) {
    std::vector<fs::path> files = options.outputs;
    if (!options.part.empty()) files.push_back(options.part);
    if (options.photonsOnly) files.push_back(options.photonMap);
    if (options.keepCheckpoint) files.push_back(options.checkpoint);
    return files;
}

void copyWhole(const fs::path& from, const fs::path& to) {
    constexpr std::size_t kPiece = 1 << 20;
    std::ifstream stream(from, std::ios::binary);
    FinishedFile finished(to);
    std::string piece(kPiece, '\0');
    while (stream) {
        throwIfInterrupted();
        stream.read(piece.data(), kPiece);
        finished.write(
            std::string_view(piece).substr(0, static_cast<std::size_t>(stream.gcount())));
    }
    if (!stream.eof() || stream.bad())
        throw HostError(ExitCode::kFile, fmt::format("{}: can't be read to be copied to {}",
                                                     from.string(), to.string()));
    finished.commit();
}

}  // namespace

bool Session::canWriteAgain(const Options& frame) const {
    std::error_code ignored;
    // What is there may be somebody else's, or what a resumed render goes on from: the library
    // asks.
    const auto isThere = [&](const fs::path& file) {
        return !file.empty() && fs::exists(fs::symlink_status(file, ignored));
    };
    return m_statistics.exitCode == 0 && !m_options.explain && !m_options.onlyPixel &&
           !m_options.writeSidecar && !isThere(frame.checkpoint) &&
           !(frame.photonsOnly && isThere(frame.photonMap));
}

// One that fails must not take the others with it.
void Session::copyFiles(const Options& frame) {
    const std::vector<fs::path> from = filesToCopy(m_options), to = filesToCopy(frame);
    std::optional<HostError> failure;
    m_statistics.outputs.clear();
    for (std::size_t i = 0; i < from.size(); ++i) {
        try {
            copyWhole(from[i], to[i]);
        } catch (const HostError& fault) {
            if (failure) m_log.message(Level::kError, failure->what());
            failure = fault;
            continue;
        }
        if (to[i] == frame.checkpoint) continue;
        m_statistics.outputs.push_back(to[i].string());
        m_log.info("wrote " + to[i].string());
    }
    if (failure) throw *failure;
}

void Session::writeFilesAgain(const Options& frame) {
    checkNotInputs(allOutputs(frame), m_inputs);
    checkOutputs(frame.outputs, otherOutputs(frame), frame.makeOutputPath);
    m_mayWriteStatistics = true;
    if (!frame.log.empty()) m_log.openFile(frame.log);
    m_log.info(fmt::format("the same render as frame {}", *m_statistics.sameAsFrame));
    copyFiles(frame);
    if (!frame.bucketTimes.empty())
        writeFinishedFile(frame.bucketTimes, m_report.bucketTimes().csv());
    std::fputs(m_results.c_str(), stdout);
}

int Session::writeAgain(const Options& frame, std::int64_t ofFrame) {
    const Statistics ofRender = m_statistics;
    noteCommandLine(frame);
    m_statistics.sameAsFrame = ofFrame;
    m_statistics.stopReason = "failed";
    m_mayWriteStatistics = false;
    m_statistics.exitCode = guarded(
        m_log,
        [&] {
            writeFilesAgain(frame);
            m_statistics.stopReason = ofRender.stopReason;
            return 0;
        },
        &m_statistics.error);
    // All else is the same, or as the copies of a fetched scene have changed it.
    m_options.statistics = frame.statistics;
    m_options.report = frame.report;
    const int written = writePages();
    const int code = m_statistics.exitCode != 0 ? m_statistics.exitCode : written;
    m_statistics = ofRender;
    return code;
}

}  // namespace pm::host
