// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/lights/light.h"

#include <algorithm>
#include <numbers>

#include "integrator/lights/box_shadow.h"

namespace pm {

double crossSection(const Vec3d& halfSize, const Vec3d& direction) {
    return std::max(BoxShadow(halfSize, direction).area(), 1e-3 * lengthSquared(halfSize));
}

void addPointLights(std::span<const PointLightDescription> points,
                    std::span<const SpotLightDescription> spots, const Vec3d& centre,
                    std::vector<Light>& lights, std::vector<Beam>& beams) {
    for (const PointLightDescription& point : points) {
        if (isBlack(point.intensity)) continue;
        Light light;
        light.position = point.position - centre;
        light.intensity = point.intensity;
        light.powerMean = 4 * std::numbers::pi * channelMean(point.intensity);
        lights.push_back(light);
    }
    for (const SpotLightDescription& spot : spots) {
        if (isBlack(spot.intensity)) continue;
        Light light;
        light.kind = Light::Kind::kSpot;
        light.beam = static_cast<std::uint32_t>(beams.size());
        beams.push_back(Beam::make(spot.direction, spot.coneAngle, spot.coneFalloff));
        light.position = spot.position - centre;
        light.intensity = spot.intensity;
        light.powerMean =
            static_cast<double>(beams.back().fluxOverIntensity()) * channelMean(spot.intensity);
        lights.push_back(light);
    }
}

void addDirectionalLights(std::span<const DirectionalLightDescription> suns, const Vec3d& halfSize,
                          std::vector<Light>& lights, std::vector<Beam>& beams) {
    for (const DirectionalLightDescription& sun : suns) {
        if (isBlack(sun.irradiance)) continue;
        Light light;
        light.kind = Light::Kind::kDirectional;
        light.beam = static_cast<std::uint32_t>(beams.size());
        const double angle = sun.angularRadius < kNarrowestDisc ? 0.0 : sun.angularRadius;
        beams.push_back(Beam::make(sun.direction, angle, 0.0));
        const Beam& beam = beams.back();
        light.intensity = sun.irradiance;
        light.powerMean = channelMean(sun.irradiance) * crossSection(halfSize, Vec3d(beam.axis));
        // The irradiance of a disc of radiance L: pi L sin^2.
        if (!beam.isDelta())
            light.intensity = sun.irradiance / (std::numbers::pi_v<float> * beam.oneMinusCos *
                                                (2.0f - beam.oneMinusCos));
        lights.push_back(light);
    }
}

}  // namespace pm
