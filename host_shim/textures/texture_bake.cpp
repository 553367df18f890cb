// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/textures/texture_bake.h"

#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <memory>
#include <new>

#include "host_shim/textures/mip_writer.h"
#include "host_shim/textures/texel_conversion.h"

namespace pm::host {
namespace {

constexpr int kBandRows = 64;
constexpr float kLargestHalf = 65504.0f;
// A file this much smaller than its texels has large even areas.
constexpr std::uint64_t kFlatRatio = 8;

int codesOf(const PictureRows& rows) {
    if (!rows.hasCodes()) return 0;
    return rows.storedType() == OIIO::TypeDesc::UINT8 ? 256 : 65536;
}

// 0 of floats.
float largestCode(OIIO::TypeDesc type) {
    if (type == OIIO::TypeDesc::UINT8) return 255.0f;
    return type == OIIO::TypeDesc::UINT16 ? 65535.0f : 0.0f;
}

// A channel of a normal map of integers, of which the code above the middle stands for 0, as the
// floats of a texture have it: 0 is 0.5.
float centredNormal(float channel, float largest) {
    const float zero = 0.5f * (largest + 1.0f);
    return 0.5f + 0.5f * (channel * largest - zero) / (largest - zero);
}

// What the conversion itself made infinite; a colour outside the rendering space's gamut may well
// have a channel below 0.
void replaceNotFinite(std::vector<float>& values, int channels, BadTexelCount& bad) {
    const auto size = static_cast<std::size_t>(channels);
    for (std::size_t i = 0; i + size <= values.size(); i += size) {
        bool isBad = false;
        for (std::size_t c = i; c < i + size; ++c) {
            if (std::isfinite(values[c])) continue;
            values[c] = 0.0f;
            isBad = true;
        }
        bad.notFinite += isBad ? 1 : 0;
    }
}

// Rows in, rows in the rendering space out.
class RowConverter {
  public:
    RowConverter(PictureRows& rows, TextureKind kind, const SpaceConversion& conversion)
        : RowConverter(rows, kind == TextureKind::kColour, conversion) {
        if (kind == TextureKind::kVector) m_normalCode = largestCode(rows.storedType());
    }

    const TexelConversion& conversion() const { return m_conversion; }

    // The next rows. bad: added to.
    void read(int rowCount, std::vector<float>& values, BadTexelCount& bad) {
        convert(rowCount, values, bad);
        if (m_normalCode > 0)
            for (float& value : values) value = centredNormal(value, m_normalCode);
    }

  private:
    RowConverter(PictureRows& rows, bool isColour, const SpaceConversion& conversion)
        : m_rows(rows),
          m_codes(codesOf(rows)),
          m_conversion(isColour ? conversion : SpaceConversion(), m_codes, rows.channels()),
          m_isPlain(m_codes == 0 && (!isColour || conversion.isIdentity())) {}

    void convert(int rowCount, std::vector<float>& values, BadTexelCount& bad) {
        const std::size_t texels =
            static_cast<std::size_t>(m_rows.width()) * static_cast<std::size_t>(rowCount);
        values.resize(texels * static_cast<std::size_t>(m_conversion.outChannels()));
        if (m_codes == 256) {
            m_rows.readCodes(rowCount, m_codes8);
            m_conversion.apply(m_codes8, values);
        } else if (m_codes != 0) {
            m_rows.readCodes(rowCount, m_codes16);
            m_conversion.apply(m_codes16, values);
        } else if (m_isPlain) {
            m_rows.readRows(rowCount, values);
            return;
        } else {
            m_rows.readRows(rowCount, m_picked);
            m_conversion.apply(m_picked, values);
        }
        if (!std::isfinite(m_conversion.largest()))
            replaceNotFinite(values, m_conversion.outChannels(), bad);
    }

    PictureRows& m_rows;
    int m_codes;
    float m_normalCode = 0;  // of a normal map of integers: the largest
    TexelConversion m_conversion;
    bool m_isPlain;
    std::vector<std::uint8_t> m_codes8;
    std::vector<std::uint16_t> m_codes16;
    std::vector<float> m_picked;
};

struct FreeHash {
    void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
};

}  // namespace

TextureBake::TextureBake(PictureRows& rows, TextureKind kind, const SpaceConversion& conversion)
    : m_rows(rows),
      m_kind(kind),
      m_isColour(kind == TextureKind::kColour),
      m_conversion(conversion) {}

std::uint64_t TextureBake::memoryBytes() const {
    constexpr std::uint64_t kFloatsPerTexel = 16;
    const auto width = static_cast<std::uint64_t>(m_rows.width());
    const bool isHalf = m_isColour && m_rows.storedType().size() <= 2;
    return m_rows.memoryBytes() + width * kBandRows * kFloatsPerTexel * sizeof(float) +
           MipWriter::memoryBytes(
               {m_rows.width(), m_rows.height(), m_rows.channels(), isHalf, false});
}

bool TextureBake::needsNoConversion() const {
    const bool asItIs = !m_isColour || m_conversion.isIdentity();
    const OIIO::TypeDesc type = m_rows.storedType();
    const bool canBeRead = type == OIIO::TypeDesc::HALF || type == OIIO::TypeDesc::FLOAT ||
                           type == OIIO::TypeDesc::UINT8 || type == OIIO::TypeDesc::UINT16;
    return asItIs && canBeRead && m_rows.isPlainTexture();
}

bool TextureBake::inspect(const std::function<void()>& goOn, TextureFacts& facts) {
    const OIIO::TypeDesc type = m_rows.storedType();
    const std::array<std::int64_t, 4> shape = {m_rows.width(), m_rows.height(), m_rows.channels(),
                                               type.basetype};
    const std::unique_ptr<XXH3_state_t, FreeHash> hash(XXH3_createState());
    if (!hash) throw std::bad_alloc();
    XXH3_128bits_reset_withSeed(hash.get(), XXH3_128bits(shape.data(), sizeof shape).low64);
    std::vector<std::byte> bytes;
    std::vector<float> values;
    for (int y = 0; y < m_rows.height(); y += kBandRows) {
        if (goOn) goOn();
        m_rows.readStored(std::min(kBandRows, m_rows.height() - y), bytes);
        XXH3_128bits_update(hash.get(), bytes.data(), bytes.size());
        if (!type.is_floating_point()) continue;
        values.resize(bytes.size() / type.size());
        OIIO::convert_pixel_values(type, bytes.data(), OIIO::TypeDesc::FLOAT, values.data(),
                                   static_cast<int>(values.size()));
        const bool isBad = std::ranges::any_of(values, [this](float value) {
            return !std::isfinite(value) || (m_isColour && value < 0.0f);
        });
        if (isBad) return false;
    }
    const XXH128_hash_t digest = XXH3_128bits_digest(hash.get());
    facts = {m_rows.width(),
             m_rows.height(),
             m_rows.channels(),
             {digest.low64, digest.high64},
             {},
             m_rows.layout().note,
             false,
             false};
    return true;
}

bool TextureBake::isHalf(float largest) const {
    if (!m_isColour) return false;
    const OIIO::TypeDesc type = m_rows.storedType();
    if (type == OIIO::TypeDesc::UINT8) return largest <= kLargestHalf;
    return type == OIIO::TypeDesc::HALF && m_conversion.isIdentity() && !m_rows.divides();
}

TextureFacts TextureBake::bake(CheckedFile& file, const std::filesystem::path& path,
                               const std::filesystem::path& shownName, int threads,
                               const std::function<void()>& goOn) {
    RowConverter converter(m_rows, m_kind, m_conversion);
    const int channels = converter.conversion().outChannels();
    const std::uint64_t texelBytes =
        static_cast<std::uint64_t>(m_rows.width()) * static_cast<std::uint64_t>(m_rows.height()) *
        static_cast<std::uint64_t>(m_rows.channels()) * m_rows.storedType().size();
    MipWriter writer(
        {m_rows.width(), m_rows.height(), channels, isHalf(converter.conversion().largest()),
         m_rows.fileBytes() * kFlatRatio < texelBytes},
        file, path, shownName);
    BadTexelCount bad;
    std::vector<float> band, nextBand;
    const auto read = [&](int y, std::vector<float>& values) {
        if (y < m_rows.height())
            converter.read(std::min(kBandRows, m_rows.height() - y), values, bad);
    };
    // Both: a thread where the system has one left.
    const auto launch =
        threads > 1 ? std::launch::async | std::launch::deferred : std::launch::deferred;
    read(0, band);
    for (int y = 0; y < m_rows.height(); y += kBandRows) {
        if (goOn) goOn();
        // Waited for at the end of this block, whatever the writer throws.
        auto ahead = std::async(launch, [&, y] { read(y + kBandRows, nextBand); });
        writer.addRows(band);
        ahead.get();
        band.swap(nextBand);
    }
    writer.finish(goOn);
    bad.notFinite += m_rows.badTexels().notFinite;
    bad.negative += m_rows.badTexels().negative;
    return {
        m_rows.width(),       m_rows.height(),        channels,          writer.texelHash(), bad,
        m_rows.layout().note, m_rows.isLikeNormals(), m_rows.hasHoles(), m_rows.isCutOut()};
}

}  // namespace pm::host
