// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/frame/channel_layout.h"

namespace pm {

ChannelLayout channelLayout(const RenderSettings& settings) {
    ChannelLayout layout;
    const auto place = [&](bool wanted, std::int32_t size) {
        if (!wanted) return -1;
        layout.count += size;
        return layout.count - size;
    };
    layout.albedo = place(settings.wantAlbedo, 3);
    layout.normal = place(settings.wantNormal, 3);
    layout.depth = place(settings.wantDepth, 1);
    layout.biasProbe = place(settings.integrator == IntegratorKind::kPhoton, 3);
    layout.seen = place(settings.isAdaptive(), 6);
    layout.contribution = place(settings.isAdaptive() && settings.hasGroups(), 1);
    return layout;
}

}  // namespace pm
