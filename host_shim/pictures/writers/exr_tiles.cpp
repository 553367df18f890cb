// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/pictures/writers/exr_tiles.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "host_shim/pictures/checked_file.h"
#include "host_shim/pictures/writers/exr_fill.h"
#include "host_shim/pictures/writers/exr_spec.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

constexpr const char* kComplete = "pm:complete";

std::int32_t tilesAcross(std::int32_t pixels, std::int32_t tilePixels) {
    return (pixels - 1) / tilePixels + 1;
}

OIIO::ImageSpec tiledSpec(const Picture& head, std::int32_t tilePixels, bool halfColour) {
    OIIO::ImageSpec spec = exrSpec(head, halfColour);
    spec.tile_width = spec.tile_height = tilePixels;
    spec.tile_depth = 1;
    // OpenEXR keeps tiles that come out of order in memory unless there is none.
    spec.attribute("openexr:lineOrder", "randomY");
    // Not known before the last tile is there.
    spec.attribute(kComplete, 0);
    return spec;
}

}  // namespace

struct TiledExr::Output {
    Output(const OIIO::ImageSpec& ofTiles, const FinishedFile& finished,
           const std::filesystem::path& shownPath)
        : spec(ofTiles),
          file(finished, shownPath),
          image(OIIO::ImageOutput::create(finished.temporaryPath().string())) {}

    OIIO::ImageSpec spec;
    CheckedFile file;
    std::unique_ptr<OIIO::ImageOutput> image;
};

TiledExr::TiledExr(const std::filesystem::path& path, const Picture& head, std::int32_t tilePixels,
                   const ExrOptions& options)
    : m_path(path),
      m_window(head.dataWindow),
      m_tilePixels(tilePixels),
      m_columns(tilesAcross(m_window.width(), tilePixels)),
      m_rows(tilesAcross(m_window.height(), tilePixels)),
      m_finished(path),
      m_output(std::make_unique<Output>(tiledSpec(head, tilePixels, options.halfColour), m_finished,
                                        path)),
      m_written(static_cast<std::size_t>(m_columns) * static_cast<std::size_t>(m_rows)) {
    if (!m_output->image)
        throw HostError(ExitCode::kFile, m_path.string() + ": " + OIIO::geterror());
    m_output->image->set_ioproxy(&m_output->file);
    if (!m_output->image->open(m_finished.temporaryPath().string(), m_output->spec)) fail();
}

TiledExr::~TiledExr() {
    if (m_output->image) m_output->image->close();
}

void TiledExr::fail() const {
    failWriting(m_path, m_output->file.firstError(), m_output->image->geterror());
}

std::size_t TiledExr::tileIndex(const PixelRect& tile) const {
    const std::int32_t x = tile.x0 - m_window.x0, y = tile.y0 - m_window.y0;
    const std::int32_t column = x / m_tilePixels, row = y / m_tilePixels;
    const bool inWindow = x >= 0 && y >= 0 && column < m_columns && row < m_rows;
    const std::size_t index = static_cast<std::size_t>(row) * static_cast<std::size_t>(m_columns) +
                              static_cast<std::size_t>(column);
    if (!inWindow || tile != tileRect(index))
        throw HostError(ExitCode::kInternal,
                        fmt::format("{}: [{},{}) x [{},{}) is no tile", m_path.string(), tile.x0,
                                    tile.x1, tile.y0, tile.y1));
    return index;
}

void TiledExr::write(const PixelRect& tile, std::span<const float> values) {
    const std::size_t index = tileIndex(tile);
    const auto channels = static_cast<std::size_t>(m_output->spec.nchannels);
    if (m_written[index] || values.size() != static_cast<std::size_t>(tile.area()) * channels)
        throw HostError(ExitCode::kInternal, fmt::format("{}: a tile came twice or with {} values",
                                                         m_path.string(), values.size()));
    m_values.assign(values.begin(), values.end());
    for (std::size_t c = 0; c < channels; ++c) {
        if (m_output->spec.channelformat(static_cast<int>(c)) != OIIO::TypeDesc::HALF) continue;
        for (std::size_t i = c; i < m_values.size(); i += channels)
            m_values[i] = clampedToHalf(m_values[i], m_report.clampedToHalf);
    }
    if (!m_output->image->write_tiles(tile.x0, tile.x1, tile.y0, tile.y1, 0, 1,
                                      OIIO::TypeDesc::FLOAT, m_values.data()))
        fail();
    m_written[index] = true;
}

void TiledExr::close() {
    const bool good = m_output->image->close();
    const std::string text = m_output->image->geterror();
    if (m_output->file.finish() != 0 || !good || !text.empty())
        failWriting(m_path, m_output->file.firstError(), text);
    m_output->image.reset();
}

ExrReport TiledExr::commit() {
    if (std::ranges::find(m_written, false) != m_written.end())
        throw HostError(ExitCode::kInternal, m_path.string() + ": tiles are missing");
    close();
    setExrNumber(m_finished.temporaryPath(), kComplete, 1);
    m_finished.commit();
    return m_report;
}

PixelRect TiledExr::tileRect(std::size_t index) const {
    const auto columns = static_cast<std::size_t>(m_columns);
    const std::int32_t x = m_window.x0 + static_cast<std::int32_t>(index % columns) * m_tilePixels;
    const std::int32_t y = m_window.y0 + static_cast<std::int32_t>(index / columns) * m_tilePixels;
    return {x, y, std::min(x + m_tilePixels, m_window.x1), std::min(y + m_tilePixels, m_window.y1)};
}

ExrReport TiledExr::commitPartial() {
    const auto channels = static_cast<std::size_t>(m_output->spec.nchannels);
    // Of each size one is written, the others are copies of it: a million tiles in a second.
    std::map<std::pair<std::int32_t, std::int32_t>, std::size_t> empty;
    std::vector<std::pair<std::size_t, std::size_t>> copies;
    for (std::size_t i = 0; i < m_written.size(); ++i) {
        if (m_written[i]) continue;
        const PixelRect tile = tileRect(i);
        const auto [first, isNew] = empty.try_emplace({tile.width(), tile.height()}, i);
        if (isNew)
            write(tile, std::vector<float>(static_cast<std::size_t>(tile.area()) * channels));
        else
            copies.emplace_back(i, first->second);
    }
    close();
    copyExrTiles(m_finished.temporaryPath(), static_cast<std::size_t>(m_columns), copies);
    m_finished.commitAs(partialName(m_finished.finalPath()));
    return m_report;
}

}  // namespace pm::host
