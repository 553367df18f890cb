// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/check/junit.h"

#include <fmt/format.h>

#include <OpenImageIO/detail/pugixml/pugixml.hpp>

#include "host_shim/report/report_html.h"

namespace pm::host {
namespace {

bool isError(const SceneOutcome& outcome) {
    return outcome.status == SceneOutcome::Status::kFailed ||
           outcome.status == SceneOutcome::Status::kOutOfTime;
}

std::string testCase(const std::string& suite, const SceneOutcome& outcome) {
    std::string text = fmt::format("  <testcase classname=\"{}\" name=\"{}\" time=\"{:.3f}\">\n",
                                   escaped(suite), escaped(outcome.scene->name), outcome.seconds);
    if (!outcome.isRight()) {
        std::string lines;
        for (const Finding& finding : outcome.findings)
            lines += fmt::format("{}: {}\n", finding.measure, finding.text);
        const char* element = isError(outcome) ? "error" : "failure";
        text += fmt::format("    <{0} type=\"{1}\" message=\"{2}\">{3}{4}</{0}>\n", element,
                            nameOf(outcome.status),
                            escaped(outcome.findings.empty() ? "" : outcome.findings[0].text),
                            escaped(lines), escaped(outcome.command));
    }
    std::vector<std::string> lines = remarksOf(outcome);
    if (outcome.status == SceneOutcome::Status::kWithinNoise)
        lines.insert(lines.begin(), "within noise: " + noiseText(outcome));
    if (!lines.empty())
        text += fmt::format("    <system-out>{}</system-out>\n",
                            escaped(fmt::format("{}", fmt::join(lines, "\n"))));
    return text + "  </testcase>\n";
}

}  // namespace

std::string junitXml(const Suite& suite, const std::vector<SceneOutcome>& outcomes) {
    const std::string name = suite.file.stem().string();
    std::size_t failures = 0, errors = 0;
    double seconds = 0;
    std::string cases;
    for (const SceneOutcome& outcome : outcomes) {
        if (!outcome.isRight()) ++(isError(outcome) ? errors : failures);
        seconds += outcome.seconds;
        cases += testCase(name, outcome);
    }
    return fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<testsuites>\n<testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"{}\" "
        "time=\"{:.3f}\">\n{}</testsuite>\n</testsuites>\n",
        escaped(name), outcomes.size(), failures, errors, seconds, cases);
}

std::vector<std::string> failedScenes(const std::filesystem::path& junit) {
    OIIO::pugi::xml_document document;
    const auto parsed = document.load_file(junit.c_str());
    if (parsed.status == OIIO::pugi::status_file_not_found ||
        parsed.status == OIIO::pugi::status_io_error)
        throw HostError(ExitCode::kFile,
                        fmt::format("--failed: {}: can't be read", junit.string()));
    const OIIO::pugi::xml_node suites = document.child("testsuites");
    if (!parsed || !suites)
        throw HostError(
            ExitCode::kBadInput,
            fmt::format("--failed: {} is no JUnit file of pm_host check{}", junit.string(),
                        parsed ? "" : fmt::format(": {}", parsed.description())));
    std::vector<std::string> names;
    for (const auto& suite : suites.children("testsuite"))
        for (const auto& test : suite.children("testcase"))
            if (test.child("failure") || test.child("error"))
                names.emplace_back(test.attribute("name").value());
    return names;
}

}  // namespace pm::host
