// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// A Session that writes down what it found for its scene.
#include <fmt/format.h>

#include "host_shim/formats/sidecar/sidecar.h"
#include "host_shim/formats/source_file.h"
#include "host_shim/pictures/finished_file.h"
#include "host_shim/session/read_rules.h"
#include "host_shim/session/session.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

// What gives the same pose again, to the last bit.
CameraData described(const CameraPose& pose) {
    CameraData camera;
    camera.name = "found";
    camera.eye = pose.eye;
    camera.lookAt = pose.lookAt;
    camera.up = pose.up;
    camera.verticalFovDegrees = pose.verticalFovDegrees;
    return camera;
}

}  // namespace

void Session::checkSidecar() const {
    const fs::path file = sidecarOf(m_options.scene);
    std::error_code ignored;
    if (m_options.writeSidecar && m_options.noSidecar && fs::exists(file, ignored))
        throw HostError(ExitCode::kUsage,
                        fmt::format("--write-sidecar: {} is there and --no-sidecar leaves it out; "
                                    "only what was read is written anew",
                                    file.string()));
}

void Session::writeSidecar(const SceneData& data) {
    SidecarGuess guess;
    if (data.cameras.empty()) guess.camera = described(*m_camera);
    // What was asked for is asked for again.
    if (m_hasCameraLight && m_options.cameraLight == CameraLight::kAuto)
        guess.light = data.lights.back();
    const fs::path file = sidecarOf(m_options.scene);
    if (!guess.camera && !guess.light) {
        m_log.info(fmt::format("{}: says all already that was found for the scene", file.string()));
        return;
    }
    const std::string before = data.sidecar.empty() ? "" : readWholeFile(file);
    writeFinishedFile(file, withGuess(before, guess));
    m_log.info(fmt::format("wrote {}: {}{}{}", file.string(), guess.camera ? "the camera" : "",
                           guess.camera && guess.light ? " and " : "",
                           guess.light ? "the light at the camera" : ""));
}

}  // namespace pm::host
