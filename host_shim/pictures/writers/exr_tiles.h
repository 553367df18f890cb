// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "host_shim/pictures/finished_file.h"
#include "host_shim/pictures/picture.h"
#include "host_shim/pictures/picture_io.h"

namespace pm::host {

// An EXR that is written tile by tile and never held: for pictures larger than memory. As
// writeExr's but for its tiles, which stand in the file in the order they came in, so that nothing
// has to wait for those before it. The same tiles in the same order give the same bytes. It takes
// its name when it is whole. For one thread at a time.
class TiledExr {
  public:
    // head: windows, channels without values, attributes. tilePixels: side of a tile; they begin
    // at the data window's top left corner. Errors: kFile.
    TiledExr(const std::filesystem::path& path, const Picture& head, std::int32_t tilePixels,
             const ExrOptions& options);
    ~TiledExr();  // leaves nothing unless committed

    // One tile, or at the right and lower edge what of it lies in the data window. values: all
    // channels side by side, row by row. Errors: kFile; kInternal for another rectangle or one that
    // was written before.
    void write(const PixelRect& tile, std::span<const float> values);

    // All tiles are there: pm:complete becomes 1. Errors: kFile; kInternal where tiles are missing.
    ExrReport commit();
    // Some are not: they are filled with 0, and the picture appears under its partialName() with
    // pm:complete 0. Errors: kFile.
    ExrReport commitPartial();

  private:
    std::size_t tileIndex(const PixelRect& tile) const;
    PixelRect tileRect(std::size_t index) const;
    void close();
    [[noreturn]] void fail() const;

    const std::filesystem::path m_path;
    const PixelRect m_window;
    const std::int32_t m_tilePixels;
    std::int32_t m_columns, m_rows;
    FinishedFile m_finished;
    struct Output;  // OpenImageIO's
    std::unique_ptr<Output> m_output;
    std::vector<bool> m_written;  // of each tile
    std::vector<float> m_values;  // of the tile that is written
    ExrReport m_report;
};

}  // namespace pm::host
