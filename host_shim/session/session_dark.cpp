// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// A Session that made a black picture: why, and what helps.
#include <fmt/format.h>

#include <algorithm>

#include "host_shim/look/room_view.h"
#include "host_shim/process/interrupt.h"
#include "host_shim/render/picture_assembly.h"
#include "host_shim/session/read_rules.h"
#include "host_shim/session/session.h"

namespace pm::host {
namespace {

bool liesBehind(const CameraPose& camera, const Bounds& bounds) {
    for (unsigned corner = 0; corner < 8; ++corner) {
        double forward = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double at = ((corner >> axis & 1) != 0 ? bounds.high : bounds.low)[axis];
            forward -= camera.transform[axis * 4 + 2] * (at - camera.eye[axis]);
        }
        if (forward > 0) return false;
    }
    return true;
}

// The largest of R, G and B.
float brightest(const Picture& picture) {
    float most = 0;
    for (const char* name : {"R", "G", "B"}) {
        const Channel* channel = picture.find(name);
        if (channel == nullptr) continue;
        for (const float value : channel->values) most = std::max(most, value);
    }
    return most;
}

}  // namespace

void Session::lookForLight(const Picture& picture) {
    if (isBlackThoughHit(picture)) warnOfBlack();
    // A crop may well be of the background.
    if (m_options.crop || !m_options.merge.empty()) return;
    constexpr double kMostlyEmpty = 0.6;
    const double empty = emptyShare(picture);
    if (empty > kMostlyEmpty && empty < 1 && m_isFramed && !m_hasBackground)
        m_log.info(fmt::format(
            "{:.0f} % of the picture is empty: the scene is not there, nor a sky (--sun "
            "and --environment would be seen; --eye and --fov go closer)",
            100 * empty));
    if (empty < 1) return;
    warn(
        Warning::kBlackPicture,
        fmt::format("nothing of the scene is in the picture: {}; see --eye and --look-at",
                    m_camera && liesBehind(*m_camera, m_bounds) ? "all of it lies behind the camera"
                                                                : "the camera looks past it"));
}

// Whether the eye stands in something that is closed all round. What was read of the scene is gone
// by then, so it is read again.
bool Session::standsInClosedSpace() const {
    if (!m_camera) return false;
    const SceneData data = readScene(
        m_options, [](Warning, const std::string&) {}, m_camera->eye);
    return isClosedAround(OccupancyGrid(data), m_camera->eye);
}

void Session::warnOfBlack() {
    const bool isMerge = !m_options.merge.empty();
    std::string why =
        "though it shows surfaces: no light reaches their seen side, or they reflect none (see Kd "
        "and Ks); lamps shine from the front of their faces, where the corners go round "
        "counter-clockwise; --camera-light on puts a light at the camera";
    if (m_hasCameraLight)
        why =
            "though it shows surfaces and a light stands at the camera: they reflect none of it "
            "(see Kd and Ks of their materials; --aov albedo shows what they reflect)";
    else if (!isMerge && !m_hasLight)
        why = "as the scene has no light; --camera-light on puts one at the camera";
    else if (!isMerge && standsInClosedSpace())
        why =
            "as the camera stands inside of something closed that no light reaches; --eye puts it "
            "elsewhere, --camera-light on puts a light there";
    warn(Warning::kBlackPicture, "the picture is black " + why);
}

// Values that are there and that a display picture doesn't show.
void Session::lookForDarkness(const std::filesystem::path& file, const Picture& picture,
                              const DisplayPicture& shown) {
    constexpr float kVisible = 4.0f / 255;
    const float most = brightest(picture);
    const bool isVisible =
        std::ranges::any_of(shown.values, [](float value) { return value >= kVisible; });
    if (isVisible || !(most > 0.0f)) return;
    warn(Warning::kBlackPicture,
         fmt::format("{}: nothing of the picture can be seen at an exposure of {} stops: its "
                     "brightest value is {:.3g}; see --exposure STOPS|auto",
                     file.string(), exposureText(m_exposure), most));
}

}  // namespace pm::host
