// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/colour/space_conversion.h"

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

bool SpaceConversion::isIdentity() const {
    return m_processor == nullptr;
}

std::string SpaceConversion::cacheId() const {
    return m_processor ? m_processor->cacheId : std::string("identity");
}

void SpaceConversion::apply(std::span<float> values, int channelsPerPixel) const {
    if (!m_processor) return;
    const auto channels = static_cast<std::size_t>(channelsPerPixel);
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
