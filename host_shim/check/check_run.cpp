// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/check/check_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string_view>
#include <thread>

#include "host_shim/check/junit.h"
#include "host_shim/check/reference_making.h"
#include "host_shim/pictures/compare.h"
#include "host_shim/pictures/picture_io.h"
#include "host_shim/process/interrupt.h"
#include "host_shim/process/outputs.h"
#include "host_shim/report/report_command.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kOwnSeed = 1;
constexpr std::string_view kTag = "tag:";
constexpr std::uint64_t kFirstOtherSeed = 1001;

bool isNamed(const std::vector<std::string>& options, std::string_view name) {
    return std::ranges::any_of(options, [&](const std::string& option) {
        return option == name || option.starts_with(std::string(name) + "=");
    });
}

// The numbers say whose the pictures are. Errors: kFile, kBadInput.
void checkIsReference(const ReferenceFiles& files) {
    if (fs::exists(files.numbers)) {
        readReference(files.numbers);
        return;
    }
    for (const fs::path& picture : files.pictures())
        if (fs::exists(picture))
            throw HostError(ExitCode::kFile,
                            fmt::format("--update: {} is there without {}, so it is no reference "
                                        "of pm's; it would be overwritten",
                                        picture.string(), files.numbers.filename().string()));
}

// What a program said last, of errors if there are any.
std::string lastLine(const fs::path& file) {
    constexpr std::string_view kOurs = "pm_host: ", kWarning = "pm_host: warning: ";
    std::ifstream stream(file);
    std::string line, last, error;
    while (std::getline(stream, line)) {
        if (!line.empty()) last = line;
        if (line.starts_with(kOurs) && !line.starts_with(kWarning)) error = line;
    }
    return error.empty() ? last : error;
}

// Errors are told in the unit of the reference. Nothing where that can't be read, which is told
// when it is wanted.
std::optional<std::int32_t> errorScaleOfReference(const Suite& suite, const SuiteScene& scene) {
    try {
        return errorScaleOf(readExr(referenceFiles(suite, scene).picture));
    } catch (const HostError&) {
        return std::nullopt;
    }
}

// The scene itself, or tag:NAME of it.
bool isMeant(const std::string& asked, const SuiteScene& scene) {
    if (!asked.starts_with(kTag)) return asked == scene.name;
    return std::ranges::find(scene.tags, asked.substr(kTag.size())) != scene.tags.end();
}

}  // namespace

CheckRun::CheckRun(const CheckOptions& options, const Suite& suite,
                   std::function<void(const SceneOutcome&)> told)
    : m_options(options), m_suite(suite), m_told(std::move(told)) {
    choose();
}

void CheckRun::choose() {
    std::vector<std::string> asked = m_options.only;
    if (!m_options.failed.empty()) {
        const std::vector<std::string> failed = failedScenes(m_options.failed);
        if (failed.empty())
            throw HostError(ExitCode::kUsage, fmt::format("--failed: all scenes of {} were right",
                                                          m_options.failed.string()));
        asked.insert(asked.end(), failed.begin(), failed.end());
    }
    for (const std::string& name : asked)
        if (std::ranges::none_of(m_suite.scenes,
                                 [&](const SuiteScene& scene) { return isMeant(name, scene); }))
            throw HostError(ExitCode::kUsage,
                            fmt::format("--only '{}': the suite has {}; its tags are {}", name,
                                        namesOf(m_suite), fmt::join(tagsOf(m_suite), ", ")));
    for (const SuiteScene& scene : m_suite.scenes) {
        if (!asked.empty() && std::ranges::none_of(asked, [&](const std::string& name) {
                return isMeant(name, scene);
            }))
            continue;
        m_outcomes.emplace_back().scene = &scene;
        checkOptions(m_suite, scene);
    }
}

CheckRun::Render CheckRun::addRender(std::size_t index, std::uint64_t seed, std::int32_t twin) {
    SceneOutcome& outcome = m_outcomes[index];
    const SuiteScene& scene = *outcome.scene;
    const std::string base =
        (m_folder.path() / fmt::format("{}_{}_{}", scene.name, seed, twin)).string();
    Render render{index,
                  twin != 0,
                  {base + ".exr", scene.hasDisplay ? fs::path(base + ".png") : fs::path(),
                   base + ".stats.json", base + ".log"}};
    ChildTask task;
    task.folder = m_suite.folder;
    task.log = render.files.log;
    std::vector<std::string>& words = task.arguments;
    words = wordsOf(scene, seed, twin);
    m_commands.push_back(commandOf(scene, words));
    if (outcome.command.empty()) outcome.command = m_commands.back();
    words.insert(words.end(),
                 {"--aov", "stderr", "-o", render.files.exr.string(), "-q", "--progress", "none",
                  "--stats", render.files.statistics.string(), "--input-hashes"});
    if (scene.hasDisplay) words.insert(words.end(), {"-o", render.files.png.string()});
    if (!m_options.update && !isNamed(scene.options, "--error-scale"))
        if (const auto stops = errorScaleOfReference(m_suite, scene))
            words.insert(words.end(), {"--error-scale", std::to_string(*stops)});
    if (!m_options.html.empty() && !m_options.update && findDisplay(m_suite, scene))
        words.insert(words.end(),
                     {"--report", reportPage(fs::absolute(m_options.html), scene).string()});
    if (m_options.jobs > 1 && !isNamed(scene.options, "--threads"))
        words.insert(
            words.end(),
            {"--threads", std::to_string(std::max(1u, std::thread::hardware_concurrency() /
                                                          static_cast<unsigned>(m_options.jobs)))});
    m_tasks.push_back(std::move(task));
    return render;
}

std::vector<std::string> CheckRun::wordsOf(const SuiteScene& scene, std::uint64_t seed,
                                           std::int32_t twin) const {
    std::vector<std::string> words{scene.scene.string()};
    words.insert(words.end(), scene.options.begin(), scene.options.end());
    words.insert(words.end(), {"--seed", std::to_string(seed)});
    if (twin != 0) words.insert(words.end(), {"--twin", std::to_string(twin)});
    if (!m_options.plugin.empty())
        words.insert(words.end(), {"--plugin", fs::absolute(m_options.plugin).string()});
    return words;
}

std::string CheckRun::commandOf(const SuiteScene& scene,
                                const std::vector<std::string>& words) const {
    std::vector<std::string> all{"pm_host"};
    all.insert(all.end(), words.begin(), words.end());
    all.insert(all.end(), {"-o", (temporaryPlace() / (scene.name + ".exr")).string()});
    return fmt::format("cd {} && {}", shellCommand({m_suite.folder.string()}), shellCommand(all));
}

void CheckRun::clean(const Render& render) {
    std::error_code ignored;
    const RenderedFiles& files = render.files;
    for (const fs::path& file : {files.exr, files.png, files.statistics, files.log})
        if (!file.empty()) fs::remove(file, ignored);
}

bool CheckRun::ended(const ChildResult& result, std::size_t task, SceneOutcome& outcome) const {
    using End = ChildResult::End;
    outcome.seconds += result.seconds;
    if (result.end == End::kExited && result.code == 0) return true;
    if (result.end == End::kOutOfTime || result.end == End::kNotStarted) {
        outcome.status = SceneOutcome::Status::kOutOfTime;
        outcome.findings = {{"time", fmt::format("not done within the --time-budget of {:g} s",
                                                 *m_options.timeBudgetSeconds)}};
        return false;
    }
    outcome.status = SceneOutcome::Status::kFailed;
    outcome.command = m_commands[task];
    const std::string line = lastLine(m_tasks[task].log);
    outcome.findings.push_back(
        {"render", result.end == End::kSignalled
                       ? fmt::format("ended by signal {}; {}", result.code, line)
                       : fmt::format("exit code {}; {}", result.code, line)});
    return false;
}

void CheckRun::run(const std::function<void(std::size_t, const ChildResult&)>& done) {
    const double most = std::numeric_limits<double>::max();
    const auto results = runChildren(
        m_tasks, m_options.jobs,
        std::chrono::duration<double>(m_options.timeBudgetSeconds.value_or(most)), done);
    for (std::size_t task = 0; task < results.size(); ++task)
        if (results[task].end == ChildResult::End::kNotStarted) done(task, results[task]);
}

void CheckRun::guard(SceneOutcome& outcome, const std::function<void()>& work) {
    try {
        work();
    } catch (const Interrupted&) {
        throw;
    } catch (const std::exception& error) {
        outcome.status = SceneOutcome::Status::kFailed;
        outcome.findings.push_back({"files", error.what()});
    }
}

std::vector<SceneOutcome> CheckRun::check() {
    std::vector<Render> renders;
    for (std::size_t i = 0; i < m_outcomes.size(); ++i)
        renders.push_back(addRender(i, m_options.seed.value_or(kOwnSeed)));
    run([&](std::size_t task, const ChildResult& result) {
        SceneOutcome& outcome = m_outcomes[renders[task].outcome];
        const Render& render = renders[task];
        if (ended(result, task, outcome))
            guard(outcome, [&] { checkScene(m_suite, render.files, outcome); });
        clean(render);
        m_told(outcome);
        // Those of all scenes together may be many.
        outcome.stored.reset();
        outcome.picture.reset();
    });
    return std::move(m_outcomes);
}

std::vector<SceneOutcome> CheckRun::update() {
    const auto others = static_cast<std::size_t>(m_options.seeds);
    std::vector<Render> renders;
    for (std::size_t i = 0; i < m_outcomes.size(); ++i) {
        // Before the first ray: they can be written, and what is there can be read.
        const ReferenceFiles files = referenceFiles(m_suite, *m_outcomes[i].scene);
        checkOutputs(files.pictures(), {files.numbers}, true);
        checkIsReference(files);
        renders.push_back(addRender(i, kOwnSeed));
        for (std::uint64_t other = 0; other < others; ++other)
            renders.push_back(addRender(i, kFirstOtherSeed + other));
        for (std::int32_t twin = 1; twin <= kTwins; ++twin)
            renders.push_back(addRender(i, kOwnSeed, twin));
    }
    std::vector<std::size_t> left(m_outcomes.size(), others + 1 + kTwins);
    std::vector<bool> good(m_outcomes.size(), true);
    run([&](std::size_t task, const ChildResult& result) {
        const std::size_t index = renders[task].outcome;
        SceneOutcome& outcome = m_outcomes[index];
        if (good[index]) good[index] = ended(result, task, outcome);
        if (--left[index] > 0) return;
        std::vector<Render> own;
        std::ranges::copy_if(renders, std::back_inserter(own),
                             [&](const Render& render) { return render.outcome == index; });
        if (good[index]) guard(outcome, [&] { store(outcome, own); });
        for (const Render& render : own) clean(render);
        m_told(outcome);
    });
    return std::move(m_outcomes);
}

void CheckRun::store(SceneOutcome& outcome, const std::vector<Render>& renders) {
    std::vector<RenderedFiles> seeds, twins;
    for (const Render& render : renders) (render.isTwin ? twins : seeds).push_back(render.files);
    const ReferenceFiles to = referenceFiles(m_suite, *outcome.scene);
    const MadeReference made =
        makeReference(m_suite, *outcome.scene, seeds, twins, m_options.because);
    storeReference(seeds.front(), made, to);
    outcome.status = SceneOutcome::Status::kSame;
    outcome.because = m_options.because;
    outcome.seenChange = seenChange(made.reference);
    outcome.warnings = *made.reference.warnings;
}

int exitCodeOf(const std::vector<SceneOutcome>& outcomes) {
    constexpr int kDifferent = 6;
    int code = 0;
    for (const SceneOutcome& outcome : outcomes) {
        if (outcome.isRight()) continue;
        if (outcome.status != SceneOutcome::Status::kMissing) return kDifferent;
        code = static_cast<int>(ExitCode::kBadInput);
    }
    return code;
}

}  // namespace pm::host
