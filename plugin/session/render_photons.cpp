// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/render_photons.h"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>
#include <utility>

#include "plugin/values/call_error.h"

namespace pm::plugin {

namespace {

CallError doesNotGo(const char* setting, const char* with) {
    return argumentError(fmt::format("setting {} does not go together with {}", setting, with));
}

void checkSettings(const SettingValues& values) {
    const bool isOnly = RenderPhotons::isOnly(values);
    if (isOnly && values.word(Setting::kPhotonMap).empty())
        throw argumentError("setting photonsOnly is 1; it needs photonMap, the file to write");
    if (values.word(Setting::kIntegrator) == "path")
        throw doesNotGo("photonMap", "the integrator path, which has no photons");
    if (!isOnly) return;
    // What is about pixels, or leaves the number of passes open.
    for (const Setting text : {Setting::kBuckets, Setting::kPart, Setting::kCheckpoint})
        if (!values.word(text).empty())
            throw doesNotGo("photonsOnly", settingSpecs()[static_cast<std::size_t>(text)].name);
    for (const Setting limit : {Setting::kTimeLimit, Setting::kErrorTarget})
        if (values.number(limit) > 0)
            throw doesNotGo("photonsOnly", settingSpecs()[static_cast<std::size_t>(limit)].name);
}

}  // namespace

RenderPhotons::RenderPhotons(const SettingValues& values, const Identity& scene, const Scene& built,
                             const Plan& plan)
    : m_file(values.word(Setting::kPhotonMap)), m_passes(values.passLimit()) {
    if (m_file.empty() && !isOnly(values)) return;
    checkSettings(values);
    PieceHead head = photonHead(photonIdentity(scene, values, plan), m_passes);
    if (isOnly(values)) {
        m_writer = std::make_unique<PhotonFileWriter>(m_file, head);
        return;
    }
    m_reader = std::make_unique<PhotonFileReader>(
        m_file, PhotonFileReader::Wanted{std::move(head), plan, built.radius()});
}

void RenderPhotons::check(const std::atomic<bool>& cancelled) const {
    if (m_reader) m_reader->checkAll(cancelled);
}

std::string RenderPhotons::hash(std::uint32_t passes) const {
    return m_reader ? m_reader->hash(passes) : std::string();
}

std::uint32_t RenderPhotons::passesHeld() const {
    return m_reader ? m_reader->passes() : m_passes;
}

std::uint64_t RenderPhotons::bytes() const {
    if (m_reader) return m_reader->bytes();
    return m_writer ? m_writer->bytes() : 0;
}

std::string explainPhotons(const SettingValues& values, const Plan& plan) {
    const std::string& file = values.word(Setting::kPhotonMap);
    if (file.empty()) return {};
    std::error_code ignored;
    if (!RenderPhotons::isOnly(values))
        return fmt::format("photons: read from {}, which {}\n", file,
                           std::filesystem::exists(file, ignored)
                               ? "saves the time of tracing them"
                               : "is not there: the render would be refused");
    const double bytes =
        static_cast<double>(plan.landingsPerPass()) * sizeof(Photon) * values.passLimit();
    return fmt::format(
        "photons only: those of {} passes are traced into {}, some {:.0f} MB at most; "
        "no picture\n",
        values.passLimit(), file, bytes / 1e6);
}

}  // namespace pm::plugin
