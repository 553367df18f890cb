// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/cli/copies_options.h"

#include "host_shim/cli/option_values.h"
#include "host_shim/formats/scene_url.h"
#include "host_shim/pictures/picture_io.h"
#include "host_shim/values/host_error.h"

namespace pm::host {

void readCopies(const Typed& typed, Options& options) {
    constexpr double kMostGib = 1 << 20;
    options.copies = typed.copies;
    if (!typed.copiesLimit.empty())
        options.copiesGib = numberValue("--copies-limit", typed.copiesLimit, 0, kMostGib);
}

void checkPack(const Options& options) {
    if (options.scene.empty() || options.outputs.size() != 1)
        throw HostError(ExitCode::kUsage,
                        "usage: pm_host pack SCENE [options of a render] -o FOLDER, see pm_host "
                        "pack -h");
    if (isSceneUrl(options.scene.string()))
        throw HostError(ExitCode::kUsage, "pack: the scene is packed already; a file is wanted");
    if (!options.frames.empty())
        throw HostError(ExitCode::kUsage, "pack: one frame is wanted, --frame N");
}

}  // namespace pm::host
