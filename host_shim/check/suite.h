// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace pm::host {

// Another look at a scene's picture, beside its own display picture.
struct SuiteView {
    std::string name;                  // unique in its scene
    std::vector<std::string> options;  // of colour, after the scene's
};

// One picture of a regression suite.
struct SuiteScene {
    std::string name;             // unique; of its references and in what is told
    std::filesystem::path scene;  // absolute
    // Of pm_host, those of the whole suite first; --exposure 0 where they don't say one.
    std::vector<std::string> options;
    std::vector<std::string> tags;
    std::vector<SuiteView> views;  // display pictures that are compared as well
    bool hasDisplay{};             // one by the scene's own options, too
    double codeLimit{1.0};         // of 255: what a display picture may differ by, at most
};

// A file of scenes with their options, whose references lie in a folder beside it:
//   {"schema": "pm-suite/1", "references": "references", "options": ["--passes", "16"],
//    "scenes": [{"name": "box", "scene": "box.obj", "options": ["--size", "96x64"],
//                "display": true, "codeLimit": 1, "tags": ["quick"],
//                "views": [{"name": "log", "options": ["--view", "Log"]}]}]}
// Files are relative to the suite's own folder; so is what options name.
struct Suite {
    std::filesystem::path file, folder, references;
    std::vector<SuiteScene> scenes;
};

// Errors: HostError kFile where it can't be read, kBadInput naming the entry that is wrong and what
// is allowed.
Suite readSuite(const std::filesystem::path& file);

// "box, glass, hall".
std::string namesOf(const Suite& suite);
// Those of any scene, each once.
std::vector<std::string> tagsOf(const Suite& suite);

}  // namespace pm::host
