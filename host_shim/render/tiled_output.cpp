// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/render/tiled_output.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "host_shim/render/picture_assembly.h"

namespace pm::host {
namespace {

// What tiles and buckets both begin at.
constexpr std::int32_t kAtomPixels = 8;

// The side of the run's buckets; where the setting leaves it to the library, only this tells.
std::int32_t bucketSizeOf(const RenderRun& run) {
    const auto json = nlohmann::json::parse(run.statistics(), nullptr, false);
    const auto buckets = json.find("buckets");
    const std::int32_t size =
        buckets == json.end() ? 0 : buckets->value("sizePixels", std::int32_t{0});
    if (size < kAtomPixels)
        throw HostError(ExitCode::kInternal, "the plugin doesn't tell the size of its buckets");
    return size;
}

}  // namespace

std::string needsWholePicture(const Options& options) {
    if (!options.report.empty()) return fmt::format("--report {}", options.report.string());
    if (!options.reference.empty())
        return fmt::format("--reference {}", options.reference.string());
    for (const auto& output : options.outputs)
        if (isDisplayReferred(pictureFormat(output))) return fmt::format("-o {}", output.string());
    const PixelRect window = dataWindowOf(options);
    if (window.x0 % kAtomPixels != 0 || window.y0 % kAtomPixels != 0)
        return fmt::format("--crop from {},{}, which are no multiples of {},", window.x0, window.y0,
                           kAtomPixels);
    return {};
}

TiledOutput::TiledOutput(const RenderRun& run, const Options& options, const ColourPipeline& colour)
    : m_run(run), m_options(options), m_colour(colour) {}

void TiledOutput::begin() {
    const std::int32_t tilePixels = bucketSizeOf(m_run);
    Picture head = assembleHead(m_run, m_options, m_colour, false);
    // All of them when the file gets its name; without it the file says that it is not complete.
    head.attributes["pm:passesDone"] = m_run.settingText("passes");
    for (std::uint32_t i = 0; i < m_run.layerCount(); ++i) {
        const PmrLayerInfo info = m_run.layerInfo(i);
        m_layers.push_back({info.name, static_cast<std::int32_t>(info.channelCount)});
        m_channels += m_layers.back().channels;
    }
    for (const auto& output : m_options.outputs)
        m_files.push_back(
            std::make_unique<TiledExr>(output, head, tilePixels, ExrOptions{m_options.exrHalf}));
}

void TiledOutput::take(const PmrBucketInfo& bucket) {
    const PmrRectangle& r = bucket.rectangle;
    if (m_files.empty()) begin();
    const auto width = static_cast<std::int64_t>(r.x1 - r.x0);
    const auto bytes = static_cast<std::int64_t>(sizeof(float)) * m_channels;
    std::vector<float> pixels(static_cast<std::size_t>(width * (r.y1 - r.y0) * m_channels));
    float* to = pixels.data();
    for (const Layer& layer : m_layers) {
        m_run.readPixels(r, layer.name.c_str(), to, bytes, bytes * width);
        to += layer.channels;
    }
    countLit(pixels);
    for (const auto& file : m_files) file->write({r.x0, r.y0, r.x1, r.y1}, pixels);
}

void TiledOutput::countLit(const std::vector<float>& pixels) {
    // Beauty comes first: R, G, B and A.
    for (std::size_t i = 0; i + 3 < pixels.size(); i += static_cast<std::size_t>(m_channels)) {
        if (!(pixels[i + 3] > 0.0f)) continue;
        ++m_covered;
        if (pixels[i] != 0.0f || pixels[i + 1] != 0.0f || pixels[i + 2] != 0.0f) ++m_lit;
    }
}

std::vector<TiledOutput::Written> TiledOutput::finish(bool complete) {
    // Interrupted before the first bucket.
    if (m_files.empty()) begin();
    std::vector<Written> written;
    std::optional<HostError> failure;
    for (std::size_t i = 0; i < m_files.size(); ++i) {
        const std::filesystem::path& output = m_options.outputs[i];
        try {
            const ExrReport report = complete ? m_files[i]->commit() : m_files[i]->commitPartial();
            written.push_back({complete ? output : partialName(output), report});
        } catch (const HostError& fault) {
            if (!failure) failure = fault;
        }
    }
    if (failure) throw *failure;
    return written;
}

}  // namespace pm::host
