// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Renders whose own estimate of their error is to be held against the truth.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "integrator/scene/scene.h"
#include "integrator/transport/frame/render_settings.h"
#include "scheduler/film/frame_error.h"

namespace pm::bench {

// A render after 2, 4, 8, ... passes: the picture, and what it says of its error.
struct Judged {
    std::uint32_t passes = 0;
    std::vector<double> rgb;       // linear, row by row
    std::vector<double> emission;  // of it, of lamps that are seen: noise, but no bias
    FrameError estimate;
    double processorSeconds = 0;  // to there, all threads; 0 where the passes were kept
};

// Of such a render: adaptive, as renders are by default.
RenderSettings judgedSettings(std::int32_t width, std::int32_t height, std::uint32_t passes,
                              std::uint64_t seed);

// What a long render comes to: its even and its odd passes share no noise.
struct Halves {
    std::vector<double> even, odd;  // RGB, row by row
    std::vector<double> evenEmission, oddEmission;
};

// Renders a scene pass by pass. Where a folder is given, the passes are kept in it and read from it
// the next time, so that another estimate can be tried on the same renders.
class PassSource {
  public:
    // key: names scene in the folder, which may be empty. threads: of a render.
    PassSource(std::shared_ptr<const Scene> scene, std::string key, std::filesystem::path folder,
               int threads)
        : m_scene(std::move(scene)),
          m_key(std::move(key)),
          m_folder(std::move(folder)),
          m_threads(threads) {}

    std::vector<Judged> judged(const RenderSettings& settings) const;
    Halves halves(const RenderSettings& settings) const;

  private:
    template <typename UsePass>
    void forEachPass(const RenderSettings& settings, const UsePass& usePass) const;

    std::shared_ptr<const Scene> m_scene;
    std::string m_key;
    std::filesystem::path m_folder;
    int m_threads;
};

}  // namespace pm::bench
