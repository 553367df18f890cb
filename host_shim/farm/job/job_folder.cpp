// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/farm/job/job_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "host_shim/farm/job/run_script.h"
#include "host_shim/folders/own_folder.h"
#include "host_shim/formats/source_file.h"
#include "host_shim/pictures/finished_file.h"
#include "host_shim/process/interrupt.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMostPlanBytes = std::uint64_t{512} << 20;

[[noreturn]] void fail(const fs::path& path, const std::string& why) {
    throw HostError(ExitCode::kFile, fmt::format("{}: {}", path.string(), why));
}

// By its plan, of which this is the beginning.
bool isJob(const fs::path& folder) {
    return beginsWith(folder / "plan.json", FarmPlan::beginning());
}

constexpr FolderKind kJobKind{"farm-job", "a job's folder", "--job", nullptr, isJob};

fs::path named(const fs::path& folder, std::size_t number, const char* ending) {
    return folder / fmt::format("{:04}{}", number, ending);
}

}  // namespace

JobFolder::JobFolder(const fs::path& folder) : m_folder(fs::absolute(folder).lexically_normal()) {}

JobFolder::~JobFolder() {
    if (m_lock >= 0) ::close(m_lock);
}

fs::path JobFolder::part(int task) const {
    return named(m_folder / "parts", static_cast<std::size_t>(task), ".pmpart");
}
fs::path JobFolder::photons(std::size_t frame) const {
    return named(m_folder / "photons", frame, ".pmphotons");
}
fs::path JobFolder::statistics(int task) const {
    return named(m_folder / "logs", static_cast<std::size_t>(task), ".json");
}
fs::path JobFolder::log(int task) const {
    return named(m_folder / "logs", static_cast<std::size_t>(task), ".log");
}
fs::path JobFolder::events(int task) const {
    return named(m_folder / "logs", static_cast<std::size_t>(task), ".events");
}

std::optional<FarmPlan> JobFolder::readPlan() const {
    const fs::path file = m_folder / "plan.json";
    std::error_code failed;
    if (!fs::exists(file, failed)) return std::nullopt;
    return FarmPlan::fromJson(readWholeFile(file, throwIfInterrupted, kMostPlanBytes), file);
}

void JobFolder::check() const {
    OwnFolder::check(m_folder, kJobKind);
}

void JobFolder::prepare() {
    const OwnFolder own(m_folder, kJobKind);
    std::error_code failed;
    for (const char* name : {"photons", "parts", "logs", "checkpoints", "locks"}) {
        fs::create_directories(m_folder / name, failed);
        if (failed) fail(m_folder / name, "can't be made: " + failed.message());
    }
    const fs::path lock = m_folder / "lock";
    m_lock = ::open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (m_lock < 0) fail(lock, fmt::format("can't be written: {}", std::strerror(errno)));
    if (::flock(m_lock, LOCK_EX | LOCK_NB) != 0)
        fail(m_folder, "another pm_host farm has this job in hand; wait for it, or end it");
}

void JobFolder::writePlan(const FarmPlan& plan) const {
    writeFinishedFile(runScript(), runScriptText(plan));
    writeFinishedFile(m_folder / "tasks.txt", taskLines(plan));
    writeFinishedFile(m_folder / "plan.json", plan.toJson());  // last: with it the rest is there
}

}  // namespace pm::host
