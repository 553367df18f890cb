// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/sampling/sampler.h"
#include "integrator/scene/camera.h"
#include "integrator/scene/scene.h"
#include "integrator/shapes/ray_footprint.h"
#include "integrator/transport/frame/pixel_cell.h"
#include "integrator/transport/frame/render_settings.h"
#include "integrator/transport/seen_lights/lamp_images.h"
#include "integrator/values/rgb.h"

namespace pm {

// Lamps that the camera sees, straight or by way of delta lobes: the class of paths E S* L (see
// PathClass). Their images are bright and often smaller than a pixel, and rays to them cost little
// beside a camera sample's look-ups; so where lamps are seen a camera sample has several paths for
// this class alone. Where they meet glass they follow reflection and refraction
// both: a choice between them would find most images of lamps once in 25 times.
//
// An image much smaller than a pixel is hit by few of these paths, and is then a speck, or missing.
// Such images are looked for (see findLampImages); pixels that may show one have paths towards it
// besides.
//
// Where that is: a pilot of each square of pixels tells, computed when it is first asked for. It
// enters no picture and chooses between two estimates of the same mean, so it may miss something.
// Threads: const functions from any, at once.
class SeenLamps {
  public:
    static constexpr std::int32_t kSquare = 8;  // pixels to a side of what has one pilot

    // What a pixel shows.
    struct Shown {
        // Paths for each camera sample. 0: none, the camera sample's own path finds lamps.
        std::uint32_t paths = 0;
        // The small images in and around the pixel's square, where there are paths.
        std::span<const LampImage> images{};
    };

    // scene, lights and camera must outlive this.
    SeenLamps(const Scene& scene, const LightSampler& lights, const Camera& camera,
              const RenderSettings& settings);

    // Of pixels outside of the frame nothing is known.
    Shown shown(std::int32_t x, std::int32_t y) const;

    // The lamps' radiance that a camera sample of a cell sees, in sequences of its own: mean over
    // paths through the filter and, where lamps have small images, towards each of these. By the
    // balance heuristic (Veach 1997, eq. 9.8) the mean is the same wherever images are looked for.
    // shown: of the cell, with paths. index: of the sample. Adds the rays to `rays`.
    Rgb sample(const Shown& shown, std::uint32_t pass, const PixelCell& cell, std::uint32_t index,
               std::uint32_t& rays) const;

    // How far a path is followed: it divides so often, then lobes are chosen; what carries less
    // than this goes on by Russian roulette, and after so many events what carries less than
    // before.
    struct Effort {
        std::size_t divisions = 6;
        float leastThroughput = 1e-3f;
        int events = 5;
    };
    static constexpr Effort kOfImages{12, 1e-4f, 12};

    // Radiance of the lamps along a ray. Adds its rays to `rays`.
    Rgb along(const Ray& ray, const Sampler& sampler, std::uint32_t& rays) const {
        return along(ray, {}, sampler, rays, {});
    }
    Rgb along(const Ray& ray, const RayFootprint& footprint, const Sampler& sampler,
              std::uint32_t& rays, const Effort& effort) const;

  private:
    // What is known of a square.
    struct Square {
        std::uint32_t paths = 0;
        std::vector<LampImage> images;
    };

    Square look(std::int32_t column, std::int32_t row) const;

    const Scene& m_scene;
    const LightSampler& m_lights;
    const Camera& m_camera;
    const RenderSettings m_settings;
    const std::int32_t m_columns;
    const bool m_hasLamps;
    const std::vector<LightBall> m_balls;
    // Of each square kKnown and its number of paths once it was looked at, kHasImages as well.
    static constexpr std::uint8_t kKnown = 0x40, kHasImages = 0x80, kPaths = 0x3f;
    std::unique_ptr<std::atomic<std::uint8_t>[]> m_shown;
    // By column and row, of the squares that have some.
    mutable std::mutex m_imagesMutex;
    mutable std::map<std::pair<std::int32_t, std::int32_t>, std::vector<LampImage>> m_images;
};

}  // namespace pm
