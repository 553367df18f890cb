// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// All that a host may choose without a say in the picture, and the picture that every choice is
// held against: P14 and P16 of the paper of Yavuz et al. 2010.
#pragma once

#include <oneapi/tbb/global_control.h>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tests/determinism/covering_set.h"
#include "tests/determinism/picture_way.h"

namespace pm::test {

inline constexpr PmrRectangle kSameBitsFrame = {0, 0, 96, 72};

// The frame with all layers, adaptive samples and more photons than are traced in one batch. Three
// passes: the third is by need, and a render may be cancelled within the second.
Settings pairSettings();
// For all combinations, which are many: less time, and besides pixels of four that begin as one and
// are divided after the second pass. Few photons, but more than a batch where one bucket holds any
// window: their tracing knows no buckets, and renders are fewest there.
Settings fullMatrixSettings(bool isOneBucket);
// Whether one bucket of the way holds any window of the matrix.
bool isOneBucket(const Way& way);

// All combinations of threads, bucket size, order, window, resuming, parts, flush-to-zero and
// locale, in an order that depends on the library's list of bucket orders only.
class SameBitsMatrix {
  public:
    SameBitsMatrix();

    const Combinations& all() const { return m_all; }
    // Those that can be made here: without a locale with a comma, half of them.
    Combinations possible() const;
    bool isPossible(const Combination& combination) const;
    Way wayOf(const Combination& combination) const;

  private:
    std::vector<std::string> m_orders;
    Combinations m_all;
    bool m_hasCommaLocale;
};

// Indices of the share-th of so many shares of `count` things, from 1: every shares-th. All shares
// together have each once.
std::vector<std::size_t> indicesOfShare(std::size_t count, std::size_t share, std::size_t shares);

// The scene with every kind of transport, rendered in any way; files go to a folder of its own.
// While one lives TBB may have 8 threads on any machine: real concurrency.
class SameBitsStudio {
  public:
    explicit SameBitsStudio(Settings settings);
    ~SameBitsStudio();
    SameBitsStudio(const SameBitsStudio&) = delete;
    SameBitsStudio& operator=(const SameBitsStudio&) = delete;

    LayeredPicture make(const Way& way);
    // Empty where the picture has the bits of a plain render of more than the frame, by one
    // thread, which the first call makes.
    std::string differenceOf(const Way& way);
    const Interruptions& interruptions() const { return m_interruptions; }

  private:
    oneapi::tbb::global_control m_limit{oneapi::tbb::global_control::max_allowed_parallelism, 8};
    Settings m_settings;
    std::filesystem::path m_folder;
    std::string m_texture;
    std::optional<LayeredPicture> m_expected;
    Interruptions m_interruptions;
};

}  // namespace pm::test
