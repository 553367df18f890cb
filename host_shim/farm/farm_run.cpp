// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/farm/farm_run.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <limits>
#include <thread>

#include "host_shim/cli/command_line.h"
#include "host_shim/cli/frame_options.h"
#include "host_shim/farm/engines/engine.h"
#include "host_shim/farm/farm_page.h"
#include "host_shim/farm/farm_planning.h"
#include "host_shim/farm/farm_preview.h"
#include "host_shim/farm/farm_words.h"
#include "host_shim/farm/part_check.h"
#include "host_shim/farm/task_board.h"
#include "host_shim/formats/scene_url.h"
#include "host_shim/log/progress.h"
#include "host_shim/pictures/finished_file.h"
#include "host_shim/process/interrupt.h"
#include "host_shim/process/outputs.h"
#include "host_shim/process/plain_text.h"
#include "host_shim/session/session.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kGlance = std::chrono::milliseconds(50);
constexpr auto kBetweenLooks = std::chrono::milliseconds(500);  // for products
constexpr auto kBetweenQuestions = std::chrono::seconds(2);     // to the engine
constexpr auto kToEnd = std::chrono::seconds(2);                // of a task whose part is there
constexpr auto kBetweenPages = std::chrono::seconds(10);

class Farm {
  public:
    Farm(const Options& options, Log& log)
        : m_options(options), m_log(log), m_folder(options.farm->job) {}

    int run() {
        const std::string scene = m_options.scene.string();
        if (isSceneUrl(scene) && withoutPasswords(scene) != scene)
            throw HostError(ExitCode::kUsage,
                            fmt::format("{}: a job keeps no user and password in an address; put "
                                        "them into ~/.netrc of its machines",
                                        scene));
        const std::vector<Options> frames = perFrame(m_options);
        for (const Options& frame : frames) checkOutputs(frame.outputs, {}, frame.makeOutputPath);
        makePlan(frames);
        if (m_options.farm->dryRun || !m_engine) {
            print(m_options.farm->dryRun ? farmPreview(m_plan, m_folder, m_engine.get())
                                         : farmCommands(m_plan, m_folder));
            return 0;
        }
        int code = 0;
        try {
            renderAll();
            code = writePictures();
        } catch (...) {
            m_engine->cancel();
            writePage();
            throw;
        }
        // Who has been started twice has nothing left to do; those whose parts have just come are
        // about to end by themselves.
        waitForEnds();
        if (!m_engine->unfinished().empty()) m_engine->cancel();
        writePage();
        return code;
    }

  private:
    static void print(const std::string& text) {
        std::fwrite(text.data(), 1, text.size(), stdout);
        std::fflush(stdout);
    }
    void waitForEnds() {
        const auto until = Clock::now() + kToEnd;
        while (!m_engine->unfinished().empty() && Clock::now() < until && interruptSignal() == 0)
            std::this_thread::sleep_for(kGlance);
    }
    void makePlan(const std::vector<Options>& frames) {
        const FarmOptions& farm = *m_options.farm;
        if (farm.dryRun)
            m_folder.check();
        else
            m_folder.prepare();
        if (farm.engine != "commands") m_engine = makeEngine(farm, m_folder, m_log);
        if (auto plan = m_folder.readPlan()) {
            checkPlanFits(*plan, farm, m_folder);
            m_plan = std::move(*plan);
            return;
        }
        const auto machines = m_engine ? m_engine->machines() : std::vector<FarmMachine>{};
        m_plan = planFarm(frames, m_folder, machines, m_log);
        m_plan.given = planOptions(farm);
        if (!farm.dryRun) m_folder.writePlan(m_plan);
        // Of commands that are printed nobody knows where they will run, nor of nodes that are
        // down.
        const std::string where = machines.empty() ? std::string("machines that aren't known yet")
                                                   : fmt::format("{} machine{}", machines.size(),
                                                                 machines.size() == 1 ? "" : "s");
        m_log.info(fmt::format("{} task{} for {}, instruction set {}", m_plan.tasks.size(),
                               m_plan.tasks.size() == 1 ? "" : "s", where, m_plan.isa));
    }
    // Until every part is there and whole.
    void renderAll() {
        TaskBoard board(m_plan, m_folder, m_options.farm->tries, m_log);
        board.lookForProducts();
        reopenDamaged(board);
        if (board.open().size() < m_plan.tasks.size())
            m_log.info(fmt::format("{} of {} tasks are done already",
                                   m_plan.tasks.size() - board.open().size(), m_plan.tasks.size()));
        std::set<int> toStart = board.open();
        for (const int task : m_engine->unfinished()) toStart.erase(task);
        Progress progress(m_options.progress, m_options.quiet, m_log);
        while (!board.open().empty()) {
            board.start(toStart, *m_engine);
            toStart = follow(board, progress);
            if (board.open().empty()) {
                reopenDamaged(board);
                toStart = board.open();
            }
        }
        progress.update(1, 0);
    }
    void reopenDamaged(TaskBoard& board) {
        for (std::size_t frame = 0; frame < m_plan.frames.size(); ++frame)
            for (const int task : runsWithoutPart(m_plan, frame, m_options.plugin, m_log))
                board.reopen(task);
    }
    // Waits until all tasks are done or some are to be started again, which it returns.
    std::set<int> follow(TaskBoard& board, Progress& progress) {
        auto lookAt = Clock::now(), askAt = lookAt;
        const double begun = board.fraction();
        const auto start = Clock::now();
        for (;; std::this_thread::sleep_for(kGlance)) {
            throwIfInterrupted();
            const auto now = Clock::now();
            if (now >= lookAt) {
                lookAt = now + kBetweenLooks;
                tellDone(board);
                if (board.open().empty()) return {};
                showProgress(board.fraction(), begun, now - start, progress);
            }
            if (now < askAt) continue;
            askAt = now + kBetweenQuestions;
            const std::set<int> unfinished = m_engine->unfinished();
            board.lookForProducts();
            const std::set<int> lost = board.lost(unfinished);
            if (!lost.empty()) return lost;
            if (now >= m_pageAt) {
                m_pageAt = now + kBetweenPages;
                writePage();
            }
        }
    }
    void tellDone(TaskBoard& board) {
        for (const int task : board.lookForProducts())
            m_log.message(Level::kDebug,
                          fmt::format("task {} ({}) is done", task, m_plan.what(task)));
    }
    void showProgress(double fraction, double begun, std::chrono::duration<double> elapsed,
                      Progress& progress) {
        m_fraction = std::max(m_fraction, fraction);  // what is started again is no step back
        const double done = m_fraction - begun;
        progress.update(std::min(m_fraction, 0.999),
                        done > 0 ? elapsed.count() * (1 - m_fraction) / done
                                 : std::numeric_limits<double>::quiet_NaN());
    }
    int writePictures() {
        int code = 0;
        for (std::size_t frame = 0; frame < m_plan.frames.size(); ++frame) {
            const int its = Session(mergeOptions(frame), m_log).run();
            if (code == 0) code = its;
        }
        return code;
    }
    Options mergeOptions(std::size_t frame) const {
        std::vector<std::string> words{"merge"};
        for (const FarmTask& task : m_plan.tasks)
            if (task.kind == FarmTask::Kind::kRun && task.frame == frame)
                words.push_back(task.product.string());
        const auto& more = m_plan.frames[frame].mergeWords;
        words.insert(words.end(), more.begin(), more.end());
        Options options = parseCommandLine(words, /*areNamesFilled=*/true);
        options.commandLine = words;
        return options;
    }
    // A page that can't be written is no reason to end a render.
    void writePage() {
        try {
            writeFinishedFile(m_folder.page(), farmPage(m_plan, m_folder));
        } catch (const HostError& fault) {
            m_log.message(Level::kError, fault.what());
        }
    }

    const Options& m_options;
    Log& m_log;
    JobFolder m_folder;
    FarmPlan m_plan;
    std::unique_ptr<Engine> m_engine;  // none where commands are printed
    double m_fraction{};
    Clock::time_point m_pageAt{};
};

}  // namespace

int runFarm(const Options& options, Log& log) {
    return Farm(options, log).run();
}

}  // namespace pm::host
