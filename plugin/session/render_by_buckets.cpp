// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// RenderWork by buckets: the maps of all passes, then each bucket with all of them.
#include <algorithm>
#include <limits>

#include "plugin/session/render_work.h"

namespace pm::plugin {

namespace {

// Of a photon's time and of the share of the progress that photons get; see estimateCosts.
constexpr double kSecondsPerPhoton = 4e-6;
constexpr double kMostOfProgress = 0.5;

double photonShare(const Plan& plan) {
    if (!plan.tracePhotons || !(plan.processorSecondsPerPass > 0)) return 0;
    return std::min(kMostOfProgress, static_cast<double>(plan.photonsPerPass()) *
                                         kSecondsPerPhoton / plan.processorSecondsPerPass);
}

}  // namespace

double RenderWork::addPass(std::uint32_t pass, double share, const Cancel& cancel,
                           EventQueue& events) {
    const Stopwatch watch;
    if (m_plan.tracePhotons)
        events.message(MessageLevel::kInfo, kMessagePhase, passName(pass) + ": photons");
    m_arena.execute([&] {
        m_renderer->addPass(pass, cancel.flag, [&](double fraction) {
            events.progress(share * (pass + fraction) / m_settings.passes,
                            std::numeric_limits<double>::quiet_NaN());
        });
    });
    for (const Notice& notice : m_renderer->takeNotices()) warn(notice, events);
    return watch.seconds();
}

void RenderWork::runByBuckets(const Cancel& cancel, EventQueue& events) {
    m_photons.check(cancel.flag);
    const double share = photonShare(m_plan);
    double photonSeconds = 0;
    for (std::uint32_t pass = 0; pass < m_settings.passes; ++pass) {
        cancel.throwIfSet();
        photonSeconds += addPass(pass, share, cancel, events);
        const std::lock_guard lock(m_mutex);
        m_progress.photonSeconds = photonSeconds;
    }
    cancel.throwIfSet();
    const Stopwatch watch;
    m_buckets->tell(m_caches.get());
    BucketRun result = m_buckets->run(*m_renderer, m_arena, share, cancel, events);
    const double bucketSeconds = watch.seconds();
    for (const Notice& notice : m_renderer->takeNotices()) warn(notice, events);
    {
        const std::lock_guard lock(m_mutex);
        m_progress.bucketSeconds = bucketSeconds;
        m_progress.idleSeconds = result.idleSeconds;
        if (!result.cancelled) {
            for (double& seconds : result.seconds) seconds /= m_settings.passes;
            m_progress.secondsPerBucket = std::move(result.seconds);
        }
    }
    cancel.throwIfSet();
    endPass(m_settings.passes - 1, photonSeconds, bucketSeconds);
}

}  // namespace pm::plugin
