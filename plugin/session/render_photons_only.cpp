// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// RenderWork without pixels: the photons of all passes, into a file.
#include "plugin/session/render_work.h"

namespace pm::plugin {

void RenderWork::tracePass(std::uint32_t pass, const Cancel& cancel, EventQueue& events) {
    const Stopwatch watch;
    events.message(MessageLevel::kInfo, kMessagePhase, passName(pass) + ": photons");
    m_arena.execute([&] {
        m_renderer->tracePass(pass, m_photons.writer(), cancel.flag, [&](double fraction) {
            const ProgressClock::Reading reading = m_clock.photons(pass, fraction);
            events.progress(reading.fraction, reading.remainingSeconds);
        });
    });
    const double seconds = watch.seconds();
    for (const Notice& notice : m_renderer->takeNotices()) warn(notice, events);
    m_clock.endPass(seconds, 0.0, std::nullopt);
    const std::lock_guard lock(m_mutex);
    m_progress.photonSeconds += seconds;
    m_progress.passesDone = pass + 1;
}

void RenderWork::runPhotonsOnly(const Cancel& cancel, EventQueue& events) {
    try {
        for (std::uint32_t pass = 0; pass < m_settings.passes; ++pass) {
            cancel.throwIfSet();
            tracePass(pass, cancel, events);
        }
        m_photons.writer().finish(cancel.flag);
    } catch (...) {
        m_photons.writer().abandon();
        throw;
    }
    const std::lock_guard lock(m_mutex);
    m_progress.stopReason = StopReason::kPasses;
    m_progress.photonHash = m_photons.writer().hash();
}

}  // namespace pm::plugin
