// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <OpenImageIO/imageio.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "host_shim/pictures/checked_file.h"
#include "host_shim/textures/row_halver.h"

struct XXH3_state_s;

namespace pm::host {

// Writes a tiled, mip-mapped OpenEXR from rows that come from the top: the finest level goes to the
// file as it comes, the next one is made of it on the way and held in memory, the others of that.
// A texel of a level is the mean over the area it covers of the level below. The same rows make the
// same bytes. For one thread.
class MipWriter {
  public:
    struct Format {
        int width{}, height{};
        int channels{};  // 1 or 3
        bool isHalf{};   // else float
        bool isFlat{};  // compresses well: by run lengths; else as it is, for which reading is free
    };
    // file: new, of the name `path`, and outlives this; shownName: for errors. Errors of all:
    // HostError kFile.
    MipWriter(const Format& format, CheckedFile& file, const std::filesystem::path& path,
              const std::filesystem::path& shownName);
    ~MipWriter();
    MipWriter(const MipWriter&) = delete;
    MipWriter& operator=(const MipWriter&) = delete;

    // What one such writer holds, in bytes.
    static std::uint64_t memoryBytes(const Format& format);
    // Rows of width * channels finite values; of half those beyond its range become its largest.
    void addRows(const std::vector<float>& rows);
    // All rows have come: writes the other levels and closes. goOn: called now and then; may throw.
    void finish(const std::function<void()>& goOn);
    // Of the finest level as it is stored: as the library's own checksum of a texture's texels.
    std::array<std::uint64_t, 2> texelHash() const;

  private:
    struct Level {
        int width{}, height{};
        std::vector<std::byte> rows;  // as stored; of the finest level those of the next tiles
        int rowCount{};
    };
    void openLevel(int index);
    void store(Level& level, const float* row);
    void flushFinest(bool isLast);
    void writeTiles(const Level& level, int y0, int y1, const std::byte* rows);
    void load(const Level& level, int row, std::vector<float>& values) const;
    std::size_t rowBytes(const Level& level) const;
    [[noreturn]] void fail();

    Format m_format;
    std::filesystem::path m_path, m_shownName;
    CheckedFile& m_file;
    OIIO::ImageSpec m_spec;
    std::unique_ptr<OIIO::ImageOutput> m_output;
    std::vector<Level> m_levels;
    std::optional<RowHalver> m_halver;  // from the finest level to the next
    int m_finestRows{};                 // that are in the file
    std::vector<float> m_clamped;
    struct Free {
        void operator()(XXH3_state_s* state) const;
    };
    std::unique_ptr<XXH3_state_s, Free> m_hash;
};

}  // namespace pm::host
