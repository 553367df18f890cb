// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "host_shim/cli/options.h"
#include "host_shim/formats/scene_data.h"
#include "host_shim/formats/scene_reader.h"
#include "plugin/include/pm_plugin.h"

namespace pm::host {

inline constexpr std::uint32_t kTessellationRate = 8;  // of cages

// What --memory-limit says; 0: nothing, and the library goes by the machine.
double memoryLimitGib(const Options& options);
std::uint64_t memoryLimitBytes(const Options& options);
// What that leaves beside the program for what a text says, but for a few MiB that it always may
// have; 0: nothing was said.
std::uint64_t memoryForText(const Options& options);
// A step of up to this is done, though a limit allow less, to tell the smallest that works.
inline constexpr std::uint64_t kTellingBytes = std::uint64_t{512} << 20;

// What pm_host takes before a render, step by step, by what files say and what is made of them: of
// the same scene always the same, whatever the machine has just held. Threads: one at a time.
class HostMemory {
  public:
    HostMemory(const Options& options, const PmrApi& api);

    // A step is to come that takes so many bytes beside what is held. what: as "to read it takes".
    // One that the limit doesn't allow is done all the same where it is not large, so that the
    // render, which is refused, can tell the smallest limit. Errors: HostError kMemory where it is
    // too large for that, or for the machine.
    void take(std::uint64_t bytes, const std::string& what);
    // From now on, beside the program, in place of what was held before.
    void hold(std::uint64_t bytes) { m_held = bytes; }

    // What the limit leaves beside that: so much steps may share that could do with less.
    std::uint64_t left() const;
    // The most that the process takes before the render, GiB.
    double peakGib() const;
    // The step that takes most, where the limit doesn't allow it; else empty.
    std::string refused() const;

  private:
    std::uint64_t leftOf(std::uint64_t limit) const;
    std::uint64_t room() const;  // for a step

    std::string m_scene;
    std::uint64_t m_limit{};    // bytes; 0: none is given
    std::uint64_t m_machine{};  // that the machine has left, beside what the program holds
    std::uint64_t m_held{};
    std::uint64_t m_peak;
    std::string m_largest;
};

// Notes what it takes to read the scene's own file and its sidecar, where there is one. The answer,
// which memory must outlive, notes what else it takes.
MemoryNote takeForReading(const std::filesystem::path& scene, const std::filesystem::path& sidecar,
                          HostMemory& memory);
// Notes that data is held, and what it takes to hand it over to the library.
void takeForBuilding(const Options& options, const SceneData& data, HostMemory& memory);

// Gives what was freed back to the system.
void giveBackFreed();

}  // namespace pm::host
