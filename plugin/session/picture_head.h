// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "plugin/session/setting_values.h"
#include "plugin/storage/piece_head.h"
#include "plugin/values/identity.h"

namespace pm::plugin {

// The head of a piece of a render with these settings. scene: sceneIdentity().
PieceHead makePieceHead(PieceKind kind, const Identity& scene, const SettingValues& values);

}  // namespace pm::plugin
