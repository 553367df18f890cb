// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/cli/options.h"
#include "host_shim/colour/colour_pipeline.h"
#include "host_shim/pictures/picture.h"
#include "host_shim/render/scene_builder.h"

namespace pm::host {

// A small picture of the whole frame by which exposure and light are judged. It depends on the
// scene and on the frame's shape alone: longer side 64 pixels, one pass, seed 1, whatever the
// options say but for threads. Paths first, which are soon made; where they leave a tenth of the
// surfaces that are seen dark, photons, which reach more. Errors: those of the plugin; Interrupted.
Picture renderPilot(const PluginScene& scene, const Options& options, const ColourPipeline& colour);

}  // namespace pm::host
