// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/render/render_run.h"

#include <fmt/format.h>

#include "host_shim/process/interrupt.h"

namespace pm::host {

namespace {

// While it lives, a signal ends what the library plans.
InterruptWatch planWatch(const PluginContext& context) {
    return InterruptWatch([&] { context.api().cancelBuilds(context.handle(), 1); });
}

}  // namespace

void PMR_CALL logPluginMessage(void* user, PmrRender, int32_t level, int32_t code,
                               const char* text) {
    Log& log = *static_cast<Log*>(user);
    if (level == PMR_LEVEL_WARNING) {
        log.libraryWarning(code, text);
    } else {
        // The plugin's errors reach the user as exceptions, once.
        log.message(level == PMR_LEVEL_INFO ? Level::kInfo : Level::kDebug, text);
    }
}

void RenderRun::onMessage(void* user, PmrRender render, int32_t level, int32_t code,
                          const char* text) {
    logPluginMessage(&static_cast<RenderRun*>(user)->m_log, render, level, code, text);
}

void RenderRun::onProgress(void* user, PmrRender, double fraction, double remainingSeconds) {
    static_cast<RenderRun*>(user)->m_progress.update(fraction, remainingSeconds);
}

void RenderRun::onBucketFinished(void* user, PmrRender, const PmrBucketInfo* bucket) {
    auto& run = *static_cast<RenderRun*>(user);
    if (run.m_bucketTimes != nullptr) run.m_bucketTimes->finished(*bucket);
    if (run.m_taker == nullptr || run.m_failure) return;
    try {
        run.m_taker->take(*bucket);
    } catch (...) {
        // Not through the plugin.
        run.m_failure = std::current_exception();
        run.api().cancelRender(run.m_handle);
    }
}

void RenderRun::onFinished(void* user, PmrRender, PmrStatus status) {
    auto* run = static_cast<RenderRun*>(user);
    run->m_finished = true;
    run->m_status = status;
}

RenderRun::RenderRun(const PluginScene& scene, const Options& options, const std::string& identity,
                     Log& log, Progress& progress, BucketTimes* bucketTimes)
    : m_context(scene.context()), m_log(log), m_progress(progress), m_bucketTimes(bucketTimes) {
    auto desc = PMR_INIT(PmrRenderDesc);
    desc.callbackMode = PMR_CALLBACKS_POLL;
    desc.user = this;
    desc.message = onMessage;
    desc.progress = onProgress;
    desc.bucketFinished = onBucketFinished;
    desc.finished = onFinished;
    m_context.check(api().createRender(scene.handle(), &desc, &m_handle), "render");
    try {
        apply({"--size", "width", std::to_string(options.width)});
        apply({"--size", "height", std::to_string(options.height)});
        if (options.crop) {
            const PixelRect& c = *options.crop;
            apply({"--crop", "crop", fmt::format("{},{},{},{}", c.x0, c.y0, c.x1, c.y1)});
        }
        if (!options.layers.empty()) apply({"--aov", "layers", options.layers});
        apply({"", "hostIdentity", identity});
        apply({"", "delivery", "fit"});
        for (const GivenSetting& setting : options.settings) apply(setting);
    } catch (...) {
        api().destroyRender(m_handle);
        throw;
    }
}

RenderRun::~RenderRun() {
    api().destroyRender(m_handle);
}

// The option that a setting came from, before what is wrong with it.
std::string RenderRun::withOption(const std::string& text) const {
    for (const GivenSetting& setting : m_given)
        if (!setting.option.empty() && text.starts_with("setting " + setting.name + " "))
            return setting.option + ": " + text;
    return text;
}

void RenderRun::apply(const GivenSetting& setting) {
    m_given.push_back(setting);
    if (api().setSettingText(m_handle, setting.name.c_str(), setting.value.c_str()) == PMR_OK) {
        return;
    }
    throw HostError(ExitCode::kUsage, fmt::format("{}: {}", setting.option, m_context.lastError()));
}

std::uint32_t RenderRun::layerCount() const {
    std::uint32_t count = 0;
    m_context.check(api().renderLayerCount(m_handle, &count), "layers");
    return count;
}

PmrLayerInfo RenderRun::layerInfo(std::uint32_t index) const {
    auto info = PMR_INIT(PmrLayerInfo);
    m_context.check(api().renderLayerInfo(m_handle, index, &info), "layers");
    return info;
}

void RenderRun::readPixels(const PmrRectangle& rectangle, const char* layer,
                           float* destination) const {
    m_context.check(api().readPixels(m_handle, &rectangle, layer, destination, 0, 0),
                    fmt::format("layer {}", layer));
}

void RenderRun::readPixels(const PmrRectangle& rectangle, const char* layer, float* destination,
                           std::int64_t pixelStride, std::int64_t rowStride) const {
    m_context.check(
        api().readPixels(m_handle, &rectangle, layer, destination, pixelStride, rowStride),
        fmt::format("layer {}", layer));
}

bool RenderRun::deliversBuckets() const {
    std::int32_t delivery = PMR_DELIVERY_FRAME;
    const InterruptWatch watch = planWatch(m_context);
    m_context.check(api().renderDelivery(m_handle, &delivery), "render");
    return delivery == PMR_DELIVERY_BUCKETS;
}

void RenderRun::keepFrame(const std::string& reason) {
    m_whyFrame = reason;
    apply({"", "delivery", "frame"});
}

std::string RenderRun::settingText(const std::string& name) const {
    return pluginText([&](char* buffer, uint64_t capacity, uint64_t* needed) {
        return api().settingText(m_handle, name.c_str(), buffer, capacity, needed);
    });
}

void RenderRun::checkSettings(PmrStatus status, const std::string& what) const {
    if (status == PMR_ERROR_ARGUMENT)
        throw HostError(ExitCode::kUsage, withOption(m_context.lastError()));
    m_context.check(status, what);
}

std::string RenderRun::explain() const {
    const InterruptWatch watch = planWatch(m_context);
    PmrStatus status = PMR_OK;
    std::string text = pluginText([&](char* buffer, uint64_t capacity, uint64_t* needed) {
        return status = api().explainRender(m_handle, buffer, capacity, needed);
    });
    checkSettings(status, "render");
    return text;
}

std::string RenderRun::statistics() const {
    return pluginText([this](char* buffer, uint64_t capacity, uint64_t* needed) {
        return api().renderStatistics(m_handle, buffer, capacity, needed);
    });
}

PmrStatus RenderRun::run() {
    constexpr double kPollSeconds = 0.05;
    const PmrStatus started = [this] {
        const InterruptWatch watch = planWatch(m_context);
        return api().startRender(m_handle);
    }();
    const bool tooLarge = started == PMR_ERROR_MEMORY && !m_whyFrame.empty();
    checkSettings(started, tooLarge ? m_whyFrame : "render");
    while (!m_finished) {
        if (interruptSignal() != 0) api().cancelRender(m_handle);
        const PmrStatus status = api().pollRender(m_handle, kPollSeconds);
        if (status != PMR_OK && status != PMR_ERROR_TIMEOUT) m_context.check(status, "render");
    }
    if (m_failure) std::rethrow_exception(m_failure);
    // Of a render that has ended, waitRender gives lastError its text.
    if (m_status != PMR_ERROR_CANCELLED) m_context.check(api().waitRender(m_handle, 0.0), "render");
    return m_status;
}

}  // namespace pm::host
