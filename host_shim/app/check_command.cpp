// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/app/check_command.h"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "host_shim/check/check_page.h"
#include "host_shim/check/check_run.h"
#include "host_shim/check/junit.h"
#include "host_shim/formats/warnings.h"
#include "host_shim/pictures/finished_file.h"
#include "host_shim/process/outputs.h"
#include "host_shim/process/plain_text.h"

namespace pm::host {
namespace {

void print(const std::string& text) {
    const std::string plain = plainLines(text);
    std::fwrite(plain.data(), 1, plain.size(), stdout);
    std::fflush(stdout);
}

std::string lineOf(const SceneOutcome& outcome, bool isUpdate) {
    const std::string& name = outcome.scene->name;
    std::string text;
    if (isUpdate && outcome.isRight())
        text = fmt::format("{}: stored", name);
    else
        text = fmt::format("{}: {}", name, nameOf(outcome.status));
    if (outcome.status == SceneOutcome::Status::kWithinNoise)
        text += fmt::format(" ({})", noiseText(outcome));
    text += fmt::format(", {:.2f} s\n", outcome.seconds);
    for (const Finding& finding : outcome.findings)
        text += fmt::format("    {}: {}\n", finding.measure, finding.text);
    for (const std::string& line : remarksOf(outcome)) text += fmt::format("    {}\n", line);
    if (!outcome.isRight()) text += fmt::format("    {}\n", outcome.command);
    return text;
}

std::string summaryOf(const std::vector<SceneOutcome>& outcomes, bool isUpdate) {
    std::size_t right = 0;
    for (const SceneOutcome& outcome : outcomes) right += outcome.isRight() ? 1 : 0;
    return fmt::format("{} of {} scenes {}\n", right, outcomes.size(),
                       isUpdate ? "stored" : "right");
}

// The renders work in the suite's folder; what the environment names is relative to this one.
void keepNamesOfEnvironment() {
    for (const char* name : {"PM_PLUGIN_PATH", "OCIO"}) {
        const char* const value = std::getenv(name);
        if (value == nullptr || *value == '\0' || std::string_view(value).starts_with("ocio://"))
            continue;
        setenv(name, std::filesystem::absolute(value).c_str(), 1);
    }
}

std::vector<std::filesystem::path> filesOf(const Suite& suite) {
    std::vector<std::filesystem::path> files{suite.file};
    for (const SuiteScene& scene : suite.scenes) {
        const ReferenceFiles references = referenceFiles(suite, scene);
        files.insert(files.end(), {scene.scene, references.numbers});
        const auto pictures = references.pictures();
        files.insert(files.end(), pictures.begin(), pictures.end());
    }
    return files;
}

}  // namespace

int runCheckCommand(const CheckOptions& options) {
    keepNamesOfEnvironment();
    const Suite suite = readSuite(options.suite);
    if (!options.junit.empty()) {
        checkOutputs({}, {options.junit}, false);
        checkNotInputs({options.junit}, filesOf(suite));
    }
    std::optional<CheckPages> pages;
    if (!options.html.empty()) pages.emplace(options.html, suite);
    CheckRun run(options, suite, [&](const SceneOutcome& outcome) {
        print(lineOf(outcome, options.update));
        if (pages) pages->add(outcome);
    });
    const std::vector<SceneOutcome> outcomes = options.update ? run.update() : run.check();
    if (pages) pages->writeIndex();
    if (!options.junit.empty()) writeFinishedFile(options.junit, junitXml(suite, outcomes));
    print(summaryOf(outcomes, options.update));
    return exitCodeOf(outcomes);
}

}  // namespace pm::host
