// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/merge.h"

#include <fmt/format.h>

#include <algorithm>

#include "integrator/values/error.h"
#include "plugin/session/frame_samples.h"
#include "plugin/session/memory_limit.h"
#include "plugin/session/pixel_reader.h"
#include "plugin/session/statistics_json.h"
#include "plugin/storage/part_file.h"
#include "plugin/values/call_error.h"
#include "plugin/values/version.h"
#include "scheduler/buckets/bucket_grid.h"
#include "scheduler/film/frame_store_bytes.h"

namespace pm::plugin {

namespace {

CallError refusal(CallStatus status, const std::string& file, const std::string& why) {
    return {status, fmt::format("{}: {}", file, why)};
}

// Another build may have other settings, so it is told apart before they are looked at.
void checkBuild(const std::string& file, const PieceHead& head) {
    Identity theirs;
    for (const IdentityPart& part : head.identity)
        if (part.name == "build") theirs.push_back(part);
    if (const std::string text = differences(theirs, buildIdentity()); !text.empty())
        throw refusal(CallStatus::kMismatch, file,
                      "the part is of another picture; it differs in: " + text);
}

// A head may claim any size: before memory is taken for that.
void checkSize(const std::string& file, const PieceHead& head, const RenderSettings& render) {
    constexpr std::uint64_t kMostOfBucket = 1024 * 1024;  // pixels, by the setting bucketSize
    const Rect area = wholeAtoms(render.window);
    const auto pixels = static_cast<std::uint64_t>(area.area());
    if (head.bucketCount > pixels / (kAtomSizePixels * kAtomSizePixels) ||
        pixels / kMostOfBucket > head.bucketCount)
        throw refusal(CallStatus::kFile, file,
                      fmt::format("its head is broken: {} buckets for {} x {} pixels",
                                  head.bucketCount, area.width(), area.height()));
    const std::uint64_t bytes =
        frameMemoryBytes(render) + std::uint64_t{head.bucketCount} * sizeof(std::string);
    const std::uint64_t left = memoryLeftBytes(0.0);
    if (bytes > left)
        throw refusal(
            CallStatus::kMemory, file,
            fmt::format("its picture of {} x {} pixels takes {:.3f} GiB of memory; {:.3f} GiB "
                        "are left",
                        render.window.width(), render.window.height(), toGib(bytes), toGib(left)));
}

}  // namespace

Merge::Picture::Picture(PieceHead partHead, std::string fileName)
    : head(std::move(partHead)), firstFile(std::move(fileName)) {
    for (const auto& [name, value] : head.settings) settings.setText(name, value);
    settings.setInteger("passes", head.passes);
    const RenderSettings render = settings.toRenderSettings();
    checkSize(firstFile, head, render);
    layout = channelLayout(render);
    errorScale = render.errorScale.value_or(ErrorScale());
    frame = std::make_unique<FrameStore>(makeFrame(render, head.sharesNoise, errorScale));
    files.resize(head.bucketCount);
}

void Merge::checkFits(const std::string& file, const PieceHead& head) const {
    const PieceHead& first = m_picture->head;
    const std::string text = differences(head.identity, first.identity);
    if (!text.empty() || head.bucketCount != first.bucketCount)
        throw refusal(CallStatus::kMismatch, file,
                      fmt::format("the part is of another picture than {}; it differs in: {}",
                                  m_picture->firstFile, text));
}

// Photon maps that fit the same scene and settings are the same, unless one of them is wrong.
void Merge::checkPhotons(const std::string& file, const PieceHead& head) {
    std::string& known = m_picture->head.photonHash;
    if (known.empty()) known = head.photonHash;
    if (!head.photonHash.empty() && head.photonHash != known)
        throw refusal(
            CallStatus::kMismatch, file,
            fmt::format("the part is of another picture than {}; it differs in: photon map",
                        m_picture->firstFile));
}

// Of the settings that a part keeps, the one in which parts of one picture may differ.
void Merge::keepNote(const PieceHead& head) {
    SettingValues theirs;
    for (const auto& [name, value] : head.settings) theirs.setText(name, value);
    const std::string& note = theirs.word(Setting::kHostNote);
    std::vector<std::string>& notes = m_picture->notes;
    if (std::ranges::find(notes, note) == notes.end()) notes.push_back(note);
    m_picture->settings.setText("hostNote", fmt::format("{}", fmt::join(notes, "\n")));
}

// Told, and no reason to refuse: unlike processors may have made unlike bits.
void Merge::keepVendor(const PieceHead& head) {
    std::vector<std::string>& vendors = m_picture->vendors;
    if (!head.processorVendor.empty() &&
        std::ranges::find(vendors, head.processorVendor) == vendors.end())
        vendors.push_back(head.processorVendor);
}

void Merge::addPart(const std::string& file) {
    const std::lock_guard lock(m_mutex);
    std::uint32_t index = 0;
    BucketRange range;
    readPart(
        file,
        [&](const PieceHead& head) {
            checkBuild(file, head);
            range = head.range;
            if (range.last > head.bucketCount)
                throw refusal(CallStatus::kFile, file, "its range is broken");
            index = range.first;
            if (m_picture)
                checkFits(file, head);
            else
                m_picture = std::make_unique<Picture>(head, file);
            checkPhotons(file, head);
            keepNote(head);
            keepVendor(head);
            const FrameStore& frame = *m_picture->frame;
            return FrameStoreBytes::bytesPerPixel(frame) *
                   static_cast<std::uint64_t>(FrameStoreBytes::area(frame).area());
        },
        [&](const Rect& rect, std::span<const std::byte> sums) {
            addBucket(file, index++, rect, sums);
        });
    std::fill(m_picture->files.begin() + range.first, m_picture->files.begin() + range.last, file);
}

void Merge::addBucket(const std::string& file, std::uint32_t index, const Rect& rect,
                      std::span<const std::byte> sums) {
    const std::string& other = m_picture->files.at(index);
    m_picture->bucketSize = std::max({m_picture->bucketSize, rect.width(), rect.height()});
    if (other.empty()) {
        try {
            FrameStoreBytes::restore(*m_picture->frame, rect, sums);
        } catch (const Error& error) {
            throw refusal(CallStatus::kFile, file, error.what());
        }
        return;
    }
    // An engine may run a task twice: then both made the same bytes, or one of them is wrong.
    std::vector<std::byte> present;
    FrameStoreBytes::append(*m_picture->frame, rect, present);
    if (!std::equal(present.begin(), present.end(), sums.begin(), sums.end()))
        throw refusal(CallStatus::kMismatch, file,
                      fmt::format("bucket {} has other pixels than in {}", index, other));
}

const Merge::Picture& Merge::picture() const {
    if (!m_picture) throw CallError(CallStatus::kState, "no part was added yet");
    return *m_picture;
}

std::string Merge::missing() const {
    const std::lock_guard lock(m_mutex);
    std::vector<bool> present;
    for (const std::string& file : picture().files) present.push_back(!file.empty());
    std::string text;
    for (const BucketRange& range : missingRanges(present)) text += rangeText(range) + "\n";
    return text;
}

std::string Merge::settingText(std::string_view name) const {
    const std::lock_guard lock(m_mutex);
    return picture().settings.text(name);
}

std::vector<Layer> Merge::layers() const {
    const std::lock_guard lock(m_mutex);
    return layersOf(picture().settings);
}

void Merge::readPixels(const Rect& rectangle, const char* layer, float* destination,
                       std::int64_t pixelStrideBytes, std::int64_t rowStrideBytes) const {
    const std::lock_guard lock(m_mutex);
    readLayerPixels({rectangle, layer, destination, pixelStrideBytes, rowStrideBytes},
                    picture().settings, picture().frame.get(), picture().layout,
                    picture().head.passes);
}

std::string Merge::statisticsJson() const {
    const std::lock_guard lock(m_mutex);
    const PieceHead& head = picture().head;
    Json json;
    json["schema"] = "pm-stats/1";
    json["versions"] = versionsJson();
    json["hashes"] = {{"scene", head.sceneHash}, {"settings", head.settingsHash}};
    if (!head.photonHash.empty()) json["photonMap"] = {{"use", "read"}, {"hash", head.photonHash}};
    json["isa"] = head.isa;
    json["processorVendors"] = picture().vendors;
    json["stopReason"] = "passes done";
    json["status"] = static_cast<std::int32_t>(CallStatus::kOk);
    json["error"] = "";
    json["passesDone"] = head.passes;
    json["passesPlanned"] = head.passes;
    addError(picture().frame->estimateError(), picture().errorScale, json);
    json["buckets"] = {{"count", head.bucketCount}, {"sizePixels", picture().bucketSize}};
    json["settings"] = settingsJson(picture().settings);
    return json.dump(2);
}

}  // namespace pm::plugin
