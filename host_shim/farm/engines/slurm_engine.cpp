// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/farm/engines/slurm_engine.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "host_shim/farm/engines/machine_question.h"
#include "host_shim/farm/engines/slurm_script.h"
#include "host_shim/formats/json/json_reader.h"
#include "host_shim/formats/text_lines.h"
#include "host_shim/formats/warnings.h"
#include "host_shim/pictures/finished_file.h"
#include "host_shim/process/interrupt.h"
#include "host_shim/process/program.h"
#include "host_shim/report/report_command.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

using Json = nlohmann::ordered_json;

// Indices of an array are below MaxArraySize, 1001 where nobody has set it.
constexpr int kArraySize = 1000;
constexpr std::chrono::seconds kBetweenTries{2};
constexpr int kMostOffset = std::numeric_limits<int>::max();
// A job that Slurm holds is let go again, but not for ever.
constexpr int kMostReleases = 5;

bool isSilence(const std::string& text) {
    constexpr std::array<std::string_view, 6> kTexts{
        "Unable to contact slurm controller", "Connection refused", "Socket timed out",
        "Zero Bytes were transmitted",        "Connection reset",   "Transport endpoint"};
    return std::ranges::any_of(
        kTexts, [&](std::string_view part) { return text.find(part) != std::string::npos; });
}

std::string oneLine(std::string text) {
    while (!text.empty() && text.back() == '\n') text.pop_back();
    std::ranges::replace(text, '\n', ';');
    return text;
}

// A path that sbatch's --output takes as it is: it fills in %j and the like, but not where the text
// has a backslash, of which it drops one each.
std::string withoutPatterns(const std::string& path) {
    const char special = path.find('\\') == std::string::npos ? '%' : '\\';
    std::string text;
    for (const char c : path) text.append(c == special ? 2 : 1, c);
    return text;
}

std::vector<std::string> splitAt(const std::string& line, char separator) {
    std::vector<std::string> parts;
    std::istringstream stream(line);
    for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
    return parts;
}

// States of a job that it leaves again; all others are ends.
bool isUnfinished(const std::string& state) {
    constexpr std::array<std::string_view, 13> kStates{
        "PENDING",      "RUNNING",  "SUSPENDED",    "CONFIGURING", "COMPLETING",
        "REQUEUED",     "RESIZING", "REQUEUE_HOLD", "REQUEUE_FED", "SIGNALING",
        "SPECIAL_EXIT", "STOPPED",  "STAGE_OUT"};
    return std::ranges::find(kStates, state) != kStates.end();
}

}  // namespace

SlurmEngine::SlurmEngine(const FarmOptions& options, const JobFolder& folder, Log& log)
    : m_options(options), m_folder(folder), m_log(log) {
    std::error_code ignored;
    if (!std::filesystem::exists(folder.engineState(), ignored)) return;
    const auto fail = [&folder] {
        throw HostError(ExitCode::kBadInput,
                        folder.engineState().string() + ": is no list of Slurm's arrays");
    };
    const auto json = parseJsonFile(folder.engineState(), throwIfInterrupted);
    const auto arrays = json.find("arrays");
    if (arrays == json.end() || !arrays->is_object()) fail();
    for (const auto& [number, offset] : arrays->items()) {
        const bool isNumber = !number.empty() && std::ranges::all_of(number, [](char letter) {
            return letter >= '0' && letter <= '9';
        });
        if (!isNumber || !offset.is_number_integer() || offset < 0 || offset > kMostOffset) fail();
        m_arrays[number] = offset.get<int>();
    }
}

void SlurmEngine::keep() const {
    Json json = {{"engine", "slurm"}, {"arrays", Json::object()}};
    for (const auto& [number, offset] : m_arrays) json["arrays"][number] = offset;
    writeFinishedFile(m_folder.engineState(), json.dump(1) + "\n");
}

std::set<std::string> SlurmEngine::nodesUp() {
    const ProgramEnd listed = runProgram(
        {"sinfo", "--noheader", "--Node", "--states=idle,mixed,allocated", "--format=%N"});
    if (listed.code != 0)
        throw HostError(ExitCode::kUsage,
                        fmt::format("--engine slurm: sinfo: {} (so it is where the controller is "
                                    "away, and where it refuses the munge key)",
                                    oneLine(listed.err)));
    std::set<std::string> names;
    for (const std::string& name : splitAt(listed.out, '\n'))
        if (!name.empty()) names.insert(name);
    return names;
}

std::vector<FarmMachine> SlurmEngine::machines() {
    std::set<std::string> names = nodesUp();
    if (names.empty()) {
        m_log.warning(static_cast<int>(Warning::kFarm),
                      "no node is up (sinfo); tasks wait until one is");
        return {};
    }
    std::vector<std::string> ask{"srun",
                                 "--quiet",
                                 "--immediate=5",
                                 "--time=1",
                                 "--ntasks-per-node=1",
                                 fmt::format("--nodes={}", names.size())};
    ask.insert(ask.end(), m_options.slurmOptions.begin(), m_options.slurmOptions.end());
    ask.insert(ask.end(), {"sh", "-c", machineQuestion()});
    std::vector<FarmMachine> machines = machineAnswers(runProgram(ask, kToAnswer).out);
    for (const FarmMachine& machine : machines) names.erase(machine.name);
    for (const std::string& name : names) machines.push_back({name, {}});
    return machines;
}

std::vector<SlurmEngine::Slice> SlurmEngine::slicesOf(const std::vector<int>& tasks) {
    std::vector<Slice> slices;
    for (const int task : tasks) {
        const int offset = task / kArraySize * kArraySize;
        if (slices.empty() || slices.back().offset != offset) slices.push_back({offset, {}});
        slices.back().indices.push_back(task - offset);
    }
    return slices;
}

std::vector<std::string> SlurmEngine::batchWords(const Slice& slice, const Where& where) const {
    std::vector<std::string> words{
        "sbatch",
        "--parsable",
        "--requeue",
        "--exclusive",
        "--open-mode=append",
        "--job-name=pm " + m_folder.path().filename().string(),
        "--output=" + withoutPatterns((m_folder.path() / "logs" / "slurm.log").string()),
        "--array=" + fmt::format("{}", fmt::join(slice.indices, ",")),
        fmt::format("--export=ALL,PM_FARM_OFFSET={}", slice.offset)};
    if (!where.after.empty())
        words.insert(words.end(),
                     {"--dependency=afterok:" + where.after, "--kill-on-invalid-dep=yes"});
    if (!where.exclude.empty()) words.push_back("--exclude=" + where.exclude);
    words.insert(words.end(), m_options.slurmOptions.begin(), m_options.slurmOptions.end());
    words.push_back(slurmScript(m_folder).string());
    return words;
}

// A controller that is away for a while is waited for.
std::string SlurmEngine::submitSlice(const std::vector<std::string>& words) {
    for (;;) {
        const ProgramEnd end = runProgram(words);
        if (end.code == 0) {
            m_isSilent = false;
            return end.out.substr(0, end.out.find_first_of(";\n"));
        }
        if (!isSilence(end.err))
            throw HostError(ExitCode::kUsage, "--engine slurm: " + oneLine(end.err));
        warnOfSilence(end.err);
        for (int i = 0; i < 20; ++i) {
            throwIfInterrupted();
            std::this_thread::sleep_for(kBetweenTries / 20);
        }
    }
}

std::string SlurmEngine::submit(const std::vector<int>& tasks, const Where& where) {
    std::string numbers;
    for (const Slice& slice : slicesOf(tasks)) {
        const std::string number = submitSlice(batchWords(slice, where));
        numbers += (numbers.empty() ? "" : ":") + number;
        m_arrays[number] = slice.offset;
        keep();
        m_log.info(fmt::format("Slurm's array {}: {} tasks", number, slice.indices.size()));
    }
    m_known.insert(tasks.begin(), tasks.end());
    return numbers;
}

// Of the machines to avoid those that may be: another must be up.
std::string SlurmEngine::excluded(const std::set<std::string>& avoid) {
    if (avoid.empty()) return {};
    std::set<std::string> up;
    try {
        up = nodesUp();
    } catch (const HostError&) {
        return {};  // a controller that is away is waited for elsewhere
    }
    const bool isOtherUp =
        std::ranges::any_of(up, [&](const std::string& name) { return !avoid.contains(name); });
    if (!isOtherUp) return {};
    m_log.info(fmt::format("not again on {}", fmt::join(avoid, ", ")));
    return fmt::format("{}", fmt::join(avoid, ","));
}

void SlurmEngine::start(const Order& order) {
    writeFinishedFile(slurmScript(m_folder), slurmScriptText(m_folder));
    const std::string exclude = excluded(order.avoid);
    const std::string numbers = order.first.empty() ? "" : submit(order.first, {"", exclude});
    if (!order.then.empty()) submit(order.then, {numbers, exclude});
}

void SlurmEngine::warnOfSilence(const std::string& text) {
    if (!m_isSilent)
        m_log.warning(static_cast<int>(Warning::kFarm),
                      "Slurm's controller does not answer and is waited for: " + oneLine(text));
    m_isSilent = true;
}

std::optional<std::string> SlurmEngine::queue() {
    std::string numbers;
    for (const auto& [number, offset] : m_arrays) numbers += (numbers.empty() ? "" : ",") + number;
    const ProgramEnd end = runProgram({"squeue", "--noheader", "--array", "--states=all",
                                       "--jobs=" + numbers, "--format=%F|%K|%T|%r|%i"});
    if (end.code != 0 && isSilence(end.err)) {
        warnOfSilence(end.err);
        return std::nullopt;
    }
    if (m_isSilent) m_log.info("Slurm's controller answers again");
    m_isSilent = false;
    // Arrays that ended long ago it doesn't know any more, which it calls an error.
    return end.code == 0 ? end.out : std::string();
}

void SlurmEngine::release(const std::string& job, int task, const std::string& reason) {
    if (m_releases[task]++ >= kMostReleases) return;
    m_log.warning(static_cast<int>(Warning::kFarm),
                  fmt::format("Slurm holds task {} ({}); it is released", task, reason));
    runProgram({"scontrol", "release", job});
}

std::set<int> SlurmEngine::unfinished() {
    if (m_arrays.empty()) return {};
    const std::optional<std::string> lines = queue();
    if (!lines) return m_known;
    std::set<int> tasks;
    for (const std::string& line : splitAt(*lines, '\n')) {
        const std::vector<std::string> parts = splitAt(line, '|');
        std::int64_t index = 0;
        if (parts.size() != 5 || !parseInteger(parts[1], index)) continue;
        const auto array = m_arrays.find(parts[0]);
        if (array == m_arrays.end() || !isUnfinished(parts[2])) continue;
        // The photons that it waits for have failed: it will never begin.
        if (parts[3] == "DependencyNeverSatisfied") continue;
        const int task = static_cast<int>(index) + array->second;
        tasks.insert(task);
        const bool isHeld = parts[2] == "REQUEUE_HOLD" ||
                            parts[3].find("held") != std::string::npos ||
                            parts[3].starts_with("JobHoldMaxRequeue");
        if (isHeld) release(parts[4], task, parts[3]);
    }
    m_known = tasks;
    return tasks;
}

void SlurmEngine::cancel() {
    try {
        std::vector<std::string> words{"scancel"};
        for (const auto& [number, offset] : m_arrays) words.push_back(number);
        if (words.size() == 1) return;
        const ProgramEnd end = runProgram(words);
        if (end.code != 0)
            m_log.warning(static_cast<int>(Warning::kFarm),
                          fmt::format("what runs can't be ended: {}; later: {}", oneLine(end.err),
                                      shellCommand(words)));
    } catch (const std::exception& fault) {
        m_log.message(Level::kError, fault.what());
    }
}

std::string SlurmEngine::preview(const Order& order) const {
    std::string text;
    for (const Slice& slice : slicesOf(order.first))
        text += shellCommand(batchWords(slice, {})) + "\n";
    for (const Slice& slice : slicesOf(order.then))
        text += shellCommand(batchWords(slice, {order.first.empty() ? "" : "PHOTONS", ""})) + "\n";
    return text;
}

}  // namespace pm::host
