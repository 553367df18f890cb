// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/app/frames_command.h"

#include <fmt/format.h>

#include "host_shim/cli/frame_options.h"
#include "host_shim/copies/scene_copies.h"
#include "host_shim/process/interrupt.h"
#include "host_shim/session/session.h"

namespace pm::host {

int runScene(Options options, Log& log) {
    const auto copies = takeCopies(options, log);
    return Session(options, log).run();
}

int runFrames(const Options& options, Log& log) {
    const std::vector<Options> frames = perFrame(options);
    int code = 0;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        log.info(fmt::format("frame {}, {} of {}", options.frames[i], i + 1, frames.size()));
        const int its = runScene(frames[i], log);
        if (interruptSignal() != 0) return its;
        if (code == 0) code = its;
    }
    return code;
}

}  // namespace pm::host
