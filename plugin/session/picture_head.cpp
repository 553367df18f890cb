// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/picture_head.h"

#include "plugin/session/render_identity.h"
#include "plugin/values/processor.h"

namespace pm::plugin {

namespace {

bool isKept(const SettingSpec& spec, PieceKind kind) {
    switch (spec.id) {
        case Setting::kHostNote:
            return kind == PieceKind::kPart;
        case Setting::kCrop:
        case Setting::kLayers:
        case Setting::kHostIdentity:
            return true;
        case Setting::kPasses:
            return false;  // PieceHead::passes
        default:
            return spec.changesPixels;
    }
}

}  // namespace

PieceHead makePieceHead(PieceKind kind, const Identity& scene, const SettingValues& values) {
    PieceHead head;
    head.kind = kind;
    const Identity settings = settingsIdentity(values);
    if (kind == PieceKind::kPart) head.processorVendor = processorVendor();
    head.sceneHash = identityHash(scene);
    head.settingsHash = identityHash(settings);
    for (const Identity& part : {buildIdentity(), scene, settings, frameIdentity(values)})
        head.identity.insert(head.identity.end(), part.begin(), part.end());
    for (const IdentityPart& part : scene)
        if (part.name == "instruction set") head.isa = part.value;
    for (const SettingSpec& spec : settingSpecs())
        if (isKept(spec, kind)) head.settings.emplace_back(spec.name, values.text(spec.id));
    return head;
}

}  // namespace pm::plugin
