// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "integrator/photons/trace/photon_store.h"
#include "integrator/scene/scene.h"
#include "integrator/transport/plan/plan.h"
#include "plugin/session/render_identity.h"
#include "plugin/session/setting_values.h"
#include "plugin/storage/photon_file.h"

namespace pm::plugin {

// What a render does with a photon-map file: reads its photons from it, or traces them into it and
// makes no picture. Does nothing where the settings name none.
class RenderPhotons {
  public:
    // Opens the file. Errors: CallError(ARGUMENT) for settings that don't go together; those of
    // PhotonFileReader and PhotonFileWriter.
    RenderPhotons(const SettingValues& values, const Identity& scene, const Scene& built,
                  const Plan& plan);

    // Whether a render with these settings makes photons and no picture.
    static bool isOnly(const SettingValues& values) {
        return values.integer(Setting::kPhotonsOnly) != 0;
    }
    bool isOnly() const { return m_writer != nullptr; }
    // Where photons come from; null: they are traced.
    const PhotonSource* source() const { return m_reader.get(); }
    // Of a render that makes no picture.
    PhotonFileWriter& writer() { return *m_writer; }

    // Before the first pass: what is read is whole. Errors: PhotonFileReader::checkAll's.
    void check(const std::atomic<bool>& cancelled) const;
    // Of the photons of so many passes; empty where they were traced.
    std::string hash(std::uint32_t passes) const;

    const std::string& file() const { return m_file; }  // empty: none
    std::uint32_t passesHeld() const;                   // by the file, in the end
    std::uint64_t bytes() const;                        // of the file, so far; any thread

  private:
    const std::string m_file;
    const std::uint32_t m_passes;
    std::unique_ptr<PhotonFileReader> m_reader;  // or
    std::unique_ptr<PhotonFileWriter> m_writer;
};

// What --explain says of the file; ends with a line break, or is empty.
std::string explainPhotons(const SettingValues& values, const Plan& plan);

}  // namespace pm::plugin
