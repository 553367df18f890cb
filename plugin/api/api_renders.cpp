// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Enumerations and renders.
#include <memory>
#include <string>

#include "plugin/api/api_functions.h"
#include "plugin/api/entry.h"
#include "plugin/api/render_callbacks.h"
#include "plugin/api/scene_object.h"
#include "plugin/api/struct_reader.h"
#include "plugin/api/table_infos.h"
#include "plugin/session/memory_limit.h"
#include "plugin/session/render.h"
#include "plugin/session/setting_table.h"
#include "plugin/values/version.h"

namespace pm::plugin::api {

namespace {

using RenderPointer = std::shared_ptr<Render>;

const char* checkedName(const char* name) {
    if (name == nullptr) throw argumentError("name is null");
    return name;
}

}  // namespace

const char* PMR_CALL versionText() noexcept {
    try {
        return plugin::versionText().c_str();
    } catch (...) {
        return PM_VERSION_TEXT;
    }
}

const char* PMR_CALL statusText(PmrStatus status) noexcept {
    switch (status) {
        case PMR_OK:
            return "ok";
        case PMR_ERROR_INTERNAL:
            return "internal error";
        case PMR_ERROR_ARGUMENT:
            return "an argument is not allowed";
        case PMR_ERROR_HANDLE:
            return "not a live handle of the kind that is wanted";
        case PMR_ERROR_STATE:
            return "not allowed in this state";
        case PMR_ERROR_SCENE:
            return "the scene can't be rendered as it is";
        case PMR_ERROR_UNSUPPORTED:
            return "not rendered by this version";
        case PMR_ERROR_MEMORY:
            return "out of memory, or over the memory limit";
        case PMR_ERROR_IO:
            return "a file can't be read or written";
        case PMR_ERROR_CANCELLED:
            return "cancelled";
        case PMR_ERROR_IN_CALLBACK:
            return "not allowed inside a callback";
        case PMR_ERROR_TIMEOUT:
            return "nothing yet";
        case PMR_ERROR_ABI:
            return "this ABI version is not offered";
        case PMR_ERROR_NAME:
            return "no setting or layer of that name";
        case PMR_ERROR_FILE:
            return "a checkpoint or part is damaged, or is none";
        case PMR_ERROR_MISMATCH:
            return "a checkpoint or part is of another picture";
        default:
            return "unknown status";
    }
}

uint32_t PMR_CALL settingCount() noexcept {
    return static_cast<uint32_t>(kSettingCount);
}

PmrStatus PMR_CALL settingInfo(uint32_t index, PmrSettingInfo* info) noexcept {
    return onNothing([&] {
        checkIndex(index, kSettingCount);
        writeStruct(info, toInfo(settingSpecs()[index]), "PmrSettingInfo");
    });
}

uint64_t PMR_CALL memoryLeft(double limitGib) noexcept {
    try {
        const SettingSpec& spec = settingSpecs()[static_cast<std::size_t>(Setting::kMemoryLimit)];
        const bool isLimit = limitGib >= 0.0 && limitGib <= static_cast<double>(spec.maximum);
        return memoryLeftBytes(isLimit ? limitGib : 0.0);
    } catch (...) {
        return 0;
    }
}

uint32_t PMR_CALL layerCount() noexcept {
    return static_cast<uint32_t>(kLayerCount);
}

PmrStatus PMR_CALL layerInfo(uint32_t index, PmrLayerInfo* info) noexcept {
    return onNothing([&] {
        checkIndex(index, kLayerCount);
        writeStruct(info, toInfo(layerSpecs()[index]), "PmrLayerInfo");
    });
}

PmrStatus PMR_CALL createRender(PmrScene scene, const PmrRenderDesc* desc,
                                PmrRender* render) noexcept {
    return onObject<SceneObject>(scene, [&](const std::shared_ptr<SceneObject>& object) {
        clearResult(render, "render");
        const PmrRenderDesc known =
            desc == nullptr ? PMR_INIT(PmrRenderDesc) : readStruct(desc, "PmrRenderDesc");
        auto committed = object->committed();
        const CallbackMode mode = readCallbackMode(known);
        const auto host = std::make_shared<RenderCallbacks>();
        host->desc = known;
        *render = publish<PmrRender>(
            std::make_shared<Render>(std::move(committed), listenerFor(host), mode));
        host->render = *render;
    });
}

PmrStatus PMR_CALL setSettingInteger(PmrRender render, const char* name, int64_t value) noexcept {
    return onObject<Render>(render, [&](const RenderPointer& object) {
        object->changeSettings(
            [&](SettingValues& values) { values.setInteger(checkedName(name), value); });
    });
}

PmrStatus PMR_CALL setSettingNumber(PmrRender render, const char* name, double value) noexcept {
    return onObject<Render>(render, [&](const RenderPointer& object) {
        object->changeSettings(
            [&](SettingValues& values) { values.setNumber(checkedName(name), value); });
    });
}

PmrStatus PMR_CALL setSettingText(PmrRender render, const char* name, const char* value) noexcept {
    return onObject<Render>(render, [&](const RenderPointer& object) {
        if (value == nullptr) throw argumentError("value is null");
        object->changeSettings(
            [&](SettingValues& values) { values.setText(checkedName(name), value); });
    });
}

PmrStatus PMR_CALL settingText(PmrRender render, const char* name, char* buffer, uint64_t capacity,
                               uint64_t* needed) noexcept {
    return onObject<Render>(render, [&](const RenderPointer& object) {
        writeText(object->settings().text(checkedName(name)), buffer, capacity, needed);
    });
}

PmrStatus PMR_CALL explainRender(PmrRender render, char* buffer, uint64_t capacity,
                                 uint64_t* needed) noexcept {
    return onObject<Render>(render, [&](const RenderPointer& object) {
        writeText(object->explain(), buffer, capacity, needed);
    });
}

PmrStatus PMR_CALL startRender(PmrRender render) noexcept {
    return onObject<Render>(render, [&](const RenderPointer& object) { object->start(); });
}

PmrStatus PMR_CALL pollRender(PmrRender render, double timeoutSeconds) noexcept {
    return onObject<Render>(
        render, [&](const RenderPointer& object) { return toPmr(object->poll(timeoutSeconds)); });
}

PmrStatus PMR_CALL waitRender(PmrRender render, double timeoutSeconds) noexcept {
    return onObject<Render>(
        render, [&](const RenderPointer& object) { return toPmr(object->wait(timeoutSeconds)); });
}

PmrStatus PMR_CALL cancelRender(PmrRender render) noexcept {
    return onObject<Render>(render, [&](const RenderPointer& object) { object->cancel(); });
}

PmrStatus PMR_CALL renderState(PmrRender render, int32_t* state, PmrStatus* status) noexcept {
    return onObject<Render>(render, [&](const RenderPointer& object) {
        RenderState foundState = RenderState::kCreated;
        CallStatus foundStatus = CallStatus::kOk;
        object->stateAndStatus(foundState, foundStatus);
        if (state != nullptr) *state = static_cast<std::int32_t>(foundState);
        if (status != nullptr) *status = toPmr(foundStatus);
    });
}

PmrStatus PMR_CALL destroyRender(PmrRender render) noexcept {
    if (isHandleCutOff<Render>(render)) return releaseHandle<Render>(render);
    return onObject<Render>(render, [&](const RenderPointer& object) {
        // The handle lives on until `finished` has returned, so that the host may use it there.
        if (!object->shutDown()) return PMR_ERROR_HANDLE;
        return releaseHandle<Render>(render);
    });
}

PmrStatus PMR_CALL renderLayerCount(PmrRender render, uint32_t* count) noexcept {
    return onObject<Render>(
        render, [&](const RenderPointer& object) { writeLayerCount(object->layers(), count); });
}

PmrStatus PMR_CALL renderLayerInfo(PmrRender render, uint32_t index, PmrLayerInfo* info) noexcept {
    return onObject<Render>(render, [&](const RenderPointer& object) {
        writeLayerInfo(object->layers(), index, info);
    });
}

PmrStatus PMR_CALL readPixels(PmrRender render, const PmrRectangle* rectangle, const char* layer,
                              float* destination, int64_t pixelStrideBytes,
                              int64_t rowStrideBytes) noexcept {
    return onObject<Render>(render, [&](const RenderPointer& object) {
        if (rectangle == nullptr) throw argumentError("rectangle is null");
        object->readPixels(toRect(*rectangle), layer, destination, pixelStrideBytes,
                           rowStrideBytes);
    });
}

PmrStatus PMR_CALL renderStatistics(PmrRender render, char* buffer, uint64_t capacity,
                                    uint64_t* needed) noexcept {
    return onObject<Render>(render, [&](const RenderPointer& object) {
        writeText(object->statisticsJson(), buffer, capacity, needed);
    });
}

PmrStatus PMR_CALL renderStopReason(PmrRender render, int32_t* reason) noexcept {
    return onObject<Render>(render, [&](const RenderPointer& object) {
        if (reason == nullptr) throw argumentError("reason is null");
        *reason = static_cast<std::int32_t>(object->stopReason());
    });
}

PmrStatus PMR_CALL renderDelivery(PmrRender render, int32_t* delivery) noexcept {
    return onObject<Render>(render, [&](const RenderPointer& object) {
        if (delivery == nullptr) throw argumentError("delivery is null");
        *delivery = static_cast<std::int32_t>(object->delivery());
    });
}

}  // namespace pm::plugin::api
