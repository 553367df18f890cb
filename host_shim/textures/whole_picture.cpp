// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/textures/whole_picture.h"

#include <algorithm>
#include <array>
#include <fstream>

namespace pm::host {
namespace {

std::uint64_t product(std::int64_t a, std::int64_t b, std::int64_t c) {
    return static_cast<std::uint64_t>(a) * static_cast<std::uint64_t>(b) *
           static_cast<std::uint64_t>(c);
}

std::uint64_t byteAt(const std::string& bytes, std::size_t at) {
    return at < bytes.size() ? static_cast<unsigned char>(bytes[at]) : 0;
}

std::uint64_t twoBytesAt(const std::string& bytes, std::size_t at) {
    return byteAt(bytes, at) << 8 | byteAt(bytes, at + 1);
}

// One segment after the other: a marker, and what follows its length.
class JpegSegments {
  public:
    explicit JpegSegments(const std::filesystem::path& file) : m_stream(file, std::ios::binary) {
        m_stream.ignore(2);  // the beginning of the picture
    }

    bool next() {
        int byte = m_stream.get();
        while (byte == kMark) byte = m_stream.get();  // filled up, or the mark itself
        m_marker = byte;
        std::array<char, 2> size{};
        if (!m_stream.read(size.data(), size.size())) return false;
        const std::uint64_t length = twoBytesAt({size.begin(), size.end()}, 0);
        if (length < size.size()) return false;
        m_bytes.resize(length - size.size());
        return static_cast<bool>(
            m_stream.read(m_bytes.data(), static_cast<std::streamsize>(m_bytes.size())));
    }
    int marker() const { return m_marker; }
    const std::string& bytes() const { return m_bytes; }

  private:
    static constexpr int kMark = 0xff;

    std::ifstream m_stream;
    int m_marker{};
    std::string m_bytes;
};

bool isFrame(int marker) {
    // Between them lie tables: of codes, of arithmetic coding; and one that is reserved.
    return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

bool isProgressive(int marker) {
    return marker == 0xc2 || marker == 0xc6 || marker == 0xca || marker == 0xce;
}

// Of a frame's header: all coefficients, of 2 bytes, in blocks of 8 x 8, as many of each component
// as the sampling says, up to whole groups of them.
std::uint64_t coefficientBytes(const std::string& frame) {
    constexpr std::size_t kHead = 6, kOfComponent = 3;
    constexpr std::uint64_t kSide = 8, kBytesOfBlock = 2 * kSide * kSide;
    const std::uint64_t height = twoBytesAt(frame, 1), width = twoBytesAt(frame, 3);
    std::uint64_t across = 1, down = 1, blocks = 0;
    for (std::size_t c = 0; c < byteAt(frame, 5); ++c) {
        const std::uint64_t sampling = byteAt(frame, kHead + kOfComponent * c + 1);
        across = std::max(across, sampling >> 4);
        down = std::max(down, sampling & 15u);
        blocks += (sampling >> 4) * (sampling & 15u);
    }
    const auto groups = [](std::uint64_t size, std::uint64_t side) {
        return (size + side - 1) / side;
    };
    return groups(width, kSide * across) * groups(height, kSide * down) * blocks * kBytesOfBlock;
}

// Where a scan has not all components, or not all of their bits, the whole picture's coefficients
// are gathered before there is a row.
std::uint64_t jpegBytes(const std::filesystem::path& file) {
    constexpr int kScan = 0xda;
    JpegSegments segments(file);
    std::string frame;
    bool isWhole = false;
    while (segments.next() && segments.marker() != kScan)
        if (isFrame(segments.marker())) {
            frame = segments.bytes();
            isWhole = isProgressive(segments.marker());
        }
    if (segments.marker() != kScan || frame.empty()) return 0;
    isWhole = isWhole || byteAt(segments.bytes(), 0) < byteAt(frame, 5);
    return isWhole ? coefficientBytes(frame) : 0;
}

bool isInterlacedPng(const std::filesystem::path& file) {
    constexpr std::size_t kPlace = 28;  // in the header, which is the first chunk
    std::array<char, kPlace + 1> head{};
    std::ifstream stream(file, std::ios::binary);
    return stream.read(head.data(), head.size()) && head[kPlace] != 0;
}

}  // namespace

std::uint64_t bytesHeldWhole(const std::string& format, const std::filesystem::path& file,
                             const OIIO::ImageSpec& spec) {
    const auto bytes = static_cast<std::int64_t>(spec.pixel_bytes(true));
    const std::uint64_t whole = product(spec.width, spec.height, bytes);
    if (format == "jpeg") return jpegBytes(file);
    if (format == "png") return isInterlacedPng(file) ? whole : 0;
    if (format == "openexr" || format == "hdr") return 0;
    if (format != "tiff") return whole;
    if (spec.tile_width > 0) return 0;
    const int strip = spec.get_int_attribute("tiff:RowsPerStrip", spec.height);
    return product(spec.width, std::min(strip, spec.height), bytes);
}

}  // namespace pm::host
