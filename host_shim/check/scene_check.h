// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <optional>
#include <string>

#include "host_shim/check/suite.h"
#include "host_shim/check/verdict.h"
#include "host_shim/colour/colour_pipeline.h"

namespace pm::host {

// What one scene of a suite came to.
struct SceneOutcome {
    enum class Status { kSame, kWithinNoise, kDifferent, kMissing, kFailed, kOutOfTime };
    const SuiteScene* scene{};
    Status status{Status::kOutOfTime};
    std::vector<Finding> findings;
    double seconds{};
    double shareOfLimit{}, seenChange{};
    std::string command;  // that repeats the render
    std::string because;  // of the reference
    std::optional<Picture> stored, picture;

    bool isRight() const { return status == Status::kSame || status == Status::kWithinNoise; }
};

const char* nameOf(SceneOutcome::Status status);

// A scene's files beside the suite.
struct ReferenceFiles {
    std::filesystem::path picture, display, numbers;  // NAME.exr, NAME.png, NAME.json
};
ReferenceFiles referenceFiles(const Suite& suite, const SuiteScene& scene);

// Errors: kBadInput naming the scene, for options that pm_host does not take, and for a display
// picture that can't be had.
void checkOptions(const Suite& suite, const SuiteScene& scene);

// The display and view that a scene's options ask for, with its exposure. Errors: kBadInput naming
// the scene, for options that pm_host does not take.
class SceneDisplay {
  public:
    SceneDisplay(const Suite& suite, const SuiteScene& scene);
    DisplayPicture shown(const Picture& picture) const;

  private:
    std::optional<DisplayTransform> m_transform;
};

// Nothing where there is no display and view that a scene's pictures can be shown by.
std::optional<SceneDisplay> findDisplay(const Suite& suite, const SuiteScene& scene);

// In a folder of pages: a scene's own, and the report of its render.
std::filesystem::path scenePage(const std::filesystem::path& folder, const SuiteScene& scene);
std::filesystem::path reportPage(const std::filesystem::path& folder, const SuiteScene& scene);

// A render against its references. exr, png: the new files; png only where the scene has a display
// picture.
void checkScene(const Suite& suite, const std::filesystem::path& exr,
                const std::filesystem::path& png, SceneOutcome& outcome);

}  // namespace pm::host
