// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// How far the three neutral scenes are from their references after how many seconds: relMSE, its
// product with the samples a pixel (V), and the seconds to a given relMSE.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "integrator/values/error.h"
#include "tests/bench/bench_scenes.h"
#include "tests/bench/picture_error.h"
#include "tests/bench/pictures.h"
#include "tests/bench/render_run.h"
#include "tests/bench/report.h"

namespace pm::bench {
namespace {

struct Options {
    std::filesystem::path peers = PM_SHARED_PEERS;
    std::string csvFile, docsFile, picturesFolder;
    std::string scenes = "ABC";
    std::vector<std::string> integrators = {"photon", "path"};
    std::vector<std::uint32_t> levels = {3, 4};
    std::uint32_t passes = 16;
    int threads = 2;
};

// One row of the table, and what the summary is made of.
struct Measurement {
    double seconds, processorSeconds, error;
};

// Seconds to an error, and processor seconds in brackets, along a straight line between the
// logarithms of the measurements.
std::string secondsTo(double wanted, const std::vector<Measurement>& measured) {
    for (std::size_t i = 0; i < measured.size(); ++i) {
        const Measurement& b = measured[i];
        if (b.error > wanted) continue;
        if (i == 0) return fmt::format("< {} ({})", show(b.seconds), show(b.processorSeconds));
        const Measurement& a = measured[i - 1];
        const double t = std::log(a.error / wanted) / std::log(a.error / b.error);
        const auto between = [t](double from, double to) { return from * std::pow(to / from, t); };
        return fmt::format("{} ({})", show(between(a.seconds, b.seconds)),
                           show(between(a.processorSeconds, b.processorSeconds)));
    }
    return "-";
}

class ErrorBench {
  public:
    explicit ErrorBench(const Options& options) : m_options(options) {}

    void run() {
        for (const char key : m_options.scenes) {
            const NeutralScene scene =
                readNeutralScene(m_options.peers / "scenes.json", std::string(1, key));
            m_name = scene.name;
            m_reference = readPicture(m_options.peers / (scene.name + ".exr"));
            // The third scene's few pixels of unbounded variance say nothing about the rest.
            m_dropped = scene.name == "sds" ? 0.001 : 0.0;
            m_report.table(fmt::format("{}, {} threads", scene.name, m_options.threads),
                           {"integrator", "passes x samples", "relMSE", "V = relMSE x samples",
                            "relMSE common to even and odd passes", "mean over reference",
                            "seconds", "processor seconds"});
            for (const std::string& integrator : m_options.integrators)
                for (const std::uint32_t level : m_options.levels)
                    measure(scene, integrator, level);
        }
        m_report.table("Seconds (processor seconds) to a relMSE",
                       {"scene", "integrator", "samples a pass", "1e-2", "5e-3", "2e-3", "1e-3"});
        for (auto& row : m_summary) m_report.row(std::move(row));
        m_report.publish(m_options.csvFile, m_options.docsFile);
    }

  private:
    void measure(const NeutralScene& scene, const std::string& name, std::uint32_t level) {
        const std::uint32_t samples = 1u << (2 * (level - 2));
        const auto kind = name == "path" ? IntegratorKind::kPath : IntegratorKind::kPhoton;
        const RenderSettings settings =
            test::smallFrame(scene.size, scene.size, kind, m_options.passes, level);
        const auto built = scene.maker.build();
        std::vector<Measurement> measured;
        renderPasses(built, settings, m_options.threads, [&](const Accumulated& so) {
            const double error = relativeError(so.mean, so.mean, m_reference.rgb, m_dropped);
            const double bias =
                so.passes < 2 ? 0
                              : relativeError(so.evenMean, so.oddMean, m_reference.rgb, m_dropped);
            m_report.row({name, fmt::format("{} x {}", so.passes, samples), show(error),
                          show(error * so.passes * samples), so.passes < 2 ? "" : show(bias),
                          meanRatio(so.mean), show(so.wallSeconds), show(so.processorSeconds)});
            measured.push_back({so.wallSeconds, so.processorSeconds, error});
            if (!m_options.picturesFolder.empty())
                writePictures(fmt::format("{}_{}_{}x{}", scene.name, name, so.passes, samples),
                              so.mean);
        });
        std::vector<std::string> row = {scene.name, name, std::to_string(samples)};
        for (const double wanted : {1e-2, 5e-3, 2e-3, 1e-3})
            row.push_back(secondsTo(wanted, measured));
        m_summary.push_back(std::move(row));
    }

    // Sum over channels, over the reference's: the first sign of lost or doubled light.
    std::string meanRatio(const std::vector<double>& mean) const {
        double ours = 0, theirs = 0;
        for (std::size_t i = 0; i < mean.size(); ++i) {
            ours += mean[i];
            theirs += m_reference.rgb[i];
        }
        return fmt::format("{:.4f}", ours / theirs);
    }

    void writePictures(const std::string& name, const std::vector<double>& mean) const {
        const std::filesystem::path folder = m_options.picturesFolder;
        const Picture picture{m_reference.width, m_reference.height, mean};
        writeExr(folder / (name + ".exr"), picture);
        writePng(folder / (name + ".png"), picture, 1.0);
        writePng(folder / (name + "_difference.png"),
                 differencePicture(picture, m_reference, 0, 2.0), 1.0);
        writePng(folder / (name + "_difference_blurred.png"),
                 differencePicture(picture, m_reference, 4, 10.0), 1.0);
        writePng(folder / (m_name + "_reference.png"), m_reference, 1.0);
    }

    Options m_options;
    Report m_report{"pm_bench_speed_error"};
    std::string m_name;  // of the scene
    Picture m_reference;
    double m_dropped = 0;
    std::vector<std::vector<std::string>> m_summary;
};

int runProgram(int argc, char** argv) {
    Options options;
    CLI::App app("Error against time on three neutral scenes");
    app.add_option("--peers", options.peers, "folder of scenes.json and the references");
    app.add_option("--csv", options.csvFile, "also write the tables to this CSV file");
    app.add_option("--docs", options.docsFile, "also put the tables into this Markdown file");
    app.add_option("--pictures", options.picturesFolder, "write pictures to this folder");
    app.add_option("--scenes", options.scenes, "of A, B, C (all)");
    app.add_option("--integrators", options.integrators, "photon, path or both (both)")
        ->check(CLI::IsMember({"photon", "path"}));
    app.add_option("--aa", options.levels, "levels of anti-aliasing, 2 to 6 (3 4)")
        ->check(CLI::Range(2, 6));
    app.add_option("--passes", options.passes, "passes of each render (16)");
    app.add_option("--threads", options.threads, "threads (2)");
    CLI11_PARSE(app, argc, argv);
    if (!std::filesystem::exists(options.peers / "scenes.json")) {
        fmt::print(stderr,
                   "pm_bench_speed_error: skipped, no scenes.json in the folder of peers\n");
        return 0;
    }
    try {
        ErrorBench(options).run();
        return 0;
    } catch (const std::exception& e) {
        fmt::print(stderr, "pm_bench_speed_error: {}\n", e.what());
        return 1;
    }
}

}  // namespace
}  // namespace pm::bench

int main(int argc, char** argv) {
    return pm::bench::runProgram(argc, argv);
}
