// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/textures/mip_writer.h"

#include <xxhash.h>

#include <algorithm>
#include <cstring>
#include <new>

#include "host_shim/pictures/image_output.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

constexpr int kTileSize = 64;
constexpr float kLargestHalf = 65504.0f;

}  // namespace

void MipWriter::Free::operator()(XXH3_state_s* state) const {
    XXH3_freeState(state);
}

MipWriter::MipWriter(const Format& format, CheckedFile& file, const std::filesystem::path& path,
                     const std::filesystem::path& shownName)
    : m_format(format),
      m_path(path),
      m_shownName(shownName),
      m_file(file),
      m_spec(format.width, format.height, format.channels,
             format.isHalf ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT),
      m_hash(XXH3_createState()) {
    if (!m_hash) throw std::bad_alloc();
    m_spec.channelnames = format.channels == 1 ? std::vector<std::string>{"Y"}
                                               : std::vector<std::string>{"R", "G", "B"};
    m_spec.tile_width = m_spec.tile_height = kTileSize;
    m_spec.tile_depth = 1;
    m_spec.attribute("compression", format.isFlat ? "rle" : "none");
    m_spec.attribute("openexr:levelmode", 1);     // a mip map
    m_spec.attribute("openexr:roundingmode", 0);  // of sizes, down
    m_spec.attribute("textureformat", "Plain Texture");
    m_spec.attribute("DateTime", kFixedDateTime);
    int width = format.width, height = format.height;
    m_levels.push_back({width, height, {}, 0});
    while (width > 1 || height > 1) {
        width = std::max(1, width / 2);
        height = std::max(1, height / 2);
        m_levels.push_back({width, height, {}, 0});
    }
    if (m_levels.size() > 1)
        m_halver.emplace(format.width, format.height, format.channels,
                         [this](const float* row) { store(m_levels[1], row); });
    const std::array<std::int64_t, 4> shape = {format.width, format.height, format.channels,
                                               m_spec.format.basetype};
    XXH3_128bits_reset_withSeed(m_hash.get(), XXH3_128bits(shape.data(), sizeof shape).low64);
    m_output = OIIO::ImageOutput::create("openexr");
    if (!m_output) fail();
    m_output->set_ioproxy(&m_file);
    openLevel(0);
}

MipWriter::~MipWriter() = default;

std::uint64_t MipWriter::memoryBytes(const Format& format) {
    const auto width = static_cast<std::uint64_t>(format.width),
               height = static_cast<std::uint64_t>(format.height);
    const auto texel = static_cast<std::uint64_t>(format.channels) * (format.isHalf ? 2 : 4);
    const std::uint64_t next =
        std::max<std::uint64_t>(1, width / 2) * std::max<std::uint64_t>(1, height / 2) * texel;
    return next + next / 4 + 4 * width * kTileSize * texel;
}

std::size_t MipWriter::rowBytes(const Level& level) const {
    return static_cast<std::size_t>(level.width) * static_cast<std::size_t>(m_format.channels) *
           (m_format.isHalf ? 2 : 4);
}

void MipWriter::fail() {
    const std::string text = m_output ? m_output->geterror() : OIIO::geterror();
    failWriting(m_shownName, m_file.firstError(), text);
}

void MipWriter::openLevel(int index) {
    OIIO::ImageSpec spec = m_spec;
    const Level& level = m_levels[static_cast<std::size_t>(index)];
    spec.width = spec.full_width = level.width;
    spec.height = spec.full_height = level.height;
    const auto mode = index == 0 ? OIIO::ImageOutput::Create : OIIO::ImageOutput::AppendMIPLevel;
    if (!m_output->open(m_path.string(), spec, mode)) fail();
}

void MipWriter::store(Level& level, const float* row) {
    const std::size_t bytes = rowBytes(level);
    if (level.rows.empty() && &level != m_levels.data())
        level.rows.resize(bytes * static_cast<std::size_t>(level.height));
    const std::size_t at = bytes * static_cast<std::size_t>(level.rowCount++);
    if (level.rows.size() < at + bytes) level.rows.resize(at + bytes);
    std::byte* to = level.rows.data() + at;
    if (!m_format.isHalf) {
        std::memcpy(to, row, bytes);
        return;
    }
    const auto count = static_cast<int>(bytes / 2);
    m_clamped.resize(bytes / 2);
    for (std::size_t i = 0; i < m_clamped.size(); ++i)
        m_clamped[i] = std::clamp(row[i], -kLargestHalf, kLargestHalf);
    OIIO::convert_pixel_values(OIIO::TypeDesc::FLOAT, m_clamped.data(), OIIO::TypeDesc::HALF, to,
                               count);
}

void MipWriter::load(const Level& level, int row, std::vector<float>& values) const {
    const std::size_t bytes = rowBytes(level);
    const std::byte* from = level.rows.data() + bytes * static_cast<std::size_t>(row);
    values.resize(bytes / (m_format.isHalf ? 2 : 4));
    if (!m_format.isHalf) {
        std::memcpy(values.data(), from, bytes);
        return;
    }
    OIIO::convert_pixel_values(OIIO::TypeDesc::HALF, from, OIIO::TypeDesc::FLOAT, values.data(),
                               static_cast<int>(values.size()));
}

void MipWriter::writeTiles(const Level& level, int y0, int y1, const std::byte* rows) {
    if (!m_output->write_tiles(0, level.width, y0, y1, 0, 1, m_spec.format, rows)) fail();
    if (m_file.firstError() != 0) fail();
}

void MipWriter::flushFinest(bool isLast) {
    Level& finest = m_levels[0];
    if (finest.rowCount == 0 || (finest.rowCount < kTileSize && !isLast)) return;
    XXH3_128bits_update(m_hash.get(), finest.rows.data(),
                        rowBytes(finest) * static_cast<std::size_t>(finest.rowCount));
    writeTiles(finest, m_finestRows, m_finestRows + finest.rowCount, finest.rows.data());
    m_finestRows += finest.rowCount;
    finest.rowCount = 0;
}

void MipWriter::addRows(const std::vector<float>& rows) {
    const std::size_t size =
        static_cast<std::size_t>(m_format.width) * static_cast<std::size_t>(m_format.channels);
    for (std::size_t at = 0; at + size <= rows.size(); at += size) {
        store(m_levels[0], &rows[at]);
        if (m_halver) m_halver->add(&rows[at]);
        flushFinest(false);
    }
}

void MipWriter::finish(const std::function<void()>& goOn) {
    flushFinest(true);
    m_levels[0].rows = {};
    std::vector<float> row;
    for (std::size_t i = 1; i < m_levels.size(); ++i) {
        Level& level = m_levels[i];
        openLevel(static_cast<int>(i));
        std::optional<RowHalver> halver;
        if (i + 1 < m_levels.size())
            halver.emplace(level.width, level.height, m_format.channels,
                           [&](const float* next) { store(m_levels[i + 1], next); });
        for (int y = 0; y < level.height; y += kTileSize) {
            if (goOn) goOn();
            const int end = std::min(y + kTileSize, level.height);
            writeTiles(level, y, end,
                       level.rows.data() + rowBytes(level) * static_cast<std::size_t>(y));
            for (int k = y; halver && k < end; ++k) {
                load(level, k, row);
                halver->add(row.data());
            }
        }
        level.rows = {};
    }
    const bool good = m_output->close();
    // Which leaves a file of levels open for more: the table of where its tiles are comes with the
    // end.
    m_output.reset();
    if (!good || m_file.finish() != 0) fail();
}

std::array<std::uint64_t, 2> MipWriter::texelHash() const {
    const XXH128_hash_t hash = XXH3_128bits_digest(m_hash.get());
    return {hash.low64, hash.high64};
}

}  // namespace pm::host
