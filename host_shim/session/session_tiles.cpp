// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Session's end of a render whose picture is too large to be held: its tiles are in the files.
#include <fmt/format.h>

#include "host_shim/session/session.h"

namespace pm::host {

int Session::finishTiles(PmrStatus status, TiledOutput& output) {
    const bool complete = status == PMR_OK;
    // Of a torn picture it would be that of its finished buckets alone.
    const std::string error = complete ? errorText() : "";
    for (const TiledOutput::Written& written : output.finish(complete)) {
        m_statistics.outputs.push_back(written.file.string());
        warnOfClamped(written.file, written.report);
        m_log.info(fmt::format("wrote {}{}", written.file.string(), error));
    }
    if (!complete) throwStopped(status);
    m_statistics.stopReason = m_statistics.libraryStopReason();
    if (output.isBlackThoughHit()) warnOfBlack();
    return 0;
}

}  // namespace pm::host
