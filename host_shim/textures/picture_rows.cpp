// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/textures/picture_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "host_shim/textures/picture_kind.h"
#include "host_shim/textures/stated_colours.h"
#include "host_shim/textures/tiff_tags.h"
#include "host_shim/textures/whole_picture.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

using Values = PictureLayout::Values;

constexpr int kBandRows = 64;
constexpr std::int64_t kLargestSide = std::int64_t{1} << 20;
constexpr std::int64_t kMostTexels = std::int64_t{1} << 32;
constexpr std::uint64_t kLargestTile = std::uint64_t{1} << 24;  // pixels
// Rec.709's; a number has no rendering space.
constexpr std::array kLuminance{0.2126f, 0.7152f, 0.0722f};

std::string withoutBreaks(std::string text) {
    std::ranges::replace(text, '\n', ' ');
    return text;
}

std::uint64_t product(std::int64_t a, std::int64_t b, std::int64_t c) {
    return static_cast<std::uint64_t>(a) * static_cast<std::uint64_t>(b) *
           static_cast<std::uint64_t>(c);
}

}  // namespace

PictureRows::PictureRows(const std::filesystem::path& file, TextureKind kind, char channel)
    : m_file(file), m_format(pictureReader(file)) {
    m_input = m_format.empty() ? nullptr : OIIO::ImageInput::create(m_format);
    if (!m_input) {
        OIIO::geterror();
        throw HostError(ExitCode::kBadInput,
                        fmt::format("texture {} is no picture of a known kind", file.string()));
    }
    // Else OpenImageIO multiplies sRGB-coded values by alpha, in the code's curve.
    OIIO::ImageSpec wishes, first;
    wishes.attribute("oiio:UnassociatedAlpha", 1);
    if (!m_input->open(file.string(), first, wishes))
        throw HostError(ExitCode::kBadInput,
                        fmt::format("texture {} can't be read as a picture: {}", file.string(),
                                    withoutBreaks(m_input->geterror())));
    std::vector<OIIO::ImageSpec> parts{first};
    if (m_format == "openexr")
        while (m_input->seek_subimage(static_cast<int>(parts.size()), 0))
            parts.push_back(m_input->spec());
    m_input->geterror();  // the part past the last
    try {
        m_layout = choosePictureLayout(parts, kind, channel);
    } catch (const HostError& error) {
        throw HostError(error.code(), fmt::format("texture {} {}", file.string(), error.what()));
    }
    m_spec = parts[static_cast<std::size_t>(m_layout.part)];
    if (parts.size() > 1) m_input->seek_subimage(m_layout.part, 0);
    findWindows();
    noteOrientation();
    m_statement = statedColours(m_format, m_file, m_spec, m_layout);

    m_picks = m_layout.channels;
    const bool isStraight = m_spec.get_int_attribute("oiio:UnassociatedAlpha") != 0;
    m_divides = m_layout.alpha >= 0 && !isStraight;
    if (m_divides) m_picks.push_back(m_layout.alpha);
    const bool looksAtAlpha = kind == TextureKind::kColour && m_layout.alpha >= 0;
    const int also = looksAtAlpha ? m_layout.alpha : m_picks[0];
    const auto [low, high] = std::ranges::minmax(m_picks);
    m_firstChannel = std::min(low, also);
    m_endChannel = std::max(high, also) + 1;
    for (int& pick : m_picks) pick -= m_firstChannel;
    if (looksAtAlpha) m_alpha = m_layout.alpha - m_firstChannel;
    const bool isColour = m_layout.values == Values::kColour || m_layout.values == Values::kTwo ||
                          m_layout.values == Values::kXyz;
    m_channels = isColour ? 3 : 1;
    m_type = m_spec.format;
    for (const int c : m_layout.channels)
        if (m_spec.channelformat(c) != m_type) m_type = OIIO::TypeDesc::FLOAT;
}

// Only of these two formats do people mean what lies outside the picture as such.
void PictureRows::findWindows() {
    const bool tiffSaysSo = m_format == "tiff" && (m_spec.full_width != m_spec.width ||
                                                   m_spec.full_height != m_spec.height);
    if (m_format != "openexr" && !tiffSaysSo) {
        m_spec.x = m_spec.y = m_spec.full_x = m_spec.full_y = 0;
        m_spec.full_width = m_spec.width;
        m_spec.full_height = m_spec.height;
    }
    const auto refuse = [&](const std::string& what) {
        throw HostError(ExitCode::kBadInput, fmt::format("texture {} {}", m_file.string(), what));
    };
    // OpenImageIO reads such a file as 8 bits (2.4.7).
    if (m_format == "tiff" && !hasTiffTag(m_file, kTiffBitsPerSample))
        refuse("has no tag BitsPerSample, and so 1 bit a sample, which is not read; write the tag");
    if (m_spec.deep) refuse("is a deep picture, which no texture is");
    if (m_spec.width < 1 || m_spec.height < 1 || m_spec.nchannels < 1) refuse("has no pixels");
    if (m_spec.full_width < 1 || m_spec.full_height < 1) refuse("has an empty display window");
    const std::int64_t texels = std::int64_t{m_spec.full_width} * m_spec.full_height;
    if (std::max({m_spec.full_width, m_spec.full_height, m_spec.width, m_spec.height}) >
            kLargestSide ||
        texels > kMostTexels)
        refuse(fmt::format("has {} x {} texels; at most {} a side and {} together are read",
                           m_spec.full_width, m_spec.full_height, kLargestSide, kMostTexels));
    if (product(m_spec.tile_width, m_spec.tile_height, 1) > kLargestTile)
        refuse(fmt::format("has tiles of {} x {}", m_spec.tile_width, m_spec.tile_height));
}

// Texture coordinates were made for the picture as it is stored.
void PictureRows::noteOrientation() {
    const int orientation = m_spec.get_int_attribute("Orientation", 1);
    if (orientation <= 1) return;
    m_layout.note += fmt::format(
        "{}is to be shown turned or mirrored (orientation {}); it is taken as it is stored",
        m_layout.note.empty() ? "" : "; ", orientation);
}

std::uint64_t PictureRows::memoryBytes() const {
    const std::int64_t rows =
        m_spec.tile_height > 0 ? std::max(m_spec.tile_height, kBandRows) : kBandRows;
    const auto bytes = static_cast<std::int64_t>(m_spec.pixel_bytes(true));
    const std::uint64_t need = product(m_spec.width, rows, std::max<std::int64_t>(bytes, 16) * 2);
    return need + bytesHeldWhole(m_format, m_file, m_spec);
}

std::uint64_t PictureRows::fileBytes() const {
    std::error_code failed;
    const auto bytes = std::filesystem::file_size(m_file, failed);
    return failed ? 0 : bytes;
}

bool PictureRows::isPlainTexture() const {
    constexpr int kSmallestTile = 16, kWidestTile = 512;
    const bool isTiled = m_spec.tile_width >= kSmallestTile && m_spec.tile_width <= kWidestTile &&
                         m_spec.tile_height >= kSmallestTile && m_spec.tile_height <= kWidestTile;
    const bool isWhole = m_spec.x == m_spec.full_x && m_spec.y == m_spec.full_y &&
                         m_spec.width == m_spec.full_width && m_spec.height == m_spec.full_height;
    const bool isAsStored =
        (m_layout.values == Values::kColour && m_layout.channels == std::vector{0, 1, 2} &&
         m_spec.nchannels == 3) ||
        ((m_layout.values == Values::kGrey || m_layout.values == Values::kNumber) &&
         m_spec.nchannels == 1);
    if (!m_spec.channelformats.empty() || !isTiled || !isWhole || !isAsStored ||
        m_layout.part != 0 || m_divides)
        return false;
    // All the way down, or looking up from afar would read whole levels.
    int width = m_spec.width, height = m_spec.height, level = 0;
    while (width > 1 || height > 1) {
        width = std::max(1, width / 2);
        height = std::max(1, height / 2);
        if (!m_input->seek_subimage(0, ++level) || m_input->spec().width != width ||
            m_input->spec().height != height) {
            m_input->geterror();
            m_input->seek_subimage(0, 0);
            return false;
        }
    }
    m_input->seek_subimage(0, 0);
    return true;
}

bool PictureRows::hasCodes() const {
    const bool isPicked = m_layout.values == Values::kColour || m_layout.values == Values::kGrey ||
                          m_layout.values == Values::kNumber;
    return isPicked && !m_divides &&
           (m_type == OIIO::TypeDesc::UINT8 || m_type == OIIO::TypeDesc::UINT16);
}

void PictureRows::failReading(const std::string& text) const {
    throw HostError(ExitCode::kBadInput, fmt::format("texture {} is broken or cut short: {}",
                                                     m_file.string(), withoutBreaks(text)));
}

// Reads the rows from dataRow on that are read together.
template <typename T>
void PictureRows::loadBand(int dataRow, OIIO::TypeDesc type) {
    const bool isTiled = m_spec.tile_width > 0;
    const int step =
        isTiled ? std::max(1, kBandRows / m_spec.tile_height) * m_spec.tile_height : kBandRows;
    m_bandRow = dataRow / step * step;
    m_bandRows = std::min(step, m_spec.height - m_bandRow);
    const auto count = static_cast<std::size_t>(m_endChannel - m_firstChannel);
    m_band.resize(static_cast<std::size_t>(m_spec.width) * static_cast<std::size_t>(m_bandRows) *
                  count * sizeof(T));
    const int y0 = m_spec.y + m_bandRow, y1 = y0 + m_bandRows;
    // In m_spec a window may have been moved to 0.
    const OIIO::ImageSpec stored = m_input->spec_dimensions(m_layout.part, 0);
    const int dx = stored.x, dy = stored.y - m_spec.y;
    const bool good =
        isTiled ? m_input->read_tiles(m_layout.part, 0, dx, dx + m_spec.width, y0 + dy, y1 + dy, 0,
                                      1, m_firstChannel, m_endChannel, type, m_band.data())
                : m_input->read_scanlines(m_layout.part, 0, y0 + dy, y1 + dy, 0, m_firstChannel,
                                          m_endChannel, type, m_band.data());
    // A truncated JPEG or TIFF comes back as read, with a text.
    const std::string text = m_input->geterror();
    if (!good || !text.empty()) failReading(text);
}

// texels: at the alpha of the first.
template <typename T>
void PictureRows::lookForHoles(const T* texels, std::size_t count, std::size_t stride) {
    // Edges of what is opaque, and what a lossy file makes of 1, are above.
    constexpr double kOpaque = 0.9;
    const double full =
        std::numeric_limits<T>::is_integer ? static_cast<double>(std::numeric_limits<T>::max()) : 1;
    for (std::size_t i = 0; i < count && !isCutOut(); ++i)
        (static_cast<double>(texels[i * stride]) < kOpaque * full ? m_hasHoles : m_hasOpaque) =
            true;
}

template <typename T>
void PictureRows::pickRow(int dataRow, std::span<T> row) {
    const auto stored = static_cast<std::size_t>(m_endChannel - m_firstChannel);
    const std::size_t picks = m_picks.size();
    const auto width = static_cast<std::size_t>(m_spec.width);
    const T* from = reinterpret_cast<const T*>(m_band.data()) +
                    static_cast<std::size_t>(dataRow - m_bandRow) * width * stored;
    // Where the data lies in the display window, cut at its sides.
    const std::int64_t left = std::int64_t{m_spec.x} - m_spec.full_x;
    const auto first = static_cast<std::size_t>(std::max<std::int64_t>(0, -left));
    const auto end = static_cast<std::size_t>(
        std::clamp<std::int64_t>(m_spec.full_width - left, 0, m_spec.width));
    if (first >= end) return;
    T* to = row.data() + static_cast<std::size_t>(left + static_cast<std::int64_t>(first)) * picks;
    from += first * stored;
    if (m_alpha >= 0) lookForHoles(from + m_alpha, end - first, stored);
    if (picks == stored && std::ranges::is_sorted(m_picks)) {
        std::copy_n(from, (end - first) * picks, to);
        return;
    }
    for (std::size_t i = first; i < end; ++i, from += stored)
        for (const int pick : m_picks) *to++ = from[pick];
}

template <typename T>
void PictureRows::readPicked(int rowCount, OIIO::TypeDesc type, std::vector<T>& values) {
    const std::size_t rowSize = static_cast<std::size_t>(width()) * m_picks.size();
    values.resize(rowSize * static_cast<std::size_t>(rowCount));
    for (int i = 0; i < rowCount; ++i) {
        const std::span<T> row(values.data() + static_cast<std::size_t>(i) * rowSize, rowSize);
        const std::int64_t dataRow = std::int64_t{m_nextRow++} + m_spec.full_y - m_spec.y;
        const bool isWhole =
            m_spec.x <= m_spec.full_x && std::int64_t{m_spec.x} + m_spec.width >=
                                             std::int64_t{m_spec.full_x} + m_spec.full_width;
        const bool hasData = dataRow >= 0 && dataRow < m_spec.height;
        if (!hasData || !isWhole) std::ranges::fill(row, T{});
        if (!hasData) continue;
        const int inData = static_cast<int>(dataRow);
        if (inData < m_bandRow || inData >= m_bandRow + m_bandRows) loadBand<T>(inData, type);
        pickRow<T>(inData, row);
    }
}

void PictureRows::readCodes(int rowCount, std::vector<std::uint8_t>& codes) {
    readPicked(rowCount, OIIO::TypeDesc::UINT8, codes);
}

void PictureRows::readCodes(int rowCount, std::vector<std::uint16_t>& codes) {
    readPicked(rowCount, OIIO::TypeDesc::UINT16, codes);
}

void PictureRows::readStored(int rowCount, std::vector<std::byte>& bytes) {
    const auto read = [&]<typename T>(std::vector<T> values) {
        readPicked(rowCount, m_type, values);
        bytes.resize(values.size() * sizeof(T));
        std::memcpy(bytes.data(), values.data(), bytes.size());
    };
    if (m_type.size() == 1)
        read(std::vector<std::uint8_t>());
    else if (m_type.size() == 2)
        read(std::vector<std::uint16_t>());
    else
        read(std::vector<float>());
}

void PictureRows::lookForNormal(const float* colour) {
    constexpr float kTolerance = 0.1f;
    const auto component = [&](int c) { return 2 * colour[c] - 1; };
    const float x = component(0), y = component(1), z = component(2);
    const bool isUnit = z > 0 && std::fabs(std::sqrt(x * x + y * y + z * z) - 1) < kTolerance;
    ++m_normals.texels;
    m_normals.units += isUnit ? 1 : 0;
    m_normals.red += static_cast<double>(colour[0]);
    m_normals.green += static_cast<double>(colour[1]);
}

bool PictureRows::isLikeNormals() const {
    constexpr double kMost = 0.9, kMiddle = 0.5, kOff = 0.1;
    const auto texels = static_cast<double>(m_normals.texels);
    const auto isMiddle = [&](double sum) { return std::fabs(sum / texels - kMiddle) < kOff; };
    return texels > 0 && static_cast<double>(m_normals.units) > kMost * texels &&
           isMiddle(m_normals.red) && isMiddle(m_normals.green);
}

void PictureRows::readRows(int rowCount, std::vector<float>& values) {
    std::vector<float> picked;
    readPicked(rowCount, OIIO::TypeDesc::FLOAT, picked);
    const std::size_t picks = m_picks.size();
    const std::size_t taken = m_layout.channels.size();
    const auto out = static_cast<std::size_t>(m_channels);
    const bool isNumber =
        m_layout.values == Values::kNumber || m_layout.values == Values::kLuminance;
    const std::size_t texels = picked.size() / picks;
    values.assign(texels * out, 0.0f);
    for (std::size_t i = 0; i < texels; ++i) {
        float* texel = &picked[i * picks];
        if (m_divides && texel[taken] > 0.0f)
            for (std::size_t c = 0; c < taken; ++c) texel[c] /= texel[taken];
        bool notFinite = false, negative = false;
        for (std::size_t c = 0; c < taken; ++c) {
            // One of them would spread over whole mip levels.
            if (!std::isfinite(texel[c])) {
                texel[c] = 0.0f;
                notFinite = true;
            } else if (texel[c] < 0.0f && !isNumber) {
                texel[c] = 0.0f;
                negative = true;
            }
        }
        m_bad.notFinite += notFinite ? 1 : 0;
        m_bad.negative += negative && !notFinite ? 1 : 0;
        if (m_layout.values == Values::kLuminance) {
            lookForNormal(texel);
            const bool isGrey = texel[0] == texel[1] && texel[1] == texel[2];
            values[i] = isGrey ? texel[0]
                               : kLuminance[0] * texel[0] + kLuminance[1] * texel[1] +
                                     kLuminance[2] * texel[2];
        } else {
            std::copy_n(texel, taken, &values[i * out]);
        }
    }
}

bool hasAlpha(const std::filesystem::path& file) {
    try {
        return PictureRows(file, TextureKind::kColour, 0).layout().alpha >= 0;
    } catch (const HostError&) {
        return false;
    }
}

}  // namespace pm::host
