// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <optional>

#include "host_shim/check/suite.h"
#include "host_shim/colour/colour_pipeline.h"
#include "host_shim/pictures/picture.h"

namespace pm::host {

// Errors: kBadInput naming the scene, for options that pm_host does not take, and for a display
// picture that can't be had.
void checkOptions(const Suite& suite, const SuiteScene& scene);

// The display and view that a scene's options ask for, with its exposure. Errors: kBadInput naming
// the scene, for options that pm_host does not take.
class SceneDisplay {
  public:
    // view: one of the scene's; null: by its own options.
    SceneDisplay(const Suite& suite, const SuiteScene& scene, const SuiteView* view = nullptr);
    DisplayPicture shown(const Picture& picture) const;

  private:
    std::optional<DisplayTransform> m_transform;
};

// Nothing where there is no display and view that a scene's pictures can be shown by.
std::optional<SceneDisplay> findDisplay(const Suite& suite, const SuiteScene& scene);

}  // namespace pm::host
