// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <fmt/format.h>

#include "plugin/api/api_functions.h"
#include "plugin/api/entry.h"

namespace pm::plugin {

namespace {

constexpr PmrApi kApi = {
    .size = sizeof(PmrApi),
    .abiVersion = PMR_ABI_VERSION,
    .reserved = 0,
    .versionText = api::versionText,
    .statusText = api::statusText,
    .settingCount = api::settingCount,
    .settingInfo = api::settingInfo,
    .layerCount = api::layerCount,
    .layerInfo = api::layerInfo,
    .createContext = api::createContext,
    .releaseContext = api::releaseContext,
    .lastError = api::lastError,
    .createMesh = api::createMesh,
    .createCage = api::createCage,
    .createSphere = api::createSphere,
    .retainMesh = api::retainMesh,
    .releaseMesh = api::releaseMesh,
    .createTexture = api::createTexture,
    .retainTexture = api::retainTexture,
    .releaseTexture = api::releaseTexture,
    .createMaterial = api::createMaterial,
    .retainMaterial = api::retainMaterial,
    .releaseMaterial = api::releaseMaterial,
    .createScene = api::createScene,
    .retainScene = api::retainScene,
    .releaseScene = api::releaseScene,
    .addInstance = api::addInstance,
    .addLight = api::addLight,
    .setEnvironment = api::setEnvironment,
    .setCamera = api::setCamera,
    .commitScene = api::commitScene,
    .sceneBounds = api::sceneBounds,
    .createRender = api::createRender,
    .setSettingInteger = api::setSettingInteger,
    .setSettingNumber = api::setSettingNumber,
    .setSettingText = api::setSettingText,
    .settingText = api::settingText,
    .explainRender = api::explainRender,
    .startRender = api::startRender,
    .pollRender = api::pollRender,
    .waitRender = api::waitRender,
    .cancelRender = api::cancelRender,
    .renderState = api::renderState,
    .destroyRender = api::destroyRender,
    .renderLayerCount = api::renderLayerCount,
    .renderLayerInfo = api::renderLayerInfo,
    .readPixels = api::readPixels,
    .renderStatistics = api::renderStatistics,
    .renderStopReason = api::renderStopReason,
    .createMerge = api::createMerge,
    .addPart = api::addPart,
    .mergeMissing = api::mergeMissing,
    .mergeSettingText = api::mergeSettingText,
    .mergeLayerCount = api::mergeLayerCount,
    .mergeLayerInfo = api::mergeLayerInfo,
    .readMergedPixels = api::readMergedPixels,
    .mergeStatistics = api::mergeStatistics,
    .releaseMerge = api::releaseMerge,
    .renderDelivery = api::renderDelivery,
    .cancelBuilds = api::cancelBuilds,
    .parameterCount = api::parameterCount,
    .parameterInfo = api::parameterInfo,
    .setParameter = api::setParameter,
    .createShape = api::createShape,
    .objectName = api::objectName,
    .memoryLeft = api::memoryLeft,
};

}  // namespace

}  // namespace pm::plugin

extern "C" PmrStatus PMR_CALL pmrGetApi(uint32_t abiVersion, const PmrApi** api) {
    using namespace pm::plugin;
    return onNothing([&] {
        watchForks();
        if (api == nullptr) throw argumentError("api is null");
        *api = nullptr;
        if (abiVersion != PMR_ABI_VERSION)
            throw CallError(CallStatus::kAbi,
                            fmt::format("ABI version {} is not offered; it must be {}", abiVersion,
                                        PMR_ABI_VERSION));
        *api = &kApi;
    });
}
