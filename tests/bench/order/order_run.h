// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// One pass of a scene's buckets, rendered as the library does it, with any order and size.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "integrator/scene/scene.h"
#include "integrator/transport/frame_renderer.h"
#include "scheduler/film/correlated_choice.h"

namespace pm::bench {

struct BucketSetting {
    std::string order = "hilbert";
    std::int32_t size = 32;  // pixels
    int threads = 1;
    // All of these may be empty. Nothing is made yet; photons and maps are, the buckets not begun.
    std::function<void()> begun = {}, prepared = {};
    // Renders an atom of a bucket, on the thread that does.
    std::function<void(std::uint32_t cell, const std::function<void()>& render)> around = {};
    CorrelatedChoice::Missing missing = {};
};

struct BucketTimes {
    double prepareSeconds = 0, prepareProcessorSeconds = 0;  // of photons and maps
    double seconds = 0, processorSeconds = 0;                // of the buckets alone
    double idleSeconds = 0;                                  // of workers at the end, summed
    double choiceSeconds = 0;                // of it, spent choosing (order "correlated")
    std::vector<std::vector<double>> atoms;  // processor seconds of each, by bucket as begun
    std::vector<std::uint32_t> cells;        // of the buckets as begun
};

// A scene ready to be rendered again and again. Threads: one call at a time.
class OrderScene {
  public:
    // paging: of the photon maps; null: they are in memory. Outlives this.
    OrderScene(std::string name, std::shared_ptr<const Scene> scene, const RenderSettings& settings,
               PhotonPaging* paging = nullptr);

    const std::string& name() const { return m_name; }

    // The first pass, with photons and maps made anew so that nothing is kept from the time before,
    // by as many threads as the buckets.
    BucketTimes render(const BucketSetting& setting);

    // Ways through a bucket's pixels. One region: what a call of the renderer is given.
    enum class Inside {
        kBucketRows,     // row by row of the bucket, one region
        kAtomsInRows,    // atom after atom in rows, a region each
        kAtomsOnCurve,   // atom after atom along a Hilbert curve, a region each
        kPixelRows,      // the same three pixel by pixel, a region each
        kPixelAtomRows,  //
        kPixelsOnCurve,  // one Hilbert curve through the bucket's pixels
    };
    // Processor seconds of one thread, buckets of 32 pixels in Hilbert order.
    double renderInside(Inside way);

  private:
    void beginPass(int threads);

    std::string m_name;
    RenderSettings m_settings;
    std::unique_ptr<FrameRenderer> m_renderer;
};

}  // namespace pm::bench
