// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/pieces/photon_host.h"

#include <algorithm>

namespace pm::test {

PmrRender PhotonHost::makeRender(const Settings& more, const PmrRenderDesc& desc) const {
    PmrRender render = nullptr;
    EXPECT_EQ(PMR_OK, api().createRender(m_host.scene(), &desc, &render)) << m_host.lastError();
    Settings all = m_settings;
    for (const auto& [name, value] : more) all[name] = value;
    for (const auto& [name, value] : all)
        EXPECT_EQ(PMR_OK, api().setSettingText(render, name.c_str(), value.c_str()))
            << m_host.lastError();
    return render;
}

Outcome PhotonHost::tracePhotons(const std::string& name, const Settings& more, double cancelAt) {
    m_seen.buckets = m_seen.finished = 0;
    m_seen.progress = 0;
    m_seen.cancelAt = cancelAt;
    PmrRenderDesc desc = PMR_INIT(PmrRenderDesc);
    desc.user = &m_seen;
    desc.bucketStarted = [](void* user, PmrRender, const PmrBucketInfo*) {
        ++static_cast<Seen*>(user)->buckets;
    };
    desc.bucketFinished = desc.bucketStarted;
    desc.progress = [](void* user, PmrRender render, double fraction, double) {
        auto* seen = static_cast<Seen*>(user);
        EXPECT_GE(fraction, seen->progress);
        seen->progress = fraction;
        if (fraction >= seen->cancelAt) api().cancelRender(render);
    };
    desc.finished = [](void* user, PmrRender, PmrStatus) { ++static_cast<Seen*>(user)->finished; };
    Settings all = more;
    all["photonMap"] = path(name);
    all["photonsOnly"] = "1";
    const PmrRender render = makeRender(all, desc);
    Outcome outcome;
    outcome.started = api().startRender(render);
    if (outcome.started == PMR_OK) {
        outcome.ended = api().waitRender(render, -1.0);
        if (!outcome.isOk()) outcome.error = m_host.lastError();
        EXPECT_EQ(PMR_OK, api().renderLayerCount(render, &m_seen.layers));
        float pixel[4] = {};
        const PmrRectangle one{0, 0, 1, 1};
        m_seen.readStatus = api().readPixels(render, &one, "beauty", pixel, 0, 0);
        outcome.json = nlohmann::json::parse(
            textOf([&](char* buffer, std::uint64_t capacity, std::uint64_t* needed) {
                return api().renderStatistics(render, buffer, capacity, needed);
            }));
    } else {
        outcome.error = m_host.lastError();
    }
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
    return outcome;
}

void PhotonHost::makePhotons(const std::string& name, const Settings& more) {
    const Outcome outcome = tracePhotons(name, more);
    ASSERT_TRUE(outcome.isOk()) << outcome.error;
}

Outcome PhotonHost::renderWith(const std::string& name, const Settings& more) {
    Settings all = more;
    all["photonMap"] = path(name);
    return render(all);
}

std::string PhotonHost::explain(const Settings& more) {
    const PmrRender render = makeRender(more, PMR_INIT(PmrRenderDesc));
    const std::string text =
        textOf([&](char* buffer, std::uint64_t capacity, std::uint64_t* needed) {
            return api().explainRender(render, buffer, capacity, needed);
        });
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
    return text;
}

}  // namespace pm::test
