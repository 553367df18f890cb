// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include "plugin/session/memory_ledger.h"
#include "plugin/session/memory_plan.h"
#include "plugin/session/render_scene.h"
#include "plugin/values/json.h"

namespace pm::plugin {

// The bounded caches of a render, and the ledger that divides among them what the plan holds for
// them together. Threads: all functions from any, at once.
class RenderCaches {
  public:
    // scene: the render's; is kept.
    RenderCaches(std::shared_ptr<const RenderScene> scene, const MemoryPlan& plan);

    // A bucket is done; from time to time memory moves.
    void bucketDone();
    // For the statistics: what each has now, and how often memory moved.
    Json statistics() const;

  private:
    std::shared_ptr<const RenderScene> m_scene;
    MemoryLedger m_ledger;
    std::atomic<std::uint32_t> m_buckets{0};
};

}  // namespace pm::plugin
