// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/api/render_callbacks.h"

#include <fmt/format.h>

#include "plugin/api/status.h"
#include "plugin/values/call_error.h"

namespace pm::plugin {

namespace {

PmrBucketInfo toInfo(const BucketInfo& bucket) {
    PmrBucketInfo info{};
    info.size = sizeof info;
    const Rect& rect = bucket.rectangle;
    info.rectangle = {rect.x0, rect.y0, rect.x1, rect.y1};
    info.bucketIndex = bucket.bucketIndex;
    info.bucketCount = bucket.bucketCount;
    info.passIndex = bucket.passIndex;
    info.passCount = bucket.passCount;
    info.sampleCount = bucket.sampleCount;
    info.seconds = bucket.seconds;
    info.timedPasses = bucket.timedPasses;
    info.cacheMisses = bucket.cacheMisses;
    info.cacheBytes = bucket.cacheBytes;
    return info;
}

std::function<void(const BucketInfo&)> bucketFunction(
    const std::shared_ptr<const RenderCallbacks>& host, PmrBucketFunction function) {
    if (function == nullptr) return {};
    return [host, function](const BucketInfo& bucket) {
        const PmrBucketInfo info = toInfo(bucket);
        function(host->desc.user, host->render, &info);
    };
}

}  // namespace

CallbackMode readCallbackMode(const PmrRenderDesc& desc) {
    if (desc.callbackMode != PMR_CALLBACKS_THREAD && desc.callbackMode != PMR_CALLBACKS_POLL)
        throw argumentError(
            fmt::format("PmrRenderDesc: callbackMode is {}; it must be 0 (THREAD) or 1 (POLL)",
                        desc.callbackMode));
    if (desc.reserved != 0) throw argumentError("PmrRenderDesc: reserved must be 0");
    return static_cast<CallbackMode>(desc.callbackMode);
}

RenderListener listenerFor(const std::shared_ptr<const RenderCallbacks>& host) {
    RenderListener listener;
    if (host->desc.message != nullptr)
        listener.message = [host](MessageLevel level, std::int32_t code, const std::string& text) {
            host->desc.message(host->desc.user, host->render, static_cast<std::int32_t>(level),
                               code, text.c_str());
        };
    if (host->desc.progress != nullptr)
        listener.progress = [host](double fraction, double remainingSeconds) {
            host->desc.progress(host->desc.user, host->render, fraction, remainingSeconds);
        };
    listener.bucketStarted = bucketFunction(host, host->desc.bucketStarted);
    listener.bucketFinished = bucketFunction(host, host->desc.bucketFinished);
    if (host->desc.finished != nullptr)
        listener.finished = [host](CallStatus status) {
            host->desc.finished(host->desc.user, host->render, toPmr(status));
        };
    return listener;
}

}  // namespace pm::plugin
