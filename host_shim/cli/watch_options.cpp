// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/cli/watch_options.h"

#include <fmt/format.h>

#include "host_shim/cli/piece_options.h"
#include "host_shim/pictures/picture_io.h"
#include "host_shim/values/host_error.h"

namespace pm::host {

void readWatch(const Typed& typed, const FrameNumber& frame, Options& options) {
    constexpr double kLeast = 0.05, kMost = 3600;
    WatchOptions& watch = *options.watch;
    watch.job = typed.job;
    watch.frame = frame.number;
    watch.page = withFrame("--page", typed.page, frame);
    if (!typed.interval.empty())
        watch.intervalSeconds = numberValue("--interval", typed.interval, kLeast, kMost);
    if (options.merge.empty() == watch.job.empty() || options.outputs.empty())
        throw HostError(ExitCode::kUsage,
                        "usage: pm_host watch PART|FOLDER... -o FILE [options], or --job FOLDER in "
                        "place of parts; see pm_host watch -h");
    const std::string type = lowerCaseExtension(watch.page);
    if (!watch.page.empty() && type != ".html" && type != ".htm")
        throw HostError(
            ExitCode::kUsage,
            fmt::format("--page '{}': its name must end in .html or .htm", watch.page.string()));
    checkPicturesOnly("watch", options);
}

}  // namespace pm::host
