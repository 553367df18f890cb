// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Lights and cameras of a sidecar.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "host_shim/formats/sidecar/sidecar_parts.h"

namespace pm::host {
namespace {

using Point = std::array<double, 3>;

constexpr double kMostFloat = std::numeric_limits<float>::max();
constexpr NumberRange kLight{0, kMostFloat, true, true, ""};

float radians(double degrees) {
    return static_cast<float>(degrees * std::numbers::pi / 180);
}

Point direction(const JsonPlace& at) {
    const Point value = at.triple();
    const double length = std::hypot(value[0], value[1], value[2]);
    if (!(length > 0) || !std::isfinite(length))
        at.refuse(" has no direction; it must not be 0,0,0");
    return value;
}

// One of two keys. Errors: where there are none or both.
bool isSecond(const JsonPlace& at, const char* first, const char* second) {
    if (at.has(first) && at.has(second))
        at.refuse(std::string(" has ") + first + " and " + second + "; it is one of them");
    if (!at.has(second)) at.member(first);
    return at.has(second);
}

// From where a light or camera is to what it looks at, turned round.
Point backFrom(const JsonPlace& at, const Point& eye) {
    const JsonPlace place = at.member("lookAt");
    const Point target = place.triple();
    const Point back{eye[0] - target[0], eye[1] - target[1], eye[2] - target[2]};
    const double length = std::hypot(back[0], back[1], back[2]);
    if (!(length > 0) || !std::isfinite(length))
        place.refuse(" is where it stands; it must be another point");
    return back;
}

std::array<float, 3> colourOf(const JsonPlace& at) {
    const Point value = at.oneOrThree(kLight);
    return {static_cast<float>(value[0]), static_cast<float>(value[1]),
            static_cast<float>(value[2])};
}

void readPoint(const JsonPlace& at, LightData& light) {
    at.allowKeys({"type", "name", "position", "intensity", "colourSpace"});
    const Point place = at.member("position").triple();
    for (std::size_t axis = 0; axis < 3; ++axis) light.transform[axis * 4 + 3] = place[axis];
    light.emission = colourOf(at.member("intensity"));
}

void readSpot(const JsonPlace& at, LightData& light) {
    at.allowKeys({"type", "name", "position", "lookAt", "matrix", "intensity", "colourSpace",
                  "angle", "falloff"});
    if (isSecond(at, "position", "matrix")) {
        if (at.has("lookAt")) at.refuse(" has lookAt and matrix; it is one of them");
        light.transform = readRotation(at.member("matrix"));
    } else {
        const Point place = at.member("position").triple();
        light.transform = lookingAlong(backFrom(at, place), {0, 1, 0}, place);
    }
    light.emission = colourOf(at.member("intensity"));
    const double angle = at.member("angle").number({0, 180, false, true, "degrees"});
    light.coneAngle = std::min(radians(angle), std::numbers::pi_v<float>);
    if (at.has("falloff"))
        light.coneFalloff =
            std::min(radians(at.member("falloff").number({0, angle, true, true, "degrees"})),
                     light.coneAngle);
}

void readDirectional(const JsonPlace& at, LightData& light) {
    at.allowKeys({"type", "name", "direction", "matrix", "irradiance", "colourSpace", "angle"});
    if (isSecond(at, "direction", "matrix")) {
        light.transform = readRotation(at.member("matrix"));
    } else {
        const Point along = direction(at.member("direction"));
        light.transform = lookingAlong({-along[0], -along[1], -along[2]}, {0, 1, 0}, {});
    }
    light.emission = colourOf(at.member("irradiance"));
    if (at.has("angle"))
        light.angularRadius =
            std::min(radians(at.member("angle").number({0, 90, true, true, "degrees"})),
                     std::numbers::pi_v<float> / 2);
}

}  // namespace

LightData readLight(const JsonPlace& at) {
    LightData light;
    if (!at.isObject()) at.allowKeys({});
    const std::size_t kind = at.member("type").choice({"point", "spot", "directional"});
    if (kind == 0) readPoint(at, light);
    if (kind == 1) readSpot(at, light);
    if (kind == 2) readDirectional(at, light);
    constexpr LightData::Kind kKinds[] = {LightData::Kind::kPoint, LightData::Kind::kSpot,
                                          LightData::Kind::kDirectional};
    light.kind = kKinds[kind];
    light.name = at.has("name") ? at.member("name").text() : at.path();
    if (at.has("colourSpace"))
        light.isInRenderingSpace = at.member("colourSpace").choice({"material", "rendering"}) == 1;
    return light;
}

CameraData readCamera(const JsonPlace& at) {
    at.allowKeys({"name", "position", "lookAt", "up", "matrix", "fieldOfView", "pixelAspect"});
    CameraData camera;
    if (isSecond(at, "position", "matrix")) {
        if (at.has("lookAt") || at.has("up"))
            at.refuse(" has a matrix and one of lookAt and up; it is either");
        camera.transform = readRotation(at.member("matrix"));
    } else {
        camera.eye = at.member("position").triple();
        if (at.has("lookAt")) {
            backFrom(at, *camera.eye);
            camera.lookAt = at.member("lookAt").triple();
        }
        if (at.has("up")) camera.up = direction(at.member("up"));
    }
    camera.name = at.has("name") ? at.member("name").text() : at.path();
    if (at.has("fieldOfView"))
        camera.verticalFovDegrees =
            at.member("fieldOfView").number({0, 180, false, false, "degrees"});
    if (at.has("pixelAspect"))
        camera.lens.pixelAspect = at.member("pixelAspect").number({0, 1e6, false, true, ""});
    return camera;
}

}  // namespace pm::host
