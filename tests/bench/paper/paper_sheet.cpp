// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Fig. 10 and 11 told: table, plots, files and pictures of what runPaperLevels() found.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "integrator/values/error.h"
#include "tests/bench/paper/paper_levels.h"
#include "tests/bench/plot/bar_plot.h"
#include "tests/bench/plot/log_plot.h"
#include "tests/bench/run/bench_lists.h"
#include "tests/bench/run/timing.h"

namespace pm::bench {

namespace {

constexpr int kTile = 192, kCrop = 64, kGap = 4;  // pixels of the sheet

double medianOf(const std::vector<double>& values) {
    return spreadOf(values).median;
}

// The square of side `side` at (x0, y0), resampled by area to kTile x kTile: pixels as squares when
// it grows.
Picture tileOf(const Picture& from, int x0, int y0, int side) {
    Picture tile{kTile, kTile, std::vector<double>(3 * kTile * kTile)};
    const double scale = static_cast<double>(side) / kTile;
    const auto overlap = [scale](int source, int target) {
        return std::max(0.0, std::min(source + 1.0, (target + 1) * scale) -
                                 std::max<double>(source, target * scale)) /
               scale;
    };
    for (int y = 0; y < kTile; ++y)
        for (int x = 0; x < kTile; ++x)
            for (int v = static_cast<int>(y * scale); v < std::min<double>(side, (y + 1) * scale);
                 ++v)
                for (int u = static_cast<int>(x * scale);
                     u < std::min<double>(side, (x + 1) * scale); ++u) {
                    const double share = overlap(u, x) * overlap(v, y);
                    for (int c = 0; c < 3; ++c)
                        tile.rgb[static_cast<std::size_t>(3 * (y * kTile + x) + c)] +=
                            share * from.rgb[static_cast<std::size_t>(
                                        3 * ((y0 + v) * from.width + x0 + u) + c)];
                }
    return tile;
}

void place(Picture& sheet, const Picture& tile, int column, int row, double exposure) {
    for (int y = 0; y < kTile; ++y)
        for (int x = 0; x < 3 * kTile; ++x)
            sheet.rgb[static_cast<std::size_t>(
                3 * ((row * (kTile + kGap) + y) * sheet.width + column * (kTile + kGap)) + x)] =
                exposure * tile.rgb[static_cast<std::size_t>(3 * y * kTile + x)];
}

// A row for each scene: the whole of it, then for each range what is in its crop.
Picture sheetOf(const std::vector<SceneLevels>& scenes) {
    int columns = 1;
    for (const LevelRun& run : scenes[0].runs) columns += isPictured(run, scenes[0]) ? 1 : 0;
    const int rows = static_cast<int>(scenes.size());
    Picture sheet{columns * (kTile + kGap) - kGap, rows * (kTile + kGap) - kGap, {}};
    sheet.rgb.assign(
        3 * static_cast<std::size_t>(sheet.width) * static_cast<std::size_t>(sheet.height), 1.0);
    for (int row = 0; row < rows; ++row) {
        const SceneLevels& levels = scenes[static_cast<std::size_t>(row)];
        const PaperScene& scene = levels.scene;
        place(sheet, tileOf(levels.reference, 0, 0, levels.reference.width), 0, row,
              scene.exposure);
        int column = 1;
        for (const LevelRun& run : levels.runs)
            if (isPictured(run, levels))
                place(sheet, tileOf(run.picture, scene.cropX, scene.cropY, kCrop), column++, row,
                      scene.exposure);
    }
    return sheet;
}

BarPlot barsOf(const std::vector<SceneLevels>& scenes) {
    BarPlot plot{{}, {{"Whole renders of 4 passes", "processor seconds", {}, {}}}, ""};
    BarPanel& panel = plot.panels.front();
    for (const LevelRun& run : scenes[0].runs) plot.series.push_back(run.range.name());
    panel.bars.resize(plot.series.size());
    for (const SceneLevels& levels : scenes) {
        panel.groups.push_back(levels.scene.name);
        for (std::size_t i = 0; i < levels.runs.size(); ++i)
            panel.bars[i].push_back({medianOf(levels.runs[i].processorSeconds), false});
    }
    return plot;
}

LogPlot errorsOf(const std::vector<SceneLevels>& scenes) {
    LogPlot plot{"Error against time, 4 passes", "processor seconds", "relMSE", {}, 0, ""};
    for (const SceneLevels& levels : scenes) {
        PlotLine fixed{levels.scene.name + ", fixed levels", {}, false};
        PlotLine ranges{levels.scene.name + ", ranges", {}, true};
        for (const LevelRun& run : levels.runs)
            (run.range.least == run.range.most ? fixed : ranges)
                .points.emplace_back(medianOf(run.processorSeconds), meanOf(run.errors));
        plot.lines.push_back(std::move(fixed));
        plot.lines.push_back(std::move(ranges));
    }
    return plot;
}

}  // namespace

bool isPictured(const LevelRun& run, const SceneLevels& levels) {
    return run.range.least == 0 || levels.runs.front().range.least > 0 || run.range.most > 3;
}

void reportPaperLevels(Report& report, const std::vector<SceneLevels>& scenes) {
    for (const SceneLevels& levels : scenes) {
        report.table(
            fmt::format("Fig. 10, {}: {}; whole renders of 4 passes, {} x {} pixels, median of {} "
                        "interleaved turns, relMSE their mean (the reference's own noise is {} of "
                        "it); seconds are elapsed time, the rest is in processor seconds",
                        levels.scene.name, levels.scene.what, levels.scene.scene.size,
                        levels.scene.scene.size, levels.runs[0].seconds.size(),
                        show(levels.referenceNoise)),
            {"levels", "seconds", "processor seconds", "over the first", "samples a pixel",
             "relMSE", "relMSE x processor seconds, thousandths"});
        const double first = medianOf(levels.runs[0].processorSeconds);
        for (const LevelRun& run : levels.runs) {
            const double seconds = medianOf(run.processorSeconds), error = meanOf(run.errors);
            report.row({run.range.name(), show(medianOf(run.seconds)), show(seconds),
                        fmt::format("{:.2f}", seconds / first), show(run.samples), show(error),
                        show(1000 * error * seconds)});
        }
    }
}

void writePaperLevels(const std::filesystem::path& folder, const std::vector<SceneLevels>& scenes) {
    const auto file = folder / "paper_levels.csv";
    std::ofstream csv(file);
    csv << "scene,least level,most,turn,seconds,processor seconds,samples a pixel,relMSE\n";
    for (const SceneLevels& levels : scenes)
        for (const LevelRun& run : levels.runs)
            for (std::size_t turn = 0; turn < run.seconds.size(); ++turn)
                csv << fmt::format("{},{},{},{},{:.6g},{:.6g},{:.6g},{:.6g}\n", levels.scene.name,
                                   run.range.least, run.range.most, turn + 1, run.seconds[turn],
                                   run.processorSeconds[turn], run.samples, run.errors[turn]);
    if (!csv.flush()) throw Error(Status::kIo, file.string() + ": can't be written");
    writeSvg(folder / "images" / "paper_levels.svg", barsOf(scenes));
    writeSvg(folder / "images" / "paper_levels_error.svg", errorsOf(scenes));
    writePng(folder / "images" / "paper_levels.png", sheetOf(scenes), 1);
}

void writePaperPictures(const std::filesystem::path& folder,
                        const std::vector<SceneLevels>& scenes) {
    std::filesystem::create_directories(folder);
    for (const SceneLevels& levels : scenes) {
        const PaperScene& scene = levels.scene;
        writePng(folder / (scene.name + "_reference.png"), levels.reference, scene.exposure);
        for (const LevelRun& run : levels.runs)
            writePng(folder / fmt::format("{}_{}.png", scene.name, run.range.name()), run.picture,
                     scene.exposure);
    }
}

}  // namespace pm::bench
