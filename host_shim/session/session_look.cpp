// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What a Session does so that a first picture shows something: where the camera stands, a light to
// see by, and exposure.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "host_shim/cli/option_values.h"
#include "host_shim/look/outside_view.h"
#include "host_shim/look/room_view.h"
#include "host_shim/process/interrupt.h"
#include "host_shim/render/picture_alpha.h"
#include "host_shim/render/pilot.h"
#include "host_shim/session/read_rules.h"
#include "host_shim/session/session.h"
#include "host_shim/session/session_files.h"

namespace pm::host {
namespace {

// Of the surfaces that are seen; no more are lit where a scene's own light shows nothing.
constexpr double kShowsNothing = 0.01;
// Of them; where more stay nearly black at any exposure, a light at the camera is added, or, of the
// second, told of.
constexpr double kMisses = 0.9, kMostlyDark = 0.6;

// The note that a part keeps: "exposure STOPS" as --exposure takes it, and how it was come by.
constexpr std::string_view kNote = "exposure ";
constexpr std::string_view kMeasured = " auto";
constexpr std::string_view kUnasked = " unasked";

std::string noteOf(const Exposure& exposure, bool isAsked) {
    if (exposure.from == Exposure::From::kDefault) return {};
    return fmt::format("{}{:.6g}{}{}", kNote, exposure.stops,
                       exposure.from == Exposure::From::kMeasured ? kMeasured : "",
                       isAsked ? "" : kUnasked);
}

bool takeEnd(std::string_view& text, std::string_view end) {
    if (!text.ends_with(end)) return false;
    text.remove_suffix(end.size());
    return true;
}

// Of an empty note 0. mayBeMeasured: whether one counts that was measured without being asked for.
Exposure exposureOf(std::string_view note, bool mayBeMeasured) {
    if (!note.starts_with(kNote)) return {};
    note.remove_prefix(kNote.size());
    const bool isAsked = !takeEnd(note, kUnasked);
    const bool isMeasured = takeEnd(note, kMeasured);
    if (!isAsked && !mayBeMeasured) return {};
    return {numberValue("exposure of the parts", note, -kMostExposureStops, kMostExposureStops),
            isMeasured ? Exposure::From::kMeasured : Exposure::From::kGiven};
}

// From which side a scene is seen: "+x, +y, -z", in its own axes.
std::string seenFrom(const ViewPoint& view, bool upIsZ) {
    constexpr double kNoticeable = 0.2;  // of the largest part
    std::array<double, 3> away{};
    for (std::size_t i = 0; i < 3; ++i) away[i] = view.eye[i] - view.lookAt[i];
    if (upIsZ) away = backToZUp(away);
    const double most = std::max({std::abs(away[0]), std::abs(away[1]), std::abs(away[2])});
    std::vector<std::string> sides;
    for (std::size_t i = 0; i < 3; ++i)
        if (std::abs(away[i]) > kNoticeable * most)
            sides.push_back(fmt::format("{}{}", away[i] < 0 ? '-' : '+', "xyz"[i]));
    return fmt::format(
        "the scene is seen from {}, where it shows more than from the front (--eye puts the camera "
        "elsewhere)",
        fmt::join(sides, ", "));
}

}  // namespace

// What the options leave out is found from the scene.
CameraPose Session::frameScene(const SceneData& data) {
    CameraOptions camera = m_options.camera;
    const double aspect = static_cast<double>(m_options.width) / m_options.height;
    if (const CameraData* described = cameraInUse(m_options, data.cameras))
        return poseOf(*described, camera, data.bounds, aspect);
    if (camera.eye) return frameCamera(camera, data.bounds, aspect);
    camera.fromNegativeZ = opensTowardsNegativeZ(data);
    OccupancyGrid grid(data);
    const bool upIsZ = !camera.up && !camera.lookAt && standsOnZ(grid, data.bounds);
    if (upIsZ) {
        m_log.info("the scene stands on z = 0: z is up (--up 0,1,0 --eye x,y,z would have y up)");
        grid = OccupancyGrid(data, true);
        camera.fromNegativeZ = false;
    }
    const Bounds bounds = upIsZ ? asIfYWereUp(data.bounds) : data.bounds;
    const CameraPose front = frameCamera(camera, bounds, aspect);
    if (const auto room = viewOfRoom(grid)) {
        camera.eye = room->eye;
        if (!camera.lookAt) camera.lookAt = room->lookAt;
        if (!camera.verticalFovDegrees) camera.verticalFovDegrees = kRoomFovDegrees;
        m_log.info(
            "the scene is closed all round and seen from inside (--eye puts the camera "
            "elsewhere)");
    } else if (!camera.lookAt) {
        const auto better = betterView(grid, {front.eye, bounds, front.verticalFov, aspect});
        if (better) {
            camera.eye = better->eye;
            camera.lookAt = better->lookAt;
        }
        if (better || camera.fromNegativeZ)
            m_log.info(seenFrom(better.value_or(ViewPoint{front.eye, front.lookAt}), upIsZ));
    }
    if (upIsZ) {
        camera.eye = backToZUp(camera.eye.value_or(front.eye));
        if (camera.lookAt) camera.lookAt = backToZUp(*camera.lookAt);
        camera.up = {0, 0, 1};
    }
    return frameCamera(camera, data.bounds, aspect);
}

// The scene with its own light or, where that is none or shows nothing, with one at the camera.
void Session::buildLit(SceneData& data, const CameraPose& camera, const ColourPipeline& colour,
                       MaterialBuilder& materials, std::optional<PluginScene>& scene) {
    const PluginContext& context = scene->context();
    const std::string name = m_options.scene.string();
    materials.putOutLights(data);
    const bool isAuto = m_options.cameraLight == CameraLight::kAuto;
    const bool needsLight = isAuto && !data.hasLight();
    // Who says where to stand may want to see that it is dark there.
    const bool judges = isAuto && !needsLight && m_isFramed;
    const auto build = [&] {
        phase("buildSceneSeconds", [&] {
            const InterruptWatch watch([&] { context.api().cancelBuilds(context.handle(), 1); });
            scene->build({data, name, m_options.subdivide, camera}, colour, materials);
        });
    };
    const auto buildWith = [&](bool withCameraLight) {
        m_hasCameraLight = withCameraLight;
        if (withCameraLight) data.lights.push_back(cameraLight(camera, data.bounds));
        if (judges || (exposes() && measuresExposure(colour)))
            meterWithAlpha(data, build, colour, materials, scene);
        build();
    };
    buildWith(needsLight || m_options.cameraLight == CameraLight::kOn);
    if (needsLight)
        warn(Warning::kDefaultLight,
             name + ": no light (no material with Ke); a point light at the camera is added");
    if (!judges || isLit(pilot(*scene, colour), colour)) return;
    m_pilot.reset();
    scene.emplace(context, m_log);
    buildWith(true);
}

void Session::meterWithAlpha(SceneData& data, const std::function<void()>& build,
                             const ColourPipeline& colour, MaterialBuilder& materials,
                             std::optional<PluginScene>& scene) {
    const std::vector<const MaterialData*> cut = materials.cutUnasked(usedMaterials(data));
    if (cut.empty()) return;
    std::vector<MaterialData> asShown = data.materials;
    for (MaterialData& material : data.materials)
        if (std::ranges::find(cut, &material) != cut.end()) takeAlphaOfPictures({&material, 1});
    build();
    pilot(*scene, colour);
    const PluginContext& context = scene->context();
    scene.emplace(context, m_log);
    data.materials = std::move(asShown);
}

bool Session::isLit(const Picture& seen, const ColourPipeline& colour) {
    const std::string name = m_options.scene.string();
    const auto& weights = colour.luminanceWeights();
    const bool reaches = litShare(seen, weights) > kShowsNothing;
    const double dark = darkShare(seen, weights), black = blackShare(seen, weights);
    if (black > kMostlyDark)
        warn(Warning::kDefaultLight,
             fmt::format("{}: {:.0f} % of what is seen reflects nothing, and is black in any light "
                         "(see Kd and Ks of its materials; --aov albedo shows what they reflect)",
                         name, 100 * black));
    if (reaches && dark <= kMisses) {
        if (dark > kMostlyDark)
            warn(Warning::kDefaultLight,
                 fmt::format("{}: {:.0f} % of what is seen gets next to none of its own light; "
                             "--camera-light on adds a light at the camera",
                             name, 100 * dark));
        return true;
    }
    warn(Warning::kDefaultLight,
         name +
             (reaches ? fmt::format(": its own light misses {:.0f} % of what the camera sees",
                                    100 * dark)
                      : std::string(": its own light reaches nothing that the camera sees: lamps "
                                    "are closed away, too small, or shine to the other side")) +
             "; a point light at the camera is added (--camera-light off leaves it out)");
    return false;
}

// Made once.
const Picture& Session::pilot(const PluginScene& scene, const ColourPipeline& colour) {
    if (!m_pilot) phase("pilotSeconds", [&] { m_pilot = renderPilot(scene, m_options, colour); });
    return *m_pilot;
}

// Pictures through a view that was chosen, or that are to match others, keep one exposure; and
// those of a sky, whose unit is such that they need none.
bool Session::measuresExposure(const ColourPipeline& colour) const {
    if (m_options.exposure.kind != ExposureOption::Kind::kNotGiven)
        return m_options.exposure.kind == ExposureOption::Kind::kAuto;
    return m_options.exposure.mayBeMeasured && !m_hasSky && m_options.colour.view.empty() &&
           m_options.reference.empty() && colour.hasBuiltInConfig();
}

// Whether anything is written that is shown at an exposure.
bool Session::exposes() const {
    return !m_options.explain && !m_options.photonsOnly &&
           (wantsDisplay(m_options) || !m_options.part.empty());
}

void Session::tellExposure() {
    m_statistics.exposureStops = m_exposure.stops;
    if (m_exposure.from == Exposure::From::kMeasured)
        m_log.info(
            fmt::format("exposure of display pictures: {:.6g} stops (auto; --exposure {:.6g} "
                        "repeats it, 0 shows values as they are)",
                        m_exposure.stops, m_exposure.stops));
}

void Session::expose(const PluginScene& scene, const ColourPipeline& colour,
                     std::optional<DisplayTransform>& display) {
    if (!exposes()) return;
    if (measuresExposure(colour)) {
        m_exposure = {measuredExposureStops(pilot(scene, colour), colour.luminanceWeights()),
                      Exposure::From::kMeasured};
    } else if (m_options.exposure.kind == ExposureOption::Kind::kStops) {
        m_exposure = {m_options.exposure.stops, Exposure::From::kGiven};
    }
    const bool isAsked = m_options.exposure.kind != ExposureOption::Kind::kNotGiven;
    if (!m_options.part.empty())
        m_options.settings.push_back({"", "hostNote", noteOf(m_exposure, isAsked)});
    tellExposure();
    if (display) display->setExposureStops(m_exposure.stops);
}

// notes: of the parts, one a line, each once.
void Session::exposeAsParts(const std::string& notes, const ColourPipeline& colour,
                            DisplayTransform& display) {
    const ExposureOption& asked = m_options.exposure;
    if (asked.kind == ExposureOption::Kind::kStops) {
        m_exposure = {asked.stops, Exposure::From::kGiven};
    } else if (notes.find('\n') != std::string::npos) {
        std::string shown = notes;
        std::ranges::replace(shown, '\n', ';');
        throw HostError(ExitCode::kBadInput,
                        fmt::format("merge: the parts are not of one exposure ({}); give it with "
                                    "--exposure STOPS",
                                    shown));
    } else {
        m_exposure = exposureOf(notes, measuresExposure(colour));
    }
    if (asked.kind == ExposureOption::Kind::kAuto && m_exposure.from != Exposure::From::kMeasured)
        throw HostError(ExitCode::kBadInput,
                        "--exposure auto: the parts hold no measured exposure; render them with "
                        "--exposure auto, or give it here with --exposure STOPS");
    tellExposure();
    display.setExposureStops(m_exposure.stops);
}

}  // namespace pm::host
