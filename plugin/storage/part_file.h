// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "integrator/values/rect.h"
#include "plugin/storage/piece_head.h"
#include "scheduler/film/frame_store.h"

namespace pm::plugin {

// A part of a picture: the sums of a run of its buckets after all passes, as a piece. The same part
// has the same bytes wherever and however often it is made.

// Whether a part of that name can be written, before any work. Errors: CallError(IO).
void checkPartIsWritable(const std::string& file);

// Writes the buckets, in their order; the file takes its name when it is whole and synced. A full
// disk leaves nothing. Errors: CallError(IO).
void writePart(const std::string& file, const PieceHead& head, const FrameStore& frame,
               std::span<const Rect> buckets);

// Reads a part: its head, then each bucket's rectangle and sums. All is checked before the first
// bucket is given. onHead returns the most bytes that sums of a bucket may have. Errors:
// CallError(IO) when it can't be read; CallError(FILE) when it is no part, cut short or damaged;
// those of the functions.
void readPart(const std::string& file, const std::function<std::uint64_t(const PieceHead&)>& onHead,
              const std::function<void(const Rect&, std::span<const std::byte>)>& onBucket);

}  // namespace pm::plugin
