// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "plugin/storage/bucket_range.h"
#include "plugin/values/identity.h"

namespace pm::plugin {

enum class PieceKind : std::int32_t { kCheckpoint, kPart, kPhotonMap };

// For messages, as "a checkpoint".
const char* kindName(PieceKind kind);

// What a checkpoint, a part or a photon map says of itself: of which render it is, and how much of
// it. It holds nothing of when or how fast it was made, and of where only whose processor it was,
// so that the same piece has the same bytes wherever that is promised.
struct PieceHead {
    PieceKind kind = PieceKind::kCheckpoint;
    Identity identity;  // all that must be the same in two pieces of one picture
    std::string sceneHash, settingsHash, isa;
    std::string processorVendor;  // of whom the machine was that made it; no reason to refuse it
    std::string photonHash;  // of a part: of the photon map that it was made with; empty: traced
    // By name, as setText takes them: those that change pixels, and what says which pixels and
    // channels there are.
    std::vector<std::pair<std::string, std::string>> settings;
    std::uint32_t passes = 0;  // whole ones, in the sums that follow
    bool sharesNoise = true;  // of a part: SampleRule::sharesNoise, on which its sums' layout hangs
    std::uint32_t bucketCount = 0;
    BucketRange range;

    std::string toJson() const;
    // Errors: CallError(FILE) for anything else than toJson() gives.
    static PieceHead fromJson(std::span<const std::byte> text);
};

}  // namespace pm::plugin
