// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/textures/tiff_tags.h"

#include <algorithm>
#include <array>
#include <fstream>

namespace pm::host {
namespace {

class TiffNumbers {
  public:
    explicit TiffNumbers(const std::filesystem::path& file) : m_stream(file, std::ios::binary) {
        std::array<char, 2> order{};
        m_stream.read(order.data(), order.size());
        m_isLittle = order[0] == 'I';
    }
    // The next number of so many bytes; 0 past the end.
    std::uint64_t next(int bytes) {
        std::array<char, 8> read{};
        m_stream.read(read.data(), bytes);
        std::uint64_t number = 0;
        for (int i = 0; i < bytes; ++i) {
            const int at = m_isLittle ? bytes - 1 - i : i;
            number = number << 8 | static_cast<unsigned char>(read[static_cast<std::size_t>(at)]);
        }
        return m_stream ? number : 0;
    }
    void seek(std::uint64_t place) { m_stream.seekg(static_cast<std::streamoff>(place)); }
    void skip(int bytes) { m_stream.ignore(bytes); }
    bool good() const { return static_cast<bool>(m_stream); }

  private:
    std::ifstream m_stream;
    bool m_isLittle{};
};

}  // namespace

bool hasTiffTag(const std::filesystem::path& file, std::uint16_t tag) {
    constexpr std::uint64_t kBig = 43, kMostEntries = 65535;
    TiffNumbers numbers(file);
    const bool isBig = numbers.next(2) == kBig;
    if (isBig) numbers.skip(4);
    numbers.seek(numbers.next(isBig ? 8 : 4));
    const std::uint64_t count = std::min(numbers.next(isBig ? 8 : 2), kMostEntries);
    for (std::uint64_t i = 0; i < count && numbers.good(); ++i) {
        if (numbers.next(2) == tag) return true;
        numbers.skip(isBig ? 18 : 10);
    }
    return !numbers.good() || count == 0;
}

}  // namespace pm::host
