// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/render_caches.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace pm::plugin {

namespace {

// To ask what textures missed takes some microseconds a file.
constexpr std::uint32_t kBucketsBetweenMoves = 16;

std::uint64_t plannedBytes(const MemoryPlan& plan) {
    return plan.need.textures + plan.need.groups + plan.pages;
}

std::vector<LedgerCache> cachesOf(const RenderScene& scene, const MemoryPlan& plan,
                                  PhotonPaging* photons) {
    std::vector<LedgerCache> caches;
    const auto add = [&](const char* name, std::uint64_t least, std::uint64_t whole, auto setBudget,
                         auto bytesMissed) {
        if (whole > 0)
            caches.push_back({name, std::min(least, whole), whole, std::move(setBudget),
                              std::move(bytesMissed)});
    };
    const Scene& shapes = *scene.scene;
    add(
        "geometry", kLeastGroups, shapes.groupBytes(),
        [&shapes](std::uint64_t bytes) { shapes.setGroupBudget(bytes); },
        [&shapes] { return shapes.groupCounts().bytesMade; });
    const SceneTextures& textures = *scene.textures;
    TextureSystem& system = *scene.textureSystem;
    add(
        "textures", TextureSystem::kLeastBytes, textures.texelBytes(),
        [&system, all = textures.texelBytes()](std::uint64_t bytes) {
            system.holdAtMost(bytes, all);
        },
        [&textures] { return textures.reads().bytes; });
    if (photons)
        add(
            "photonPages", std::min(plan.pages, kLeastPages), std::max(plan.pagedBytes, plan.pages),
            [photons](std::uint64_t bytes) { photons->setBudget(bytes); },
            [photons] { return photons->counts().bytesMade; });
    return caches;
}

}  // namespace

Plan planOf(const RenderScene& scene, const SettingValues& values, WorkerArena& arena) {
    scene.scene->setGroupBudget(kLeastGroups);
    if (values.number(Setting::kMemoryLimit) > 0)
        scene.textureSystem->holdAtMost(TextureSystem::kLeastBytes);
    return arena.execute(
        [&] { return makePlan(*scene.scene, values.toRenderSettings(), *scene.cancelPlans); });
}

RenderCaches::RenderCaches(std::shared_ptr<const RenderScene> scene, const MemoryPlan& plan,
                           PhotonPaging* photons)
    : m_scene(std::move(scene)), m_ledger(plannedBytes(plan), cachesOf(*m_scene, plan, photons)) {}

void RenderCaches::bucketDone() {
    if (m_buckets.fetch_add(1, std::memory_order_relaxed) % kBucketsBetweenMoves ==
        kBucketsBetweenMoves - 1)
        m_ledger.balance();
}

Json RenderCaches::statistics() const {
    Json caches = Json::array();
    for (const MemoryLedger::Share& share : m_ledger.shares())
        caches.push_back(
            {{"name", share.name}, {"budgetBytes", share.budget}, {"wholeBytes", share.whole}});
    return {{"caches", std::move(caches)}, {"moves", m_ledger.moves()}};
}

}  // namespace pm::plugin
