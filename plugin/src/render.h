// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "plugin/include/pm_plugin.h"
#include "plugin/src/context.h"
#include "plugin/src/event_queue.h"
#include "plugin/src/handle_table.h"
#include "plugin/src/layer_table.h"
#include "plugin/src/render_work.h"
#include "plugin/src/scene_object.h"
#include "plugin/src/setting_values.h"

namespace pm::plugin {

// One render through its states (see pm_plugin.h): CREATED, RUNNING, FINISHED. It owns two threads
// while it runs: one that works, one that calls the host back (PMR_CALLBACKS_THREAD).
// Threads: any, but what start() and the settings say in the header.
class Render {
  public:
    static constexpr ObjectKind kKind = ObjectKind::kRender;

    // The scene must be committed: CallError(STATE).
    Render(std::shared_ptr<SceneObject> scene, const PmrRenderDesc& desc);

    const std::shared_ptr<Context>& context() const { return m_scene->context(); }
    const std::shared_ptr<SceneObject>& sceneObject() const { return m_scene; }

    // Calls `change` with the settings; CallError(STATE) after start.
    void changeSettings(const std::function<void(SettingValues&)>& change);
    SettingValues settings() const;
    std::string explain() const;
    // PMR_DELIVERY_*: as it runs, or as it would with these settings.
    std::int32_t delivery() const;

    // `handle` goes to the callbacks. A refusal (memory, no camera, ...) leaves the state CREATED.
    void start(PmrRender handle);
    PmrStatus poll(double timeoutSeconds);
    PmrStatus wait(double timeoutSeconds);
    void cancel();
    void stateAndStatus(std::int32_t& state, PmrStatus& status) const;
    // Cancels, waits, delivers `finished`. False when another call is at it already.
    bool shutDown();

    // Layers of this render in the order of the pixels.
    std::vector<Layer> layers() const;
    void readPixels(const PmrRectangle& rectangle, const char* layer, float* destination,
                    std::int64_t pixelStrideBytes, std::int64_t rowStrideBytes) const;
    std::string statisticsJson() const;
    std::int32_t stopReason() const;  // PMR_STOP_*

  private:
    // How it ended, or stands now.
    struct End {
        PmrStatus status = PMR_OK;
        std::string errorText;
        double totalSeconds = 0;
    };
    End endSoFar() const;
    std::string explain(const Plan& plan, const MemoryPlan& memory) const;
    void runJob();
    PmrStatus runWork();
    std::shared_ptr<RenderWork> work() const;
    Plan makePlan() const;
    MemoryPlan memoryPlan(const Plan& plan) const;
    void checkDelivery(const SettingValues& values) const;
    PmrStatus outcome() const;

    const std::shared_ptr<SceneObject> m_scene;
    const std::shared_ptr<const Scene> m_built;
    const std::int32_t m_callbackMode;
    const bool m_takesBuckets;  // the host has a bucketFinished
    EventQueue m_events;
    Cancel m_cancel;

    mutable std::mutex m_mutex;
    SettingValues m_settings;
    std::int32_t m_state = PMR_RENDER_CREATED;
    PmrStatus m_status = PMR_OK;
    std::string m_errorText;
    std::shared_ptr<RenderWork> m_work;
    std::chrono::steady_clock::time_point m_startTime;
    double m_totalSeconds = 0;

    std::condition_variable m_stateChanged;
    bool m_shuttingDown = false;
    std::thread m_job, m_delivery;  // joined by shutDown, which alone ends the handle
};

}  // namespace pm::plugin
