// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <OpenColorIO/OpenColorIO.h>

#include <functional>
#include <string>
#include <vector>

#include "host_shim/colour/colour_pipeline.h"

namespace pm::host {

namespace OCIO = OCIO_NAMESPACE;

// A config with the context variables of a render applied.
struct ColourConfig {
    OCIO::ConstConfigRcPtr config;
    OCIO::ConstContextRcPtr context;
    std::string name;  // path, or "built-in"
    bool isBuiltIn{};
    std::vector<std::string> warnings;
};

// --ocio, else $OCIO when set and not empty, else the built-in config. Errors: see ColourPipeline.
ColourConfig chooseConfig(const ColourOptions& options);
ColourConfig builtInColourConfig();

// The space of that name, alias or role, or null.
OCIO::ConstColorSpaceRcPtr findSpace(const ColourConfig& config, const std::string& name);
// Data takes no part in colour management.
bool isData(const OCIO::ConstColorSpaceRcPtr& space);
// Scene-referred and linear: measured with probes on its transform to the reference space, since
// the config's own word on it may be missing. False where the transform can't be built.
bool canRender(const ColourConfig& config, const OCIO::ConstColorSpaceRcPtr& space);
// The active spaces that keep(space) is true for, as "'a', 'b'".
std::string spaceNames(const ColourConfig& config,
                       const std::function<bool(const OCIO::ConstColorSpaceRcPtr&)>& keep);
// "'a', 'b'"; "none" when empty.
std::string quotedList(const std::vector<std::string>& names);

// Runs use and turns OpenColorIO's exceptions into HostError kBadInput: "what: text of the
// library".
template <typename Use>
auto guarded(const std::string& what, const Use& use) -> decltype(use()) {
    try {
        return use();
    } catch (const OCIO::Exception& error) {
        std::string text = error.what();
        for (char& c : text) {
            if (c == '\n') c = ' ';
        }
        throw HostError(ExitCode::kBadInput, what + ": " + text);
    }
}

// The processor's values as they are, in float, without OpenColorIO's fast approximations.
SpaceConversion makeSpaceConversion(const OCIO::ConstProcessorRcPtr& processor);

}  // namespace pm::host
