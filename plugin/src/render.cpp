// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/src/render.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "plugin/src/call_error.h"
#include "plugin/src/callback_scope.h"
#include "plugin/src/entry.h"
#include "plugin/src/render_pieces.h"
#include "scheduler/buckets/bucket_order.h"
#include "scheduler/buckets/worker_arena.h"

namespace pm::plugin {

namespace {

std::int32_t checkedCallbackMode(const PmrRenderDesc& desc) {
    if (desc.callbackMode != PMR_CALLBACKS_THREAD && desc.callbackMode != PMR_CALLBACKS_POLL)
        throw argumentError(
            fmt::format("PmrRenderDesc: callbackMode is {}; it must be 0 (THREAD) or 1 (POLL)",
                        desc.callbackMode));
    if (desc.reserved != 0) throw argumentError("PmrRenderDesc: reserved must be 0");
    return desc.callbackMode;
}

void checkTimeout(double seconds) {
    if (std::isnan(seconds)) throw argumentError("timeoutSeconds is NaN; it must be a number");
}

void refuseInCallback(const char* function) {
    if (CallbackScope::active())
        throw CallError(PMR_ERROR_IN_CALLBACK,
                        fmt::format("{} is not allowed inside a callback", function));
}

CallError notStarted() {
    return {PMR_ERROR_STATE, "the render was not started"};
}

}  // namespace

Render::Render(std::shared_ptr<SceneObject> scene, const PmrRenderDesc& desc)
    : m_scene(std::move(scene)),
      m_built(m_scene->built()),
      m_callbackMode(checkedCallbackMode(desc)),
      m_takesBuckets(desc.bucketFinished != nullptr),
      m_events(desc) {}

void Render::changeSettings(const std::function<void(SettingValues&)>& change) {
    const std::lock_guard lock(m_mutex);
    if (m_state != PMR_RENDER_CREATED)
        throw CallError(PMR_ERROR_STATE, "settings can't change after startRender");
    change(m_settings);
}

SettingValues Render::settings() const {
    const std::lock_guard lock(m_mutex);
    return m_settings;
}

std::shared_ptr<RenderWork> Render::work() const {
    const std::lock_guard lock(m_mutex);
    return m_work;
}

void Render::checkDelivery(const SettingValues& values) const {
    if (!m_takesBuckets && values.word(Setting::kDelivery) != "frame")
        throw argumentError(fmt::format("setting delivery is {}, but bucketFinished is null",
                                        values.word(Setting::kDelivery)));
}

Plan Render::makePlan() const {
    const SettingValues values = settings();
    WorkerArena arena(static_cast<int>(values.integer(Setting::kThreads)));
    return arena.execute([&] { return pm::makePlan(*m_built, values.toRenderSettings()); });
}

MemoryPlan Render::memoryPlan(const Plan& plan) const {
    const SettingValues values = settings();
    checkDelivery(values);
    return planMemory(*m_built, plan, values, bucketsOf(values), m_scene->texelBytes());
}

std::string Render::explain() const {
    if (const auto running = work()) return explain(running->plan(), running->memory());
    const SettingValues values = settings();
    checkedRun(values, findBucketOrder(values.word(Setting::kBucketOrder))->isCorrelated,
               bucketsOf(values).cellCount());
    const Plan plan = makePlan();
    return explain(plan, memoryPlan(plan));
}

std::string Render::explain(const Plan& plan, const MemoryPlan& memory) const {
    return plan.explain() + explainPhotons(settings(), plan) + memory.explain();
}

std::int32_t Render::delivery() const {
    const auto running = work();
    const MemoryPlan memory = running ? running->memory() : memoryPlan(makePlan());
    return memory.byBuckets ? PMR_DELIVERY_BUCKETS : PMR_DELIVERY_FRAME;
}

void Render::start(PmrRender handle) {
    const std::lock_guard lock(m_mutex);
    if (m_state != PMR_RENDER_CREATED || m_shuttingDown)
        throw CallError(PMR_ERROR_STATE, "the render was started before");
    m_startTime = std::chrono::steady_clock::now();
    checkDelivery(m_settings);
    auto made = std::make_shared<RenderWork>(m_built, m_scene->identity(), m_settings,
                                             m_scene->texelBytes());
    m_scene->context()->textures().holdAtMost(made->memory().need.textures);
    m_events.open(handle, {[made](std::uint32_t bucket) { made->beforeDelivery(bucket); },
                           [made](std::uint32_t bucket) { made->afterDelivery(bucket); }});
    // The threads wait for m_mutex, so they see the state that is set last.
    if (m_callbackMode == PMR_CALLBACKS_THREAD && !m_delivery.joinable())
        m_delivery = std::thread([this] {
            while (m_events.deliverOne(std::nullopt) != EventQueue::Delivery::kOver) {
            }
        });
    m_work = made;
    m_state = PMR_RENDER_RUNNING;
    try {
        m_job = std::thread([this] { runJob(); });
    } catch (...) {
        m_work.reset();
        m_state = PMR_RENDER_CREATED;
        throw;
    }
}

void Render::runJob() {
    const FpEnvironment environment;
    const PmrStatus status = runWork();
    {
        const std::lock_guard lock(m_mutex);
        m_totalSeconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - m_startTime).count();
        m_status = status;
        m_state = PMR_RENDER_FINISHED;
    }
    m_stateChanged.notify_all();
    try {
        if (status == PMR_OK) m_events.progress(1.0, 0.0);
    } catch (...) {
        // Without memory `finished` has to tell it.
    }
    m_events.finished(status);
}

PmrStatus Render::runWork() {
    const std::shared_ptr<RenderWork> running = work();
    try {
        running->announce(m_events);
        running->run(m_cancel, m_events);
        if (const std::uint64_t failures = m_scene->textureFailures(); failures > 0) {
            const std::string text = fmt::format("{} texture look-ups failed and gave 0", failures);
            running->warnings().add(PMR_MESSAGE_TEXTURE, text);
            m_events.message(PMR_LEVEL_WARNING, PMR_MESSAGE_TEXTURE, text);
        }
        return PMR_OK;
    } catch (...) {
        std::string text;
        const PmrStatus status = translateException(text);
        try {
            if (status != PMR_ERROR_CANCELLED)
                m_events.message(PMR_LEVEL_ERROR, PMR_MESSAGE_NONE, text);
        } catch (...) {
            // Without memory `finished` has to tell it.
        }
        const std::lock_guard lock(m_mutex);
        m_errorText = std::move(text);
        return status;
    }
}

PmrStatus Render::poll(double timeoutSeconds) {
    checkTimeout(timeoutSeconds);
    refuseInCallback("pollRender");
    if (m_callbackMode != PMR_CALLBACKS_POLL)
        throw CallError(PMR_ERROR_STATE, "pollRender is for renders made with PMR_CALLBACKS_POLL");
    if (!work()) throw notStarted();
    const Deadline deadline = deadlineAfter(timeoutSeconds);
    EventQueue::Delivery delivery = m_events.deliverOne(deadline);
    if (delivery == EventQueue::Delivery::kTimeout) return PMR_ERROR_TIMEOUT;
    if (delivery == EventQueue::Delivery::kOver)
        throw CallError(PMR_ERROR_STATE, "`finished` has been delivered; nothing else will come");
    // What else waits already, but no longer than the caller has time.
    while (delivery == EventQueue::Delivery::kDelivered &&
           (!deadline || std::chrono::steady_clock::now() < *deadline))
        delivery = m_events.deliverOne(deadlineAfter(0.0));
    return PMR_OK;
}

PmrStatus Render::outcome() const {
    const std::lock_guard lock(m_mutex);
    if (m_status != PMR_OK) throw CallError(m_status, m_errorText);
    return m_status;
}

PmrStatus Render::wait(double timeoutSeconds) {
    checkTimeout(timeoutSeconds);
    refuseInCallback("waitRender");
    if (!work()) throw notStarted();
    const Deadline deadline = deadlineAfter(timeoutSeconds);
    if (m_callbackMode == PMR_CALLBACKS_THREAD)
        return m_events.waitUntilOver(deadline) ? outcome() : PMR_ERROR_TIMEOUT;
    std::unique_lock lock(m_mutex);
    const auto ended = [this] { return m_state == PMR_RENDER_FINISHED; };
    if (m_work->memory().byBuckets && !ended())
        throw CallError(PMR_ERROR_STATE,
                        "by buckets a render waits for pollRender; waitRender would wait for ever");
    if (!deadline)
        m_stateChanged.wait(lock, ended);
    else if (!m_stateChanged.wait_until(lock, *deadline, ended))
        return PMR_ERROR_TIMEOUT;
    lock.unlock();
    return outcome();
}

void Render::cancel() {
    m_cancel.set();
}

void Render::stateAndStatus(std::int32_t& state, PmrStatus& status) const {
    const std::lock_guard lock(m_mutex);
    state = m_state;
    status = m_status;
}

std::int32_t Render::stopReason() const {
    const std::shared_ptr<RenderWork> running = work();
    std::int32_t state = 0;
    PmrStatus status = PMR_OK;
    stateAndStatus(state, status);
    if (!running || state != PMR_RENDER_FINISHED) return PMR_STOP_NONE;
    if (status == PMR_OK) return running->progress().stopReason;
    return status == PMR_ERROR_CANCELLED ? PMR_STOP_CANCELLED : PMR_STOP_FAILED;
}

bool Render::shutDown() {
    refuseInCallback("destroyRender");
    std::thread job, delivery;
    {
        const std::lock_guard lock(m_mutex);
        if (std::exchange(m_shuttingDown, true)) return false;
        job = std::move(m_job);
        delivery = std::move(m_delivery);
    }
    m_cancel.set();
    m_events.dropAllButFinished();
    if (job.joinable())
        job.join();
    else
        m_events.close();
    // Here in the poll mode, beside another thread that may be at it; else on the thread for it.
    while (m_callbackMode == PMR_CALLBACKS_POLL &&
           m_events.deliverOne(std::nullopt) != EventQueue::Delivery::kOver) {
    }
    if (delivery.joinable()) delivery.join();
    return true;
}

}  // namespace pm::plugin
