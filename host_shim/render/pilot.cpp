// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/render/pilot.h"

#include <algorithm>
#include <cmath>

#include "host_shim/colour/exposure.h"
#include "host_shim/process/interrupt.h"
#include "host_shim/render/picture_assembly.h"
#include "host_shim/render/render_run.h"

namespace pm::host {
namespace {

constexpr std::int32_t kLongerSide = 64;
// Below this share of lit surfaces paths may have missed what photons find.
constexpr double kWellLit = 0.9;

Options pilotOptions(const Options& options, const char* integrator) {
    Options pilot;
    const double scale = static_cast<double>(kLongerSide) / std::max(options.width, options.height);
    const auto scaled = [scale](std::int32_t side) {
        return std::max(1, static_cast<std::int32_t>(std::lround(side * scale)));
    };
    pilot.width = scaled(options.width);
    pilot.height = scaled(options.height);
    pilot.progress = ProgressStyle::kNone;
    pilot.layers = "albedo";  // by which black surfaces are known from unlit ones
    for (const GivenSetting& setting : options.settings)
        if (setting.name == "threads") pilot.settings.push_back(setting);
    for (const auto& [name, value] : {std::pair{"integrator", integrator},
                                      {"passes", "1"},
                                      {"aaLevel", "3"},
                                      {"aaLevelMost", "3"},
                                      {"photons", "20000"},
                                      {"bucketSize", "16"}})
        pilot.settings.push_back({"", name, value});
    return pilot;
}

Picture render(const PluginScene& scene, const Options& options, const ColourPipeline& colour) {
    // What it would warn of the render proper says as well.
    Log silent({Level::kError, false});
    Progress progress(ProgressStyle::kNone, true, silent);
    RenderRun run(scene, options, {}, silent, progress, nullptr);
    run.keepFrame({});
    const PmrStatus status = run.run();
    throwIfInterrupted();
    return assemblePicture(run, options, colour, status == PMR_OK);
}

}  // namespace

Picture renderPilot(const PluginScene& scene, const Options& options,
                    const ColourPipeline& colour) {
    Picture paths = render(scene, pilotOptions(options, "path"), colour);
    if (litShare(paths, colour.luminanceWeights()) >= kWellLit) return paths;
    return render(scene, pilotOptions(options, "photon"), colour);
}

}  // namespace pm::host
