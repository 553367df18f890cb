// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/check/check_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "host_shim/folders/own_folder.h"
#include "host_shim/pictures/compare.h"
#include "host_shim/pictures/finished_file.h"
#include "host_shim/report/report_command.h"
#include "host_shim/report/report_html.h"
#include "host_shim/report/report_pictures.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPictureBytes = 20'000'000;
constexpr std::size_t kThumbnailBytes = 30'000;
constexpr int kThumbnailWidth = 160;
constexpr double kShareOfScale = 0.99;  // above all is shown alike

Plane differenceOf(const Picture& stored, const Picture& picture) {
    const Beauty a = beautyOf(stored), b = beautyOf(picture);
    const auto planes = [](const Beauty& beauty) {
        return std::array{beauty.values[0].data(), beauty.values[1].data(),
                          beauty.values[2].data()};
    };
    return relativeDifference(a.window.width(), a.window.height(), planes(a), planes(b),
                              errorOffset(errorScaleOf(stored).value_or(0)));
}

bool haveOneShape(const SceneOutcome& outcome) {
    return outcome.stored && outcome.picture &&
           outcome.stored->dataWindow == outcome.picture->dataWindow;
}

// Old, new and what they differ by. view: one of the scene's; empty: by its own options.
std::string picturesHtml(const SceneOutcome& outcome, const SceneDisplay& display,
                         const std::string& view) {
    const EmbeddedPicture shown = embedded(display.shown(*outcome.picture), kPictureBytes);
    if (!haveOneShape(outcome))
        return section("picture", "Picture", figureHtml(shown, "the new picture", "New."));
    const EmbeddedPicture stored = embedded(display.shown(*outcome.stored), kPictureBytes);
    const Plane plane = differenceOf(*outcome.stored, *outcome.picture);
    const float most = quantile(plane, kShareOfScale);
    return section(
        "picture" + std::string(view.empty() ? "" : "-" + view),
        "Old, new, difference" + (view.empty() ? "" : ", view " + view),
        besideHtml({{stored, "the stored picture", "Old: the reference."},
                    {shown, "the new picture", "New."},
                    {embedded(heatMap(plane, 0, most), kPictureBytes),
                     "difference from the stored picture", "Difference of scene-linear values."}}) +
            scaleHtml("0", fmt::format("{:.3g} of the value", most)));
}

std::string findingsHtml(const SceneOutcome& outcome) {
    std::vector<Row> rows;
    for (const Finding& finding : outcome.findings)
        rows.push_back({escaped(finding.measure), escaped(finding.text)});
    return rows.empty() ? paragraph("Nothing differs beyond noise.")
                        : table({"measure", "finding"}, rows);
}

std::string remarksHtml(const SceneOutcome& outcome) {
    std::string lines;
    for (const std::string& line : remarksOf(outcome)) lines += paragraph(line);
    return lines.empty() ? lines : section("remarks", "Warnings and notes", lines);
}

std::string acceptCommand(const Suite& suite, const SuiteScene& scene) {
    return shellCommand({"pm_host", "check", suite.file.string(), "--update", "--only", scene.name,
                         "--because", "TEXT"});
}

std::string statusHtml(const SceneOutcome& outcome) {
    std::string words = fmt::format("{}. {:.2f} s.", nameOf(outcome.status), outcome.seconds);
    if (outcome.status == SceneOutcome::Status::kWithinNoise)
        words += fmt::format(" The furthest region is at {:.0f} % of its limit.",
                             100 * outcome.shareOfLimit);
    if (!outcome.errorWords.empty())
        words += fmt::format(" Its own error: {}.", outcome.errorWords);
    if (outcome.seenChange > 0) words += fmt::format(" Found are {}.", seenText(outcome));
    return fmt::format("<p class=\"status{}\">{}</p>\n", outcome.isRight() ? "" : " bad",
                       escaped(words));
}

std::string thumbnailHtml(EmbeddedPicture picture) {
    if (picture.dataUri.empty()) return "";
    picture.shownHeight =
        std::max(1, picture.shownHeight * kThumbnailWidth / std::max(picture.shownWidth, 1));
    picture.shownWidth = kThumbnailWidth;
    return imageHtml(picture, "the new picture");
}

std::string seenCell(const SceneOutcome& outcome) {
    return escaped(seenText(outcome)) + (outcome.isCoarse() ? " <strong>coarse</strong>" : "");
}

std::string warningsCell(const SceneOutcome& outcome) {
    std::string lines;
    for (const std::string& text : outcome.warnings) lines += paragraph(text);
    return lines;
}

bool isPages(const fs::path& folder) {
    return isOwnPage(folder / "index.html");
}

constexpr FolderKind kPagesKind{"check-pages", "a folder of pages", "--html", nullptr, isPages};

// What is there is to be of an earlier check. Errors: kFile.
void checkPage(const fs::path& page) {
    std::error_code ignored;
    if (fs::exists(fs::symlink_status(page, ignored)) && !isOwnPage(page))
        throw HostError(ExitCode::kFile,
                        fmt::format("--html: {} is there and no page of pm's; it would be "
                                    "overwritten",
                                    page.string()));
}

std::string link(const std::string& file, const std::string& words) {
    return fmt::format("<a href=\"{}\">{}</a>", escaped(file), escaped(words));
}

}  // namespace

CheckPages::CheckPages(fs::path folder, const Suite& suite)
    : m_folder(std::move(folder)), m_suite(suite) {
    OwnFolder::check(m_folder, kPagesKind);
    std::vector<fs::path> pages{m_folder / "index.html"};
    for (const SuiteScene& scene : m_suite.scenes)
        for (const fs::path& page : {scenePage(m_folder, scene), reportPage(m_folder, scene)})
            pages.push_back(page);
    for (const fs::path& page : pages) checkPage(page);
    std::error_code failed;
    for (const fs::path& page : pages) {
        fs::create_directories(page.parent_path(), failed);
        if (failed || !fs::is_directory(page.parent_path()))
            throw HostError(ExitCode::kFile,
                            fmt::format("--html {}: no folder can be made", m_folder.string()));
        if (page != pages.front()) fs::remove(page, failed);
    }
    const OwnFolder own(m_folder, kPagesKind);
}

void CheckPages::add(const SceneOutcome& outcome) {
    const SuiteScene& scene = *outcome.scene;
    const bool hasReport = fs::exists(reportPage(m_folder, scene));
    const std::string page = "scene/" + scene.name + ".html",
                      report = "render/" + scene.name + ".html";
    EmbeddedPicture small;
    std::string body = "<p>" + link("../index.html", "All scenes") + "</p>\n" +
                       fmt::format("<h1>{}</h1>\n", escaped(scene.name)) + statusHtml(outcome) +
                       section("findings", "Findings", findingsHtml(outcome)) +
                       remarksHtml(outcome);
    if (const auto display = outcome.picture ? findDisplay(m_suite, scene) : std::nullopt) {
        small = embedded(display->shown(*outcome.picture), kThumbnailBytes);
        body += picturesHtml(outcome, *display, "");
    }
    for (const SuiteView& view : scene.views)
        if (outcome.picture)
            body += picturesHtml(outcome, SceneDisplay(m_suite, scene, &view), view.name);
    if (!outcome.isRight() && outcome.picture)
        body += section("accept", "To accept the new picture",
                        codeBlock(acceptCommand(m_suite, scene)));
    if (!outcome.because.empty())
        body += section("reason", "Why the reference is as it is", paragraph(outcome.because));
    body +=
        section("command", "The render",
                codeBlock(outcome.command) +
                    (hasReport ? "<p>" + link("../" + report, "Its own report") + "</p>\n" : ""));
    writeFinishedFile(m_folder / page, wholePage(scene.name, body));
    std::string first = outcome.findings.empty()
                            ? ""
                            : outcome.findings[0].measure + ": " + outcome.findings[0].text;
    m_entries.push_back(
        {&scene,
         fmt::format("<tr{}><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.2f} s</td>"
                     "<td>{}</td><td>{}</td><td>{}</td></tr>\n",
                     outcome.isRight() ? "" : " class=\"bad\"", thumbnailHtml(small),
                     link(page, scene.name), nameOf(outcome.status), seenCell(outcome),
                     outcome.seconds, escaped(first), warningsCell(outcome),
                     hasReport ? link(report, "report") : ""),
         outcome.isRight()});
}

void CheckPages::writeIndex() const {
    const auto right = std::ranges::count_if(m_entries, &Entry::isRight);
    const bool isGood = right == std::ssize(m_entries);
    const std::string name = m_suite.file.filename().string();
    std::string body = fmt::format(
        "<h1>{}</h1>\n<p class=\"status{}\">{} of {} scenes are right.</p>"
        "\n<table>\n<tr><th></th><th>scene</th><th>outcome</th><th>found are</th><th>time</th>"
        "<th>first finding</th><th>warnings</th><th></th></tr>\n",
        escaped(name), isGood ? "" : " bad", right, m_entries.size());
    // In the suite's order, whoever was done first.
    for (const SuiteScene& scene : m_suite.scenes)
        for (const Entry& entry : m_entries)
            if (entry.scene == &scene) body += entry.row;
    writeFinishedFile(m_folder / "index.html", wholePage(name, body + "</table>\n"));
}

}  // namespace pm::host
