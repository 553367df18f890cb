// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/colour/space_conversion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "host_shim/colour/colour_config.h"

namespace pm::host {

struct SpaceConversion::Processor {
    OCIO::ConstCPUProcessorRcPtr cpu;
    std::string cacheId;
};

namespace {

// OpenColorIO unpacks a whole row; a row of this many pixels stays in the cache.
constexpr std::size_t kPixelsAtOnce = 4096;

}  // namespace

SpaceConversion::SpaceConversion() = default;

SpaceConversion::SpaceConversion(std::shared_ptr<const Processor> processor)
    : m_processor(std::move(processor)) {}

SpaceConversion SpaceConversion::ofCodes(const TransferCurve& curve) const {
    SpaceConversion made = *this;
    made.m_curve = curve;
    return made;
}

bool SpaceConversion::isIdentity() const {
    return m_processor == nullptr && !m_curve;
}

std::string SpaceConversion::cacheId() const {
    const std::string id = m_processor ? m_processor->cacheId : std::string("identity");
    return m_curve ? fmt::format("curve {} {}", fmt::join(*m_curve, " "), id) : id;
}

void SpaceConversion::applyCurve(std::span<float> values, std::size_t channels) const {
    for (std::size_t i = 0; i + 3 <= values.size(); i += channels)
        for (std::size_t c = i; c < i + 3; ++c)
            values[c] = static_cast<float>(lightOf(*m_curve, static_cast<double>(values[c])));
}

void SpaceConversion::apply(std::span<float> values, int channelsPerPixel) const {
    const auto channels = static_cast<std::size_t>(channelsPerPixel);
    if (m_curve) applyCurve(values, channels);
    if (!m_processor) return;
    const std::size_t pixels = values.size() / channels;
    const auto stride = static_cast<std::ptrdiff_t>(channels * sizeof(float));
    for (std::size_t first = 0; first < pixels; first += kPixelsAtOnce) {
        const auto count = static_cast<long>(std::min(kPixelsAtOnce, pixels - first));
        // Only three channels are shown to OpenColorIO, so nothing can touch alpha.
        OCIO::PackedImageDesc row(&values[first * channels], count, 1, OCIO::CHANNEL_ORDERING_RGB,
                                  OCIO::BIT_DEPTH_F32, sizeof(float), stride, stride * count);
        m_processor->cpu->apply(row);
    }
}

SpaceConversion makeSpaceConversion(const OCIO::ConstProcessorRcPtr& processor) {
    if (processor->isNoOp()) return SpaceConversion();
    auto made = std::make_shared<SpaceConversion::Processor>();
    made->cpu = processor->getOptimizedCPUProcessor(OCIO::BIT_DEPTH_F32, OCIO::BIT_DEPTH_F32,
                                                    OCIO::OPTIMIZATION_LOSSLESS);
    made->cacheId = made->cpu->getCacheID();
    return SpaceConversion(std::move(made));
}

}  // namespace pm::host
