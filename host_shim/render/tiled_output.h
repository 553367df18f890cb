// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "host_shim/cli/options.h"
#include "host_shim/colour/colour_pipeline.h"
#include "host_shim/pictures/writers/exr_tiles.h"
#include "host_shim/render/render_run.h"

namespace pm::host {

// The option that needs the whole picture at once, as it was typed, and so can't do with tiles;
// empty where none does.
std::string needsWholePicture(const Options& options);

// The pictures of a render that delivers bucket by bucket: EXR files whose tiles are the buckets,
// written as they come.
class TiledOutput : public BucketTaker {
  public:
    // All must outlive this. The files are begun with the first bucket.
    TiledOutput(const RenderRun& run, const Options& options, const ColourPipeline& colour);

    void take(const PmrBucketInfo& bucket) override;

    struct Written {
        std::filesystem::path file;
        ExrReport report;
    };
    // Gives the files their names, or, where the render was not complete, their partial ones. One
    // that fails doesn't take the others with it. Errors: those of TiledExr.
    std::vector<Written> finish(bool complete);

    // As isBlackThoughHit of the picture.
    bool isBlackThoughHit() const { return m_covered > 0 && 100 * m_lit <= m_covered; }

  private:
    struct Layer {
        std::string name;
        std::int32_t channels{};
    };
    void begin();
    void countLit(const std::vector<float>& pixels);

    const RenderRun& m_run;
    const Options& m_options;
    const ColourPipeline& m_colour;
    std::vector<Layer> m_layers;  // of the pixels, side by side
    std::int32_t m_channels{};
    std::vector<std::unique_ptr<TiledExr>> m_files;  // as the options' outputs
    std::uint64_t m_covered{}, m_lit{};
};

}  // namespace pm::host
