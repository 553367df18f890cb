// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The size rules of the interface's structs, in one place.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <type_traits>

#include "plugin/values/call_error.h"

namespace pm::plugin {

// No struct of any version is larger; whoever gives more forgot to set the size.
inline constexpr std::uint64_t kMaxStructBytes = 65536;

// The size member of a caller's struct, checked. Throws CallError when the pointer is null, the
// size is none, or what lies beyond the struct as we know it is not zero: that would be a wish that
// this version can't grant.
inline std::uint64_t checkedStructSize(const void* given, std::uint64_t knownBytes,
                                       std::string_view type) {
    if (given == nullptr) throw argumentError(fmt::format("{}: the pointer is null", type));
    std::uint64_t size = 0;
    std::memcpy(&size, given, sizeof size);
    if (size < sizeof size || size > kMaxStructBytes)
        throw argumentError(
            fmt::format("{}: size is {}; it must be the size in bytes that the "
                        "caller was compiled with ({} in this version)",
                        type, size, knownBytes));
    const auto* bytes = static_cast<const unsigned char*>(given);
    for (std::uint64_t i = knownBytes; i < size; ++i) {
        if (bytes[i] != 0)
            throw argumentError(
                fmt::format("{}: byte {} of {} is not zero, but this version of the "
                            "library knows {} bytes only",
                            type, i, size, knownBytes));
    }
    return size;
}

// A caller's struct in the form that we know: zero where the caller's is shorter.
template <typename Struct>
Struct readStruct(const Struct* given, std::string_view type) {
    static_assert(std::is_trivially_copyable_v<Struct>);
    const std::uint64_t size = checkedStructSize(given, sizeof(Struct), type);
    Struct known{};
    std::memcpy(&known, given, std::min<std::uint64_t>(size, sizeof(Struct)));
    known.size = sizeof(Struct);
    return known;
}

// Fills a caller's struct as far as it goes; its size member stays as it is.
template <typename Struct>
void writeStruct(Struct* destination, const Struct& value, std::string_view type) {
    static_assert(std::is_trivially_copyable_v<Struct>);
    const std::uint64_t size = checkedStructSize(destination, sizeof(Struct), type);
    Struct filled = value;
    filled.size = size;
    std::memcpy(destination, &filled, std::min<std::uint64_t>(size, sizeof(Struct)));
}

}  // namespace pm::plugin
