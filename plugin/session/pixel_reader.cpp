// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/pixel_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "plugin/session/render.h"
#include "plugin/values/call_error.h"

namespace pm::plugin {

namespace {

// No picture is larger, so a rectangle beyond it is a mistake (and its width can't overflow).
constexpr std::int32_t kMaxCoordinatePixels = 1 << 24;
constexpr float kNoDepth = 1e10f;  // where nothing is hit

struct Destination {
    unsigned char* first;
    std::int64_t pixelStride, rowStride;

    void put(std::int64_t x, std::int64_t y, const float* values, std::size_t count) const {
        std::memcpy(first + y * rowStride + x * pixelStride, values, count * sizeof(float));
    }
};

Rect checkedRectangle(const Rect& rect) {
    for (const std::int32_t coordinate : {rect.x0, rect.y0, rect.x1, rect.y1})
        if (coordinate < -kMaxCoordinatePixels || coordinate > kMaxCoordinatePixels)
            throw argumentError(fmt::format("rectangle has the coordinate {}; it must be {} to {}",
                                            coordinate, -kMaxCoordinatePixels,
                                            kMaxCoordinatePixels));
    if (rect.x1 < rect.x0 || rect.y1 < rect.y0)
        throw argumentError(
            fmt::format("rectangle is [{},{}) x [{},{}); its ends must not come "
                        "before its beginnings",
                        rect.x0, rect.x1, rect.y0, rect.y1));
    return rect;
}

Destination checkedDestination(const Rect& rect, const LayerSpec& layer, float* destination,
                               std::int64_t pixelStride, std::int64_t rowStride) {
    const auto pixelBytes = static_cast<std::int64_t>(layer.channelCount * sizeof(float));
    if (pixelStride == 0) pixelStride = pixelBytes;
    if (rowStride == 0) rowStride = pixelStride * rect.width();
    constexpr std::int64_t kMaxStride = std::int64_t{1} << 40;
    if (std::abs(pixelStride) < pixelBytes || std::abs(pixelStride) > kMaxStride)
        throw argumentError(fmt::format("pixelStrideBytes is {}; layer {} has {} bytes a pixel",
                                        pixelStride, layer.name, pixelBytes));
    if (std::abs(rowStride) < pixelBytes || std::abs(rowStride) > kMaxStride)
        throw argumentError(fmt::format("rowStrideBytes is {}; a row has at least {} bytes",
                                        rowStride, pixelBytes));
    return {reinterpret_cast<unsigned char*>(destination), pixelStride, rowStride};
}

// The first channel that a layer is made of, and how many there are up to its last.
struct ChannelRange {
    std::int32_t first = 0, count = 0;
};

// all: of the frame, which keeps no more than it needs.
ChannelRange channelsOf(Layer layer, const ChannelLayout& layout, std::int32_t all) {
    switch (layer) {
        case Layer::kDirect:
            return {layout.direct, 3};
        case Layer::kIndirect:
            return {layout.indirect, 3};
        case Layer::kCaustic:
            return {layout.caustic, 3};
        case Layer::kEmission:
            return {layout.emission, 3};
        case Layer::kAlbedo:
            return {layout.albedo, 3};
        case Layer::kNormal:
            return {layout.normal, 3};
        default:
            return {0, all};
    }
}

// The value of one layer at a pixel, by its channelsOf(). Beauty is the sum of its parts.
void layerValue(Layer layer, const ChannelLayout& layout, const float* pixel, float* value) {
    switch (layer) {
        case Layer::kBeauty:
            for (int c = 0; c < 3; ++c)
                value[c] = pixel[layout.direct + c] + pixel[layout.indirect + c] +
                           pixel[layout.caustic + c] + pixel[layout.emission + c];
            value[3] = pixel[layout.alpha];
            break;
        case Layer::kDepth:
            value[0] =
                pixel[layout.alpha] > 0.0f ? pixel[layout.depth] / pixel[layout.alpha] : kNoDepth;
            break;
        default:
            std::copy_n(pixel, 3, value);
    }
}

void readMeans(const FrameStore& frame, const ChannelLayout& layout, const Rect& rect,
               const LayerSpec& layer, const Destination& destination) {
    const ChannelRange range = channelsOf(layer.id, layout, frame.channels());
    const auto channels = static_cast<std::size_t>(range.count);
    const auto width = static_cast<std::size_t>(rect.width());
    std::vector<float> row(channels * width), samples(width);
    const auto pixelBytes = static_cast<std::int64_t>(channels * sizeof(float));
    for (std::int32_t y = rect.y0; y < rect.y1; ++y) {
        const Rect line{rect.x0, y, rect.x1, y + 1};
        // The counts first: a pixel that was counted has a value by the time that is read.
        frame.readSampleCount(line, samples.data(), sizeof(float), 0);
        frame.read(line, range.first, range.count, row.data(), pixelBytes, 0);
        for (std::size_t x = 0; x < width; ++x) {
            float value[4] = {};
            if (samples[x] > 0.0f) layerValue(layer.id, layout, row.data() + x * channels, value);
            destination.put(static_cast<std::int64_t>(x), y - rect.y0, value, layer.channelCount);
        }
    }
}

void readLevels(const FrameStore& frame, std::uint32_t passes, const Rect& rect,
                const LayerSpec& layer, const Destination& destination) {
    const auto width = static_cast<std::size_t>(rect.width());
    std::vector<float> samples(width);
    for (std::int32_t y = rect.y0; y < rect.y1; ++y) {
        frame.readSampleCount({rect.x0, y, rect.x1, y + 1}, samples.data(), sizeof(float), 0);
        for (std::size_t x = 0; x < width; ++x) {
            const double inFourPasses =
                4.0 * static_cast<double>(samples[x]) / std::max(1u, passes);
            float level =
                inFourPasses > 0 ? static_cast<float>(1 + 0.5 * std::log2(inFourPasses)) : 0.0f;
            if (frame.showsGroup(rect.x0 + static_cast<std::int32_t>(x), y)) level = 0.0f;
            destination.put(static_cast<std::int64_t>(x), y - rect.y0, &level, layer.channelCount);
        }
    }
}

void clear(const Rect& rect, const LayerSpec& layer, const Destination& destination) {
    const float zero[4] = {};
    for (std::int64_t y = 0; y < rect.height(); ++y)
        for (std::int64_t x = 0; x < rect.width(); ++x)
            destination.put(x, y, zero, layer.channelCount);
}

}  // namespace

std::vector<Layer> layersOf(const SettingValues& settings) {
    std::vector<Layer> layers;
    if (settings.integer(Setting::kPhotonsOnly) != 0) return layers;
    for (const LayerSpec& spec : layerSpecs())
        if (spec.isDefault || settings.wantsLayer(spec.name)) layers.push_back(spec.id);
    return layers;
}

void readLayerPixels(const PixelRequest& request, const SettingValues& settings,
                     const FrameStore* frame, const ChannelLayout& layout, std::uint32_t passes) {
    if (request.layer == nullptr) throw argumentError("layer is null");
    const LayerSpec* spec = findLayer(request.layer);
    const std::vector<Layer> available = layersOf(settings);
    // What every frame holds anyway may be read without being asked for.
    const bool isKept = spec != nullptr &&
                        (spec->id == Layer::kStandardError || spec->id == Layer::kHalfDifference ||
                         spec->id == Layer::kSamples || spec->id == Layer::kAaLevel);
    if (spec == nullptr ||
        (!isKept && std::find(available.begin(), available.end(), spec->id) == available.end()))
        throw CallError(CallStatus::kName,
                        fmt::format("this render has no layer '{}'", request.layer));
    const Rect rect = checkedRectangle(request.rectangle);
    if (request.destination == nullptr) throw argumentError("destination is null");
    if (rect.empty()) return;
    const Destination target = checkedDestination(rect, *spec, request.destination,
                                                  request.pixelStrideBytes, request.rowStrideBytes);
    if (frame == nullptr)
        clear(rect, *spec, target);
    else if (spec->id == Layer::kStandardError)
        frame->readStandardError(rect, request.destination, target.pixelStride, target.rowStride);
    else if (spec->id == Layer::kHalfDifference)
        frame->readHalfDifference(rect, request.destination, target.pixelStride, target.rowStride);
    else if (spec->id == Layer::kSamples)
        frame->readSampleCount(rect, request.destination, target.pixelStride, target.rowStride);
    else if (spec->id == Layer::kAaLevel)
        readLevels(*frame, passes, rect, *spec, target);
    else
        readMeans(*frame, layout, rect, *spec, target);
}

std::vector<Layer> Render::layers() const {
    return layersOf(settings());
}

void Render::readPixels(const Rect& rectangle, const char* layer, float* destination,
                        std::int64_t pixelStrideBytes, std::int64_t rowStrideBytes) const {
    const std::shared_ptr<RenderWork> running = work();
    if (layers().empty())
        throw CallError(CallStatus::kName, "this render traces photons only and has no layers");
    const std::shared_ptr<const FrameStore> frame = running ? running->frame() : nullptr;
    if (running && !frame)
        throw CallError(CallStatus::kState,
                        "the render delivers buckets: pixels can be read inside bucketFinished, "
                        "and are gone after");
    readLayerPixels({rectangle, layer, destination, pixelStrideBytes, rowStrideBytes}, settings(),
                    frame.get(), running ? running->layout() : ChannelLayout{},
                    running ? running->passesOfPixels() : 0);
}

}  // namespace pm::plugin
