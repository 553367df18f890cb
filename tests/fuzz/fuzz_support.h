// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What fuzzers share: a folder of their own, files in it, and bytes taken one value after the
// other.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace pm::fuzz {

// A folder for this process, removed when it ends well.
const std::string& folder();

// Writes a file in folder() and returns its whole name.
std::string writeFile(const std::string& name, std::string_view bytes);

// The bytes of a fuzzer's input as text.
inline std::string_view textOf(const std::uint8_t* data, std::size_t size) {
    return {reinterpret_cast<const char*>(data), size};
}

// A file of pieces (checkpoint, part, photon map) with its magic and checksums put right, as far as
// its records go: no fuzzer would find one.
std::string withChecksums(std::string_view bytes);

// Takes values from the input's front; zeros, once it is used up.
class Bytes {
  public:
    Bytes(const std::uint8_t* data, std::size_t size) : m_data(data), m_left(size) {}

    bool isEmpty() const { return m_left == 0; }
    template <typename Value>
    Value take() {
        Value value{};
        const std::size_t count = m_left < sizeof value ? m_left : sizeof value;
        if (count > 0) std::memcpy(static_cast<void*>(&value), m_data, count);
        m_data += count;
        m_left -= count;
        return value;
    }
    std::uint32_t below(std::uint32_t limit) { return take<std::uint8_t>() % limit; }
    // A number of any size, small ones and odd ones often.
    double number();
    float single() { return static_cast<float>(number()); }
    std::string text(std::size_t most);

  private:
    const std::uint8_t* m_data;
    std::size_t m_left;
};

}  // namespace pm::fuzz
