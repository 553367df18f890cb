// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/error/error_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "integrator/values/error.h"
#include "tests/bench/peers/peers.h"
#include "tests/bench/plan/plan_table.h"
#include "tests/bench/plot/log_plot.h"
#include "tests/bench/run/child_process.h"
#include "tests/bench/run/pictures.h"
#include "tests/bench/run/tessellated.h"

namespace pm::bench {

namespace {

constexpr const char* kPhoton = "photon";
constexpr const char* kOwnBest = "POV-Ray against its own best";

std::string nameOf(const LadderRequest& request) {
    return fmt::format("{}, aa {}", request.integrator, request.levels);
}

std::string shown(const std::optional<double>& value) {
    return value ? show(*value) : "";
}

}  // namespace

ErrorBench::ErrorBench(const ErrorBenchOptions& options)
    : m_options(options), m_host(PM_PLUGIN_FILE) {
    if (m_options.quick) m_options.seconds /= 2;
}

void ErrorBench::run() {
    if (!m_options.picturesFolder.empty())
        std::filesystem::create_directories(m_options.picturesFolder);
    readJobs();
    for (const Job& job : m_jobs) measureOurs(job);
    measurePlan();
    if (!m_options.quick) measureTessellated();
    const bool withPeers = !m_options.quick && hasPeers();
    if (withPeers) measurePeers();
    keepEarlierPeers();
    summarize();
    if (!m_options.docsFile.empty())
        for (const Job& job : m_jobs) plot(job);
    m_report.publish(m_options.csvFile, m_options.docsFile);
    if (!withPeers) return;
    m_peersReport.publish("", m_options.docsFile);
    if (!m_options.docsFile.empty()) writeCurves(peersFile(), m_peers);
}

void ErrorBench::readJobs() {
    for (const char key : m_options.scenes) {
        Job job;
        job.scene = readNeutralScene(scenesFile(), std::string(1, key));
        job.yardstick.reference = readPicture(m_options.peers / (job.scene.name + ".exr")).rgb;
        job.yardstick.ownNoise = key == 'A' ? 3e-5 : key == 'B' ? 9e-5 : 2e-4;
        // In the third scene a few pixels of unbounded variance say nothing about the rest.
        if (job.scene.name == "sds") {
            job.yardstick.dropped = 0.001;
            job.yardstick.brightest = 20;
        }
        m_jobs.push_back(std::move(job));
    }
}

void ErrorBench::measureOurs(const Job& job) {
    m_report.table(fmt::format("{}, {} threads", job.scene.name, m_options.threads),
                   {"integrator", "passes", "samples a pixel", "relMSE", "estimated relMSE",
                    "estimated / true", "V = relMSE x samples", "relMSE common to two renders",
                    "estimated bias", "mean over reference", "seconds", "processor seconds"});
    for (const std::string& integrator : m_options.integrators)
        for (const std::string& level : m_options.aaLevels) {
            const bool photon = integrator == kPhoton;
            // Path tracing needs no second level (its passes are alike) and has no bias to tell.
            if (!photon && level != m_options.aaLevels.back()) continue;
            const LadderRequest request{
                integrator, level, m_options.threads, photon, m_options.passes, m_options.seconds};
            std::vector<LadderStep> steps = climb(m_host, job.scene, job.yardstick, request);
            ErrorCurve curve{job.scene.name, "pm " + nameOf(request), {}};
            for (const LadderStep& step : steps) {
                addStep(nameOf(request), step);
                curve.points.push_back({fmt::format("{} passes", step.passes), step.seconds,
                                        step.processorSeconds, step.error});
            }
            m_ours.push_back(std::move(curve));
            std::string file = fmt::format("{}_aa{}", integrator, level);
            std::ranges::replace(file, ':', '-');
            writeStepPictures(job, file, steps.back());
            if (photon && level == m_options.aaLevels.front())
                m_best.push_back({&job, request, std::move(steps.back())});
        }
}

void ErrorBench::addStep(const std::string& name, const LadderStep& step) {
    m_report.row({name, std::to_string(step.passes), show(step.samples), show(step.error),
                  shown(step.estimated),
                  step.estimated ? fmt::format("{:.2f}", *step.estimated / step.error) : "",
                  show(step.error * step.samples), shown(step.common), shown(step.estimatedBias),
                  fmt::format("{:.4f}", step.mean), show(step.seconds),
                  show(step.processorSeconds)});
}

void ErrorBench::writeStepPictures(const Job& job, const std::string& name,
                                   const LadderStep& step) const {
    if (m_options.picturesFolder.empty()) return;
    const auto path = [&](const std::string& what) {
        return std::filesystem::path(m_options.picturesFolder) / (job.scene.name + "_" + what);
    };
    const Picture picture{job.scene.size, job.scene.size, step.pictures[0]};
    const Picture reference{job.scene.size, job.scene.size, job.yardstick.reference};
    writeExr(path(name + ".exr"), picture);
    writePng(path(name + ".png"), picture, 1.0);
    writePng(path(name + "_difference.png"), differencePicture(picture, reference, 0, 2.0), 1.0);
    writePng(path(name + "_difference_blurred.png"), differencePicture(picture, reference, 4, 10.0),
             1.0);
    writePng(path("reference.png"), reference, 1.0);
}

void ErrorBench::measurePlan() {
    if (!beginPlanTable(m_host, m_report)) return;
    LadderRequest request;
    request.threads = m_options.threads;
    for (const Job& job : m_jobs) addPlanRow(m_host, job.scene, job.yardstick, request, m_report);
}

void ErrorBench::measureTessellated() {
    m_report.table("Spheres as meshes of 81,920 triangles, read from OBJ by pm_host",
                   {"scene", "integrator", "passes", "relMSE common to two renders, analytic",
                    "the same, meshes", "what the meshes alone change"});
    for (const Best& best : m_best) {
        if (best.job->scene.spheres.empty()) continue;
        const auto floor = tessellatedFloor(best.job->scene, scenesFile(), best.job->yardstick,
                                            best.request, best.step);
        if (floor)
            m_report.row({best.job->scene.name, nameOf(best.request),
                          std::to_string(best.step.passes), shown(best.step.common),
                          show(floor->common), show(floor->difference)});
    }
}

// Both of them, or what was measured of them last is kept.
bool ErrorBench::hasPeers() const {
    bool all = true;
    for (const char* const program : {"blender", "povray"}) {
        if (findProgram(program)) continue;
        fmt::print(stderr, "pm_bench_speed_error: no {} here, other renderers left out\n", program);
        all = false;
    }
    return all;
}

void ErrorBench::measurePeers() {
    const TemporaryFolder folder;
    m_peersReport.table(fmt::format("Other renderers, {} threads", m_options.threads),
                        {"scene", "renderer", "budget", "relMSE", "relMSE against its own best",
                         "mean over reference", "seconds", "processor seconds"});
    std::vector<std::string> failures;
    for (const Job& job : m_jobs)
        for (const auto& measure : {&ErrorBench::measureCycles, &ErrorBench::measurePovray}) try {
                (this->*measure)(job, folder.path());
            } catch (const Error& e) {
                // What was measured so far, minutes of it, shall not be lost.
                failures.push_back(fmt::format("{}: {}", job.scene.name, e.what()));
                fmt::print(stderr, "pm_bench_speed_error: {}\n", failures.back());
            }
    for (const std::string& failure : failures) m_peersReport.paragraph(failure);
}

// What was measured of other renderers in an earlier run, and not in this one.
void ErrorBench::keepEarlierPeers() {
    if (m_options.docsFile.empty()) return;
    for (ErrorCurve& curve : readCurves(peersFile())) {
        const auto isAlike = [&](const ErrorCurve& measured) {
            return measured.scene == curve.scene && measured.renderer == curve.renderer;
        };
        if (std::none_of(m_peers.begin(), m_peers.end(), isAlike))
            m_peers.push_back(std::move(curve));
    }
}

void ErrorBench::measureCycles(const Job& job, const std::filesystem::path& folder) {
    ErrorCurve curve{job.scene.name, "Cycles", {}};
    const PeerRequest request{scenesFile(), folder, m_options.threads, m_options.peerSeconds};
    for (const PeerPicture& p : renderWithCycles(job.scene, request)) {
        const Picture picture = readPicture(p.file);
        const double error = job.yardstick.relMse(picture.rgb);
        m_peersReport.row({job.scene.name, curve.renderer, p.budget, show(error), "",
                           fmt::format("{:.4f}", job.yardstick.meanOver(picture.rgb)),
                           show(p.seconds), show(p.processorSeconds)});
        curve.points.push_back({p.budget, p.seconds, p.processorSeconds, error});
    }
    if (!curve.points.empty()) m_peers.push_back(std::move(curve));
}

void ErrorBench::measurePovray(const Job& job, const std::filesystem::path& folder) {
    ErrorCurve truth{job.scene.name, "POV-Ray", {}}, own{job.scene.name, kOwnBest, {}};
    const PeerRequest request{scenesFile(), folder, m_options.threads, m_options.peerSeconds};
    const std::vector<PeerPicture> pictures = renderWithPovray(job.scene, request);
    if (pictures.empty()) return;
    Yardstick best = job.yardstick;
    best.reference = readPicture(pictures.back().file).rgb;
    for (const PeerPicture& p : pictures) {
        const Picture picture = readPicture(p.file);
        const double error = job.yardstick.relMse(picture.rgb);
        const double ownError = best.relMse(picture.rgb);
        const bool isBest = &p == &pictures.back();
        m_peersReport.row({job.scene.name, truth.renderer, p.budget, show(error),
                           isBest ? "" : show(ownError),
                           fmt::format("{:.4f}", job.yardstick.meanOver(picture.rgb)),
                           show(p.seconds), show(p.processorSeconds)});
        truth.points.push_back({p.budget, p.seconds, p.processorSeconds, error});
        if (!isBest) own.points.push_back({p.budget, p.seconds, p.processorSeconds, ownError});
    }
    m_peers.push_back(std::move(truth));
    m_peers.push_back(std::move(own));
}

void ErrorBench::summarize() {
    m_report.table("Seconds (processor seconds) to a relMSE",
                   {"scene", "renderer", "1e-2", "5e-3", "2e-3", "1e-3", "5e-4"});
    for (const Job& job : m_jobs)
        for (const std::vector<ErrorCurve>* curves : {&m_ours, &m_peers})
            for (const ErrorCurve& curve : *curves) {
                if (curve.scene != job.scene.name) continue;
                std::vector<std::string> row = {curve.scene, curve.renderer};
                for (const double error : {1e-2, 5e-3, 2e-3, 1e-3, 5e-4})
                    row.push_back(secondsTo(error, curve));
                m_report.row(std::move(row));
            }
}

void ErrorBench::plot(const Job& job) {
    LogPlot plot;
    plot.title = fmt::format("{}: error over processor time", job.scene.name);
    plot.xLabel = fmt::format("processor seconds ({} threads)", m_options.threads);
    plot.yLabel = "relMSE";
    plot.level = job.yardstick.ownNoise;
    plot.levelName = "the reference's noise";
    for (const std::vector<ErrorCurve>* curves : {&m_ours, &m_peers})
        for (const ErrorCurve& curve : *curves) {
            if (curve.scene != job.scene.name) continue;
            PlotLine line{curve.renderer, {}, curve.renderer == kOwnBest};
            for (const ErrorPoint& point : curve.points)
                line.points.emplace_back(point.processorSeconds, point.error);
            plot.lines.push_back(std::move(line));
        }
    const std::string name = fmt::format("error_{}.svg", job.scene.name);
    const auto folder = std::filesystem::path(m_options.docsFile).parent_path() / "images";
    std::filesystem::create_directories(folder);
    writeSvg(folder / name, plot);
    m_report.paragraph(
        fmt::format("![Error over processor seconds, {}](images/{})", job.scene.name, name));
}

std::filesystem::path ErrorBench::peersFile() const {
    return std::filesystem::path(m_options.docsFile).parent_path() / "peer_errors.csv";
}

}  // namespace pm::bench
