// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/sky/sky_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_shim/pictures/picture_io.h"
#include "host_shim/sky/daylight.h"

namespace pm::host {
namespace {

using Direction = std::array<double, 3>;

constexpr double kPi = std::numbers::pi;
constexpr double kRadians = kPi / 180;
constexpr double kGroundReflectance = 0.2;

// y up: azimuth 0 is -z, 90 degrees +x.
Direction towardsSun(const SkyData& sky) {
    const double azimuth = sky.azimuth * kRadians, elevation = sky.elevation * kRadians;
    return {std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
            -std::cos(azimuth) * std::cos(elevation)};
}

double dot(const Direction& a, const Direction& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

std::array<double, 3> scaled(const Xyz& light, double strength) {
    std::array<double, 3> rgb = toRec709(light);
    for (double& channel : rgb) channel = std::max(0.0, channel) * strength / kLuminanceOfOne;
    return rgb;
}

// The middle of a row or column of the picture. Its middle looks to -z, its right half to +x.
Direction directionOf(double u, double v) {
    const double around = 2 * kPi * (u - 0.5), down = kPi * v;
    return {std::sin(around) * std::sin(down), std::cos(down), -std::cos(around) * std::sin(down)};
}

}  // namespace

Picture skyPicture(const SkyData& sky, std::int32_t width) {
    const std::int32_t height = width / 2;
    const Daylight day(sky.elevation * kRadians, sky.turbidity);
    const Direction sun = towardsSun(sky);
    Picture picture;
    picture.width = width;
    picture.height = height;
    picture.dataWindow = {0, 0, width, height};
    const auto pixels = static_cast<std::size_t>(picture.dataWindow.area());
    for (const char* name : {"R", "G", "B"})
        picture.channels.push_back({name, true, std::vector<float>(pixels)});
    // Rec.709 and D65, so that readers know.
    picture.attributes["chromaticities"] =
        std::vector<float>{0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f};
    const auto store = [&](std::int32_t x, std::int32_t y, const std::array<double, 3>& colour) {
        const auto at = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                        static_cast<std::size_t>(x);
        for (std::size_t c = 0; c < 3; ++c)
            picture.channels[c].values[at] = static_cast<float>(colour[c]);
    };
    // What the ground gets, of which it sends back a share to all sides.
    std::array<double, 3> ground = scaled(day.sun(), sky.strength * sun[1]);
    for (std::int32_t y = 0; y < height / 2; ++y) {
        const double v = (y + 0.5) / height;
        const double share =
            2 * kPi / width * (std::cos(kPi * y / height) - std::cos(kPi * (y + 1) / height));
        for (std::int32_t x = 0; x < width; ++x) {
            const Direction to = directionOf((x + 0.5) / width, v);
            const auto colour = scaled(
                day.sky(kPi * v, std::acos(std::clamp(dot(to, sun), -1.0, 1.0))), sky.strength);
            store(x, y, colour);
            for (std::size_t c = 0; c < 3; ++c) ground[c] += colour[c] * to[1] * share;
        }
    }
    for (double& channel : ground) channel *= kGroundReflectance / kPi;
    for (std::int32_t y = height / 2; y < height; ++y)
        for (std::int32_t x = 0; x < width; ++x) store(x, y, ground);
    return picture;
}

LightData sunLight(const SkyData& sky) {
    const Daylight day(sky.elevation * kRadians, sky.turbidity);
    LightData light;
    light.name = "sun";
    light.kind = LightData::Kind::kDirectional;
    const auto irradiance = scaled(day.sun(), sky.strength);
    for (std::size_t c = 0; c < 3; ++c) light.emission[c] = static_cast<float>(irradiance[c]);
    light.angularRadius = static_cast<float>(Daylight::kSunRadius);
    // It shines along -z of its transform: z is towards the sun, x level.
    const Direction z = towardsSun(sky);
    const double azimuth = sky.azimuth * kRadians;
    const Direction x = {std::cos(azimuth), 0, std::sin(azimuth)};
    const Direction y = {z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2],
                         z[0] * x[1] - z[1] * x[0]};
    light.transform = {x[0], y[0], z[0], 0, x[1], y[1], z[1], 0, x[2], y[2], z[2], 0};
    if (sky.isZUp) light.transform = product(turnedToZUp(), light.transform);
    return light;
}

void makeSky(bool isZUp, TemporaryFolder& folder, SceneData& scene) {
    if (scene.sky) {
        constexpr std::int32_t kWidth = 1024;
        scene.sky->isZUp = isZUp;
        const std::filesystem::path file = folder.path() / "sky.exr";
        writeLinearPicture(file, skyPicture(*scene.sky, kWidth));
        EnvironmentData& environment = scene.environment.emplace();
        environment.radiance = {1, 1, 1};
        environment.texture.emplace();
        environment.texture->file = file.string();
        environment.texture->place = "the sky";
        scene.lights.push_back(sunLight(*scene.sky));
    }
    if (isZUp && scene.environment)
        scene.environment->transform =
            product(turnedToZUp(), scene.environment->transform.value_or(kIdentity));
}

Transform turnedToZUp() {
    return {1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0};
}

}  // namespace pm::host
