// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// How far single pixels stand out of renders with rough metal, rough glass and many casters: six
// scenes, by many seeds each.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "integrator/values/error.h"
#include "tests/bench/error/estimate_run.h"
#include "tests/bench/error/unlike_scenes.h"
#include "tests/bench/plot/report.h"
#include "tests/bench/run/bench_lists.h"
#include "tests/bench/run/child_process.h"
#include "tests/bench/run/pictures.h"
#include "tests/bench/run/timing.h"
#include "tests/bench/specks/specks.h"

namespace pm::bench {
namespace {

namespace fs = std::filesystem;

struct Options {
    fs::path host = PM_HOST_FILE, data = PM_SHARED_DATA_CASES, pictures;
    std::string scenes, csvFile, docsFile, more;
    int seeds = 20, firstSeed = 1, threads = 2, width = 320, height = 240;
    std::uint32_t passes = 4;
    bool quick = false;
};

// A file and the view of it, or a scene that is made here.
struct SpeckScene {
    std::string key;
    fs::path file;                  // relative: to the folder of scenes that are written
    std::vector<std::string> view;  // options
    bool isMadeOfData = false;
};

std::vector<SpeckScene> speckScenes() {
    const fs::path own = fs::path(PM_SOURCE_DIR) / "scenes";
    return {
        {"materials", own / "materials/materials.obj", {}},
        {"glass", own / "glass/glass.obj", {}},
        {"balls", "balls.obj", {"--eye", "0,0,0.9", "--look-at", "0,0,0", "--fov", "60"}, true},
        {"hall", "hall.obj", {"--eye", "-9,2.2,5.2", "--look-at", "4,0.6,-2", "--fov", "50"}, true},
        {"night",
         "night.obj",
         {"--environment", "night.hdr", "--eye", "3,3.2,9", "--look-at", "0,0.5,0", "--fov", "45"}},
        {"furnished", {}, {}}};
}

struct Renders {
    std::vector<Values> pictures;
    std::vector<double> told, seconds;
};

class SpecksBench {
  public:
    explicit SpecksBench(const Options& options) : m_options(options) {}
    void run();

  private:
    void writeScenes() const;
    Renders render(const SpeckScene& scene) const;
    Renders renderFurnished() const;
    void renderFile(const SpeckScene& scene, int seed, Renders& renders) const;
    void tell(const std::string& key, const Renders& renders);

    Options m_options;
    TemporaryFolder m_folder;
    Report m_report{"pm_bench_specks"};
};

void SpecksBench::writeScenes() const {
    std::vector<std::string> command{"python3", PM_SPECK_SCENES, m_folder.path().string()};
    if (fs::exists(m_options.data)) command.push_back(m_options.data.string());
    const fs::path log = m_folder.path() / "log";
    if (runChild(command, m_folder.path(), log).exitCode != 0)
        throw Error(Status::kInternal, "scenes can't be written: " + lastLineOf(log));
}

void SpecksBench::renderFile(const SpeckScene& scene, int seed, Renders& renders) const {
    const fs::path log = m_folder.path() / "log", stats = m_folder.path() / "stats.json",
                   picture = m_folder.path() / "picture.exr";
    std::vector<std::string> command{m_options.host.string(), scene.file.string()};
    command.insert(command.end(), scene.view.begin(), scene.view.end());
    for (const std::string& option :
         {std::string("-q"), std::string("--size"),
          fmt::format("{}x{}", m_options.width, m_options.height), std::string("--passes"),
          std::to_string(m_options.passes), std::string("--seed"), std::to_string(seed),
          std::string("--threads"), std::to_string(m_options.threads), std::string("-o"),
          picture.string(), std::string("--stats"), stats.string()})
        command.push_back(option);
    std::istringstream more(m_options.more);
    for (std::string option; more >> option;) command.push_back(option);
    const ChildResult done = runChild(command, m_folder.path(), log);
    if (done.exitCode != 0)
        throw Error(Status::kInternal, fmt::format("{}: {}", scene.key, lastLineOf(log)));
    renders.pictures.push_back(readPicture(picture).rgb);
    std::ifstream file(stats);
    renders.told.push_back(nlohmann::json::parse(file)["relMseEstimate"].get<double>());
    renders.seconds.push_back(done.processorSeconds);
    if (!m_options.pictures.empty() && seed == m_options.firstSeed)
        writePng(m_options.pictures / (scene.key + ".png"), readPicture(picture), 1);
}

Renders SpecksBench::renderFurnished() const {
    Renders renders;
    for (const UnlikeScene& scene : unlikeScenes()) {
        if (scene.key != "furnished") continue;
        const PassSource source(scene.maker.build(), scene.key, {}, m_options.threads);
        for (int i = 0; i < m_options.seeds; ++i) {
            const auto seed = static_cast<std::uint64_t>(m_options.firstSeed + i);
            const Judged last = source
                                    .judged(judgedSettings(m_options.width, m_options.height,
                                                           m_options.passes, seed))
                                    .back();
            renders.pictures.push_back(last.rgb);
            renders.told.push_back(last.estimate.total());
            renders.seconds.push_back(last.processorSeconds);
            if (!m_options.pictures.empty() && i == 0)
                writePng(m_options.pictures / "furnished.png",
                         {m_options.width, m_options.height, last.rgb}, 1);
        }
    }
    return renders;
}

Renders SpecksBench::render(const SpeckScene& scene) const {
    if (scene.file.empty()) return renderFurnished();
    Renders renders;
    for (int i = 0; i < m_options.seeds; ++i) renderFile(scene, m_options.firstSeed + i, renders);
    return renders;
}

void SpecksBench::tell(const std::string& key, const Renders& renders) {
    std::vector<double> errors, ofWorst;
    for (std::size_t i = 0; i + 1 < renders.pictures.size(); i += 2) {
        const PairError pair = errorOfPair(renders.pictures[i], renders.pictures[i + 1]);
        errors.push_back(pair.mean);
        ofWorst.push_back(pair.ofWorst);
    }
    const Specks specks = findSpecks(renders.pictures, m_options.width, m_options.height);
    m_report.row(
        {key, show(meanOf(errors)), fmt::format("{:.1f} %", 100 * spreadOf(ofWorst).median),
         fmt::format("{:.1f} at {},{}", specks.worstRatio, specks.x, specks.y),
         std::to_string(specks.count), fmt::format("{:.1f} %", 100 - 100 * specks.judged),
         show(meanOf(renders.told)), fmt::format("{:.2f}", meanOf(renders.told) / meanOf(errors)),
         show(meanOf(renders.seconds)), show(meanOf(renders.seconds) * meanOf(errors))});
}

void SpecksBench::run() {
    writeScenes();
    m_report.table(
        fmt::format("Specks after {} passes, {} x {}, {} seeds: of pairs of seeds the noise's "
                    "relMSE and the share of it that the worst .1 % of the pixels hold (median "
                    "pair); a pixel's standard deviation over that of those beside it",
                    m_options.passes, m_options.width, m_options.height, m_options.seeds),
        {"scene", "noise", "worst .1 %", "worst pixel", "specks", "not judged", "told",
         "told / noise", "processor s", "noise x s"});
    for (const SpeckScene& scene : speckScenes()) {
        if (!isAskedFor(m_options.scenes, scene.key)) continue;
        if (scene.isMadeOfData && !fs::exists(m_options.data)) {
            fmt::print(stderr, "pm_bench_specks: {} skipped, its script is not there\n", scene.key);
            continue;
        }
        tell(scene.key, render(scene));
    }
    m_report.publish(m_options.csvFile, m_options.docsFile);
}

int runProgram(int argc, char** argv) {
    Options options;
    CLI::App app("Specks in six scenes of rough metal, rough glass and many casters");
    app.add_option("--scenes", options.scenes, "keys with commas between (all)");
    app.add_option("--seeds", options.seeds, "renders of a scene (20)")->check(CLI::Range(2, 9999));
    app.add_option("--first-seed", options.firstSeed, "the others follow it (1)");
    app.add_option("--passes", options.passes, "of each, a power of two (4)")
        ->check(CLI::Range(2, 9999));
    app.add_option("--width", options.width, "pixels (320)");
    app.add_option("--height", options.height, "pixels (240)");
    app.add_option("--threads", options.threads, "threads (2)");
    app.add_option("--host", options.host, "the pm_host to render by");
    app.add_option("--options", options.more, "more options of it");
    app.add_option("--pictures", options.pictures, "write the first seed's to this folder");
    app.add_option("--csv", options.csvFile, "also write the table to this CSV file");
    app.add_option("--docs", options.docsFile, "also put the table into this Markdown file");
    app.add_flag("--quick", options.quick, "2 seeds, 2 passes, 160 x 120");
    CLI11_PARSE(app, argc, argv);
    if (options.quick) {
        options.seeds = 2;
        options.passes = 2;
        options.width = 160;
        options.height = 120;
    }
    try {
        SpecksBench(options).run();
        return 0;
    } catch (const std::exception& e) {
        fmt::print(stderr, "pm_bench_specks: {}\n", e.what());
        return 1;
    }
}

}  // namespace
}  // namespace pm::bench

int main(int argc, char** argv) {
    return pm::bench::runProgram(argc, argv);
}
