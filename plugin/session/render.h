// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "plugin/session/event_queue.h"
#include "plugin/session/layer_table.h"
#include "plugin/session/render_scene.h"
#include "plugin/session/render_work.h"
#include "plugin/session/setting_values.h"
#include "plugin/values/forks.h"

namespace pm::plugin {

// The numbers of these are those of the constants of the same names in pm_plugin.h.
enum class RenderState : std::int32_t { kCreated, kRunning, kFinished };
enum class CallbackMode : std::int32_t { kThread, kPoll };
enum class PixelDelivery : std::int32_t { kFrame, kBuckets };

// One render through its states (see pm_plugin.h). It owns two threads while it runs: one that
// works, one that calls the host back (CallbackMode::kThread).
// Threads: any, but what start() and the settings say in the header.
class Render {
  public:
    Render(std::shared_ptr<const RenderScene> scene, RenderListener listener, CallbackMode mode);

    // Calls `change` with the settings; CallError(STATE) after start.
    void changeSettings(const std::function<void(SettingValues&)>& change);
    SettingValues settings() const;
    std::string explain() const;
    // As it runs, or as it would with these settings.
    PixelDelivery delivery() const;

    // A refusal (memory, no camera, ...) leaves the state kCreated.
    void start();
    CallStatus poll(double timeoutSeconds);
    CallStatus wait(double timeoutSeconds);
    void cancel();
    void stateAndStatus(RenderState& state, CallStatus& status) const;
    // Cancels, waits, delivers `finished`; in a child of the process whose threads it had it does
    // nothing of these. False when another call is at it already.
    bool shutDown();

    // Layers of this render in the order of the pixels.
    std::vector<Layer> layers() const;
    void readPixels(const Rect& rectangle, const char* layer, float* destination,
                    std::int64_t pixelStrideBytes, std::int64_t rowStrideBytes) const;
    std::string statisticsJson() const;
    StopReason stopReason() const;

  private:
    // How it ended, or stands now.
    struct End {
        CallStatus status = CallStatus::kOk;
        std::string errorText;
        double totalSeconds = 0;
    };
    End endSoFar() const;
    std::string explain(const Plan& plan, const MemoryPlan& memory) const;
    void runJob();
    void endJob(CallStatus status);
    void startThreads();
    CallStatus runWork();
    std::shared_ptr<RenderWork> work() const;
    Plan makePlan() const;
    MemoryPlan memoryPlan(const Plan& plan) const;
    void checkDelivery(const SettingValues& values) const;
    CallStatus outcome() const;

    const std::shared_ptr<const RenderScene> m_scene;
    const CallbackMode m_callbackMode;
    const bool m_takesBuckets;  // the host has a bucketFinished
    EventQueue m_events;
    Cancel m_cancel;

    mutable std::mutex m_mutex;
    SettingValues m_settings;
    mutable std::optional<Plan> m_plan;  // of these settings, where one was asked for
    RenderState m_state = RenderState::kCreated;
    CallStatus m_status = CallStatus::kOk;
    std::string m_errorText;
    std::shared_ptr<RenderWork> m_work;
    std::chrono::steady_clock::time_point m_startTime;
    double m_totalSeconds = 0;

    std::condition_variable m_stateChanged;
    bool m_shuttingDown = false;
    std::thread m_job, m_delivery;            // joined by shutDown, which alone ends the handle
    std::uint32_t m_forkCount = forkCount();  // of the process that has these threads
    std::optional<Activity> m_atWork;         // of m_job
};

}  // namespace pm::plugin
