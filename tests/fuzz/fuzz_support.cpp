// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/fuzz/fuzz_support.h"

#include <stdlib.h>
#include <xxhash.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>

// OpenImageIO 2.4.7 deletes its texture system under another type than it was made with.
extern "C" __attribute__((visibility("default"), used)) const char* __asan_default_options() {
    return "new_delete_type_mismatch=0:detect_leaks=1";
}

namespace pm::fuzz {

const std::string& folder() {
    static const struct Folder {
        std::string name;

        Folder() {
            std::error_code none;
            const bool hasMemory = std::filesystem::is_directory("/dev/shm", none);
            name = hasMemory ? "/dev/shm/pm_fuzz.XXXXXX" : "/tmp/pm_fuzz.XXXXXX";
            if (mkdtemp(name.data()) == nullptr) abort();
        }
        ~Folder() {
            std::error_code ignored;
            std::filesystem::remove_all(name, ignored);
        }
    } folder;
    return folder.name;
}

std::string writeFile(const std::string& name, std::string_view bytes) {
    std::string whole = folder() + "/" + name;
    std::ofstream(whole, std::ios::binary)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return whole;
}

// As in plugin/storage/piece_file.cpp: the magic, then records, each with kind, a reserved number,
// length and checksum.
std::string withChecksums(std::string_view bytes) {
    constexpr std::string_view kMagic = "pmpiece1";
    constexpr std::size_t kHeadBytes = 24;
    std::string file(bytes);
    if (file.size() < kMagic.size()) return file;
    file.replace(0, kMagic.size(), kMagic);
    std::size_t at = kMagic.size();
    while (file.size() - at >= kHeadBytes) {
        std::uint32_t kind = 0;
        std::uint64_t length = 0;
        std::memcpy(&kind, &file[at], sizeof kind);
        std::memcpy(&length, &file[at + 8], sizeof length);
        if (length > file.size() - at - kHeadBytes) break;
        const std::uint64_t checksum = XXH3_64bits_withSeed(file.data() + at + kHeadBytes, length,
                                                            (std::uint64_t{kind} << 32) ^ length);
        std::memcpy(&file[at + 16], &checksum, sizeof checksum);
        at += kHeadBytes + length;
    }
    return file;
}

double Bytes::number() {
    using Limits = std::numeric_limits<double>;
    constexpr std::array<double, 12> kOdd = {0.0,
                                             -0.0,
                                             1.0,
                                             -1.0,
                                             0.5,
                                             1e30,
                                             1e-9,
                                             1e300,
                                             Limits::max(),
                                             Limits::denorm_min(),
                                             Limits::infinity(),
                                             Limits::quiet_NaN()};
    const std::uint8_t kind = take<std::uint8_t>();
    if (kind < 64) return kOdd[kind % kOdd.size()];
    if (kind < 224) return static_cast<double>(take<std::int8_t>()) / 16;
    return take<double>();
}

std::string Bytes::text(std::size_t most) {
    std::string text;
    for (std::uint32_t left = below(static_cast<std::uint32_t>(most) + 1); left > 0; --left)
        text += static_cast<char>(take<std::uint8_t>());
    return text;
}

}  // namespace pm::fuzz
