// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host_shim/check/scene_check.h"

namespace pm::host {

// Writes index.html into the folder, and NAME.html for each scene: findings, stored and new picture
// with a slider, their difference; NAME_render.html is the render's own report. The folder is made
// where there is none. Errors: kFile.
class CheckPages {
  public:
    CheckPages(std::filesystem::path folder, const Suite& suite);

    // A scene's page; what the index shows of it is kept, not its pictures.
    void add(const SceneOutcome& outcome);
    void writeIndex() const;

  private:
    struct Entry {
        const SuiteScene* scene{};
        std::string row;
        bool isRight{};
    };
    std::filesystem::path m_folder;
    const Suite& m_suite;
    std::vector<Entry> m_entries;
};

}  // namespace pm::host
