// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <functional>
#include <vector>

#include "host_shim/check/scene_check.h"
#include "host_shim/cli/options.h"
#include "host_shim/process/child_process.h"
#include "host_shim/process/temporary_folder.h"

namespace pm::host {

// The renders of a suite's scenes, each by a process of its own, and what becomes of them.
class CheckRun {
  public:
    // told: as each scene is done. All must outlive this.
    CheckRun(const CheckOptions& options, const Suite& suite,
             std::function<void(const SceneOutcome&)> told);

    // In the suite's order; of the scenes that --only names. Errors: kUsage for a name that the
    // suite has not, and those of the references' files.
    std::vector<SceneOutcome> check();
    // Renders each scene with its own seed and with others, and stores picture and numbers.
    // A scene of which a render fails keeps what it had.
    std::vector<SceneOutcome> update();

  private:
    struct Render {
        std::size_t outcome{};
        bool isTwin{};
        RenderedFiles files;
    };
    void choose();
    // twin: 0, or see makeTwin.
    Render addRender(std::size_t outcome, std::uint64_t seed, std::int32_t twin = 0);
    // What to type to repeat a task's render.
    std::string commandOf(const SuiteScene& scene, const std::vector<std::string>& words) const;
    std::vector<std::string> wordsOf(const SuiteScene& scene, std::uint64_t seed,
                                     std::int32_t twin) const;
    static void clean(const Render& render);
    // Runs work on one scene's files; what is wrong there keeps no other from being done.
    static void guard(SceneOutcome& outcome, const std::function<void()>& work);
    // Whether the render came to an end; else the outcome says why not.
    bool ended(const ChildResult& result, std::size_t task, SceneOutcome& outcome) const;
    void run(const std::function<void(std::size_t task, const ChildResult&)>& done);
    void store(SceneOutcome& outcome, const std::vector<Render>& renders);

    const CheckOptions& m_options;
    const Suite& m_suite;
    std::function<void(const SceneOutcome&)> m_told;
    TemporaryFolder m_folder;
    std::vector<SceneOutcome> m_outcomes;
    std::vector<ChildTask> m_tasks;
    std::vector<std::string> m_commands;  // that repeat them
};

// The exit code: 6 when any scene differs, fails or is out of time, else 3 when a reference is
// missing, else 0.
int exitCodeOf(const std::vector<SceneOutcome>& outcomes);

}  // namespace pm::host
