// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "integrator/values/rect.h"
#include "scheduler/film/frame_store.h"

namespace pm {

// All that a frame store knows of its pixels, as bytes and back: what a checkpoint or a part of a
// frame is made of. A store of the same channels that gets the bytes of a rectangle holds the same
// bits there, and goes on with the next pass as the other would have. The bytes are those of this
// machine's numbers (a float's size and byte order) and have no length or checksum of their own.
// Threads: as FrameStore; each pixel is taken and put between two passes.
class FrameStoreBytes {
  public:
    // The pixels that a store holds: those of its window's atoms.
    static Rect area(const FrameStore& store);

    // Bytes that a pixel takes: depends on the store's channels only.
    static std::size_t bytesPerPixel(const FrameStore& store);

    // Appends the pixels of rect, array by array and in each row by row.
    // Errors: kInvalidArgument when rect is not within area().
    static void append(const FrameStore& store, const Rect& rect, std::vector<std::byte>& bytes);

    // Replaces the pixels of rect by those that append() gave.
    // Errors: kInvalidArgument when rect is not within area() or bytes has another size.
    static void restore(FrameStore& store, const Rect& rect, std::span<const std::byte> bytes);

  private:
    // Calls visit with every array of the store that has elements for each pixel, in an order that
    // is part of the format.
    template <typename Store, typename Visit>
    static void forEachArray(Store& store, Visit visit);
    // Calls visit(first byte of a row in its array, bytes of the row) for every row of every array.
    template <typename Store, typename Visit>
    static void forEachRow(Store& store, const Rect& rect, Visit visit);
};

}  // namespace pm
