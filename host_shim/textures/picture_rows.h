// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <OpenImageIO/imageio.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host_shim/colour/picture_statement.h"
#include "host_shim/textures/picture_layout.h"
#include "host_shim/textures/texture_facts.h"

namespace pm::host {

// A picture file read from the top row to the bottom row, a few rows at a time, as a texture means
// it: its display window (black where an EXR has no data), the channels of `layout()`, integers as
// fractions of full code, colour straight (not multiplied by alpha). For one thread at a time.
class PictureRows {
  public:
    // Reads the header only. channel: see choosePictureLayout. Errors: HostError, naming the file:
    // kFile when missing, kBadInput when it is no picture or one that can't be used.
    PictureRows(const std::filesystem::path& file, TextureKind kind, char channel);

    const PictureLayout& layout() const { return m_layout; }
    int width() const { return m_spec.full_width; }
    int height() const { return m_spec.full_height; }
    // Of readRows: 3 for colours, else 1.
    int channels() const { return m_channels; }
    OIIO::TypeDesc storedType() const { return m_type; }
    bool isFloatFile() const { return m_type.is_floating_point(); }
    const PictureStatement& statement() const { return m_statement; }
    // Bytes that reading takes: rows, or for most formats the whole picture, inside OpenImageIO.
    std::uint64_t memoryBytes() const;
    // The file itself can be looked up as a texture: tiled, mip-mapped, nothing to choose or to
    // undo.
    bool isPlainTexture() const;
    // Colours are divided by an alpha that the file holds them multiplied by.
    bool divides() const { return m_divides; }
    std::uint64_t fileBytes() const;

    // The next rows, at most `rows.size() / width()` of them, as codes of 8 or 16 bits; only where
    // hasCodes(). Rows outside the data are 0. Errors: kBadInput when the file is broken.
    bool hasCodes() const;
    void readCodes(int rowCount, std::vector<std::uint8_t>& codes);
    void readCodes(int rowCount, std::vector<std::uint16_t>& codes);
    // The same as the file has them, of a plain texture.
    void readStored(int rowCount, std::vector<std::byte>& bytes);
    // The same as floats, bad texels replaced and counted.
    void readRows(int rowCount, std::vector<float>& values);
    const BadTexelCount& badTexels() const { return m_bad; }
    // Of what readRows() made luminance of: as good as all texels are unit vectors out of the
    // surface, and they are flat on the average.
    bool isLikeNormals() const;
    // Of colours that were read: the picture has an alpha, and it says that some are to be seen
    // through.
    bool hasHoles() const { return m_hasHoles; }
    // And of others that they are not: it is the outline of something.
    bool isCutOut() const { return m_hasHoles && m_hasOpaque; }

  private:
    template <typename T>
    void readPicked(int rowCount, OIIO::TypeDesc type, std::vector<T>& values);
    template <typename T>
    void loadBand(int dataRow, OIIO::TypeDesc type);
    template <typename T>
    void pickRow(int dataRow, std::span<T> row);
    template <typename T>
    void lookForHoles(const T* texels, std::size_t count, std::size_t stride);
    void findWindows();
    void noteOrientation();
    void lookForNormal(const float* colour);
    [[noreturn]] void failReading(const std::string& text) const;

    std::filesystem::path m_file;
    std::string m_format;
    std::unique_ptr<OIIO::ImageInput> m_input;
    OIIO::ImageSpec m_spec;
    PictureLayout m_layout;
    PictureStatement m_statement;
    OIIO::TypeDesc m_type;
    int m_channels{};
    int m_firstChannel{}, m_endChannel{};  // what is read of the file
    std::vector<int> m_picks;              // of these
    bool m_divides{};                      // the last pick is alpha
    int m_alpha{-1};                       // of what is read, where it is looked at
    bool m_hasHoles{}, m_hasOpaque{};
    int m_nextRow{};
    int m_bandRow{}, m_bandRows{};  // rows of the data window that are in memory
    std::vector<std::byte> m_band;
    BadTexelCount m_bad;
    struct {
        std::int64_t texels{}, units{};
        double red{}, green{};  // sums
    } m_normals;
};

}  // namespace pm::host
