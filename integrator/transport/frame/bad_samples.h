// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>

#include "integrator/transport/path/direct_light.h"

namespace pm {

// Why a sample can't be added, the worst first.
enum class SampleFault : std::uint8_t { kNan, kInfinite, kNegative };
inline constexpr std::size_t kSampleFaults = 3;

struct FaultySample {
    SampleFault fault = SampleFault::kNan;
    PathClass part = PathClass::kEmission;  // of the light, the first that is wrong

    auto operator<=>(const FaultySample&) const = default;
};

// Samples that were replaced by 0, by their fault, and the first of them; the same whatever the
// order in which they were met.
struct BadSamples {
    struct Place {
        std::uint32_t pass = 0;
        std::int32_t y = 0, x = 0;
        std::uint32_t sample = 0;  // of the pixel
        FaultySample what;

        auto operator<=>(const Place&) const = default;
    };
    std::array<std::uint64_t, kSampleFaults> counts{};
    std::optional<Place> first;

    std::uint64_t total() const { return std::accumulate(counts.begin(), counts.end(), 0ull); }
    void add(const Place& place) {
        ++counts[static_cast<std::size_t>(place.what.fault)];
        if (!first || place < *first) first = place;
    }
    void add(const BadSamples& other) {
        for (std::size_t i = 0; i < kSampleFaults; ++i) counts[i] += other.counts[i];
        if (other.first && (!first || *other.first < *first)) first = other.first;
    }
};

}  // namespace pm
