// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/render.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "plugin/session/callback_scope.h"
#include "plugin/session/render_pieces.h"
#include "plugin/values/call_error.h"
#include "plugin/values/failure.h"
#include "plugin/values/forks.h"
#include "scheduler/buckets/bucket_order.h"
#include "scheduler/buckets/fp_environment.h"
#include "scheduler/buckets/worker_arena.h"

namespace pm::plugin {

namespace {

void checkTimeout(double seconds) {
    if (std::isnan(seconds)) throw argumentError("timeoutSeconds is NaN; it must be a number");
}

void refuseInCallback(const char* function) {
    if (CallbackScope::active())
        throw CallError(CallStatus::kInCallback,
                        fmt::format("{} is not allowed inside a callback", function));
}

CallError notStarted() {
    return {CallStatus::kState, "the render was not started"};
}

}  // namespace

Render::Render(std::shared_ptr<const RenderScene> scene, RenderListener listener, CallbackMode mode)
    : m_scene(std::move(scene)),
      m_callbackMode(mode),
      m_takesBuckets(listener.bucketFinished != nullptr),
      m_events(std::move(listener)) {}

void Render::changeSettings(const std::function<void(SettingValues&)>& change) {
    const std::lock_guard lock(m_mutex);
    if (m_state != RenderState::kCreated)
        throw CallError(CallStatus::kState, "settings can't change after startRender");
    m_plan.reset();
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

// Kept for the start: a plan takes pilots.
Plan Render::makePlan() const {
    const SettingValues values = settings();
    {
        const std::lock_guard lock(m_mutex);
        if (m_plan) return *m_plan;
    }
    WorkerArena arena(static_cast<int>(values.integer(Setting::kThreads)));
    const Plan plan = planOf(*m_scene, values, arena);
    const std::lock_guard lock(m_mutex);
    if (m_state == RenderState::kCreated) m_plan = plan;
    return plan;
}

MemoryPlan Render::memoryPlan(const Plan& plan) const {
    const SettingValues values = settings();
    checkDelivery(values);
    return planMemory(*m_scene->scene, plan, values, bucketsOf(values),
                      m_scene->textures->texelBytes());
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

PixelDelivery Render::delivery() const {
    const auto running = work();
    const MemoryPlan memory = running ? running->memory() : memoryPlan(makePlan());
    return memory.byBuckets ? PixelDelivery::kBuckets : PixelDelivery::kFrame;
}

void Render::start() {
    const std::lock_guard lock(m_mutex);
    if (m_state != RenderState::kCreated || m_shuttingDown)
        throw CallError(CallStatus::kState, "the render was started before");
    m_startTime = std::chrono::steady_clock::now();
    checkDelivery(m_settings);
    auto made = std::make_shared<RenderWork>(*m_scene, m_settings, m_plan);
    RenderPages* const pages = made->pages();
    made->divideMemory(std::make_unique<RenderCaches>(m_scene, made->memory(),
                                                      pages ? &pages->paging() : nullptr));
    m_events.open({[made](std::uint32_t bucket) { made->beforeDelivery(bucket); },
                   [made](std::uint32_t bucket) { made->afterDelivery(bucket); }},
                  m_callbackMode == CallbackMode::kThread);
    m_work = made;
    try {
        startThreads();
    } catch (...) {
        m_atWork.reset();
        m_work.reset();
        m_state = RenderState::kCreated;
        throw;
    }
}

// The threads wait for m_mutex, so they see the state that is set last.
void Render::startThreads() {
    m_forkCount = forkCount();
    if (m_callbackMode == CallbackMode::kThread && !m_delivery.joinable())
        m_delivery = std::thread([this] {
            while (m_events.deliverOne(std::nullopt) != EventQueue::Delivery::kOver) {
            }
        });
    m_state = RenderState::kRunning;
    m_atWork.emplace();
    m_job = std::thread([this] { runJob(); });
}

void Render::runJob() {
    const FpEnvironment environment;
    endJob(runWork());
}

void Render::endJob(CallStatus status) {
    // Whoever has seen the end and forks then has a child that may read the render.
    const auto noFork = holdOffForks();
    {
        const std::lock_guard lock(m_mutex);
        m_totalSeconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - m_startTime).count();
        m_status = status;
        m_state = RenderState::kFinished;
    }
    m_stateChanged.notify_all();
    try {
        if (status == CallStatus::kOk) m_events.progress(1.0, 0.0);
    } catch (...) {
        // Without memory `finished` has to tell it.
    }
    m_events.finished(status);
    m_atWork.reset();
}

CallStatus Render::runWork() {
    const std::shared_ptr<RenderWork> running = work();
    try {
        running->announce(m_events);
        running->run(m_cancel, m_events);
        if (const std::uint64_t failures = m_scene->textures->failureCount(); failures > 0) {
            const std::string text = fmt::format("{} texture look-ups failed and gave 0", failures);
            running->warnings().add(kMessageTexture, text);
            m_events.message(MessageLevel::kWarning, kMessageTexture, text);
        }
        return CallStatus::kOk;
    } catch (...) {
        std::string text;
        const CallStatus status = statusOfException(text);
        try {
            if (status != CallStatus::kCancelled)
                m_events.message(MessageLevel::kError, kMessageNone, text);
        } catch (...) {
            // Without memory `finished` has to tell it.
        }
        const std::lock_guard lock(m_mutex);
        m_errorText = std::move(text);
        return status;
    }
}

CallStatus Render::poll(double timeoutSeconds) {
    checkTimeout(timeoutSeconds);
    refuseInCallback("pollRender");
    if (m_callbackMode != CallbackMode::kPoll)
        throw CallError(CallStatus::kState,
                        "pollRender is for renders made with PMR_CALLBACKS_POLL");
    if (!work()) throw notStarted();
    const Deadline deadline = deadlineAfter(timeoutSeconds);
    const Activity activity;
    EventQueue::Delivery delivery = m_events.deliverOne(deadline);
    if (activity.isOfParent()) throw cutOffError();
    if (delivery == EventQueue::Delivery::kTimeout) return CallStatus::kTimeout;
    if (delivery == EventQueue::Delivery::kOver)
        throw CallError(CallStatus::kState,
                        "`finished` has been delivered; nothing else will come");
    // What else waits already, but no longer than the caller has time.
    while (delivery == EventQueue::Delivery::kDelivered &&
           (!deadline || std::chrono::steady_clock::now() < *deadline))
        delivery = m_events.deliverOne(deadlineAfter(0.0));
    if (activity.isOfParent()) throw cutOffError();
    return CallStatus::kOk;
}

CallStatus Render::outcome() const {
    const std::lock_guard lock(m_mutex);
    if (m_status != CallStatus::kOk) throw CallError(m_status, m_errorText);
    return m_status;
}

CallStatus Render::wait(double timeoutSeconds) {
    checkTimeout(timeoutSeconds);
    refuseInCallback("waitRender");
    if (!work()) throw notStarted();
    const Deadline deadline = deadlineAfter(timeoutSeconds);
    if (m_callbackMode == CallbackMode::kThread)
        return m_events.waitUntilOver(deadline) ? outcome() : CallStatus::kTimeout;
    std::unique_lock lock(m_mutex);
    const auto ended = [this] { return m_state == RenderState::kFinished; };
    if (m_work->memory().byBuckets && !ended())
        throw CallError(CallStatus::kState,
                        "by buckets a render waits for pollRender; waitRender would wait for ever");
    if (!deadline)
        m_stateChanged.wait(lock, ended);
    else if (!m_stateChanged.wait_until(lock, *deadline, ended))
        return CallStatus::kTimeout;
    lock.unlock();
    return outcome();
}

void Render::cancel() {
    m_cancel.set();
}

void Render::stateAndStatus(RenderState& state, CallStatus& status) const {
    const std::lock_guard lock(m_mutex);
    state = m_state;
    status = m_status;
}

StopReason Render::stopReason() const {
    const std::shared_ptr<RenderWork> running = work();
    RenderState state = RenderState::kCreated;
    CallStatus status = CallStatus::kOk;
    stateAndStatus(state, status);
    if (!running || state != RenderState::kFinished) return StopReason::kNone;
    if (status == CallStatus::kOk) return running->progress().stopReason;
    return status == CallStatus::kCancelled ? StopReason::kCancelled : StopReason::kFailed;
}

bool Render::shutDown() {
    refuseInCallback("destroyRender");
    std::thread job, delivery;
    {
        const std::lock_guard lock(m_mutex);
        if (std::exchange(m_shuttingDown, true)) return false;
        if (m_forkCount != forkCount()) return true;
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
    while (m_callbackMode == CallbackMode::kPoll &&
           m_events.deliverOne(std::nullopt) != EventQueue::Delivery::kOver) {
    }
    if (delivery.joinable()) delivery.join();
    return true;
}

}  // namespace pm::plugin
