// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "integrator/transport/frame_renderer.h"
#include "plugin/session/layer_table.h"
#include "plugin/session/setting_values.h"
#include "plugin/storage/piece_head.h"
#include "scheduler/film/frame_store.h"

namespace pm::plugin {

// Parts of one picture, put together. The first part says which picture it is.
// Threads: any; one call after the other.
class Merge {
  public:
    // Adds the buckets of a part. A refusal adds none. Errors: those of readPart;
    // CallError(MISMATCH) where the part is of another picture, saying what differs, or its pixels
    // are not those that another part has.
    void addPart(const std::string& file);

    // Of what follows, CallError(STATE) before the first part.
    std::string missing() const;  // "A:B", one a line
    std::string settingText(std::string_view name) const;
    std::string statisticsJson() const;
    std::vector<Layer> layers() const;
    void readPixels(const Rect& rectangle, const char* layer, float* destination,
                    std::int64_t pixelStrideBytes, std::int64_t rowStrideBytes) const;

  private:
    struct Picture {
        explicit Picture(PieceHead partHead, std::string fileName);
        PieceHead head;
        std::string firstFile;
        SettingValues settings;
        ChannelLayout layout;
        ErrorScale errorScale;
        std::unique_ptr<FrameStore> frame;
        std::int32_t bucketSize = 0;       // pixels; of the buckets that are there
        std::vector<std::string> notes;    // of the host, in the order in which they came
        std::vector<std::string> vendors;  // of the processors that made them, each once
        std::vector<std::string> files;    // of which part each bucket is, in order; empty: missing
    };
    const Picture& picture() const;
    void checkPhotons(const std::string& file, const PieceHead& head);
    void checkFits(const std::string& file, const PieceHead& head) const;
    void keepNote(const PieceHead& head);
    void keepVendor(const PieceHead& head);
    void addBucket(const std::string& file, std::uint32_t index, const Rect& rect,
                   std::span<const std::byte> sums);

    mutable std::mutex m_mutex;
    std::unique_ptr<Picture> m_picture;
};

}  // namespace pm::plugin
