// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>

#include "host_shim/colour/colour_pipeline.h"
#include "host_shim/render/plugin.h"

namespace pm::host {

// What --list prints, one entry a line.
std::string listViews(const ColourPipeline& colour);
std::string listSpaces(const ColourPipeline& colour);
std::string listLooks(const ColourPipeline& colour);
std::string listLayers(const PmrApi& api);
std::string listSettings(const PmrApi& api);
std::string listOrders(const PmrApi& api);
// As "light.coneAngle: help [range; default]".
std::string listParameters(const PmrApi& api);

// One line of help for a setting: meaning, unit, choices, default and cost; empty when unknown.
std::string settingHelp(const PmrApi& api, const std::string& name);

}  // namespace pm::host
