// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <memory>

#include "plugin/include/pm_plugin.h"
#include "plugin/session/render.h"

namespace pm::plugin {

// The functions that a host gave for a render, and the handle that they are called with.
struct RenderCallbacks {
    PmrRenderDesc desc{};
    PmrRender render = nullptr;  // before the render starts
};

// CallError(ARGUMENT) for a mode that is not there.
CallbackMode readCallbackMode(const PmrRenderDesc& desc);

// Calls the host's functions; empty where it gave none.
RenderListener listenerFor(const std::shared_ptr<const RenderCallbacks>& host);

}  // namespace pm::plugin
