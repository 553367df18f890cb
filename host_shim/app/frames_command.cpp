// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/app/frames_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "host_shim/cli/frame_options.h"
#include "host_shim/copies/scene_copies.h"
#include "host_shim/process/interrupt.h"
#include "host_shim/session/session.h"

namespace pm::host {

namespace {

// A scene that was rendered, with its copies in use.
struct Rendered {
    Rendered(Options options, Log& log) : copies(takeCopies(options, log)), session(options, log) {}
    std::optional<PackInUse> copies;
    Session session;
};

// Before time goes by: who meant another scene for each frame sees what was forgotten.
void tellEqualFrames(const std::vector<Options>& frames, Log& log) {
    const auto isFirst = [&](const Options& frame) { return areSameRender(frame, frames.front()); };
    if (frames.size() > 1 && std::ranges::all_of(frames, isFirst))
        log.info(
            fmt::format("all {} frames are equal, as no #### or %04d in the scene's name takes "
                        "their number: one is traced and rendered, and each gets its files",
                        frames.size()));
}

}  // namespace

int runScene(Options options, Log& log) {
    return Rendered(std::move(options), log).session.run();
}

int runFrames(const Options& options, Log& log) {
    const std::vector<Options> frames = perFrame(options);
    tellEqualFrames(frames, log);
    int code = 0;
    std::optional<std::int32_t> scale;
    std::unique_ptr<Rendered> last;
    std::size_t ofLast = 0;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        log.info(fmt::format("frame {}, {} of {}", options.frames[i], i + 1, frames.size()));
        int its = 0;
        if (last && areSameRender(frames[i], frames[ofLast]) &&
            last->session.canWriteAgain(frames[i])) {
            its = last->session.writeAgain(ofErrorScale(frames[i], scale), options.frames[ofLast]);
        } else {
            last.reset();  // its memory is for the next
            last = std::make_unique<Rendered>(ofErrorScale(frames[i], scale), log);
            ofLast = i;
            its = last->session.run();
            if (!scale) scale = last->session.errorScale();
        }
        if (interruptSignal() != 0) return its;
        if (code == 0) code = its;
    }
    return code;
}

}  // namespace pm::host
