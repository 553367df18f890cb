// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The functions behind PmrApi, by the names they have there. pm_plugin.h says what they do.
#pragma once

#include <cstdint>

#include "plugin/include/pm_plugin.h"

namespace pm::plugin::api {

const char* PMR_CALL versionText() noexcept;
const char* PMR_CALL statusText(PmrStatus status) noexcept;
uint32_t PMR_CALL settingCount() noexcept;
PmrStatus PMR_CALL settingInfo(uint32_t index, PmrSettingInfo* info) noexcept;
uint32_t PMR_CALL layerCount() noexcept;
PmrStatus PMR_CALL layerInfo(uint32_t index, PmrLayerInfo* info) noexcept;
PmrStatus PMR_CALL createContext(const PmrContextDesc* desc, PmrContext* context) noexcept;
PmrStatus PMR_CALL releaseContext(PmrContext context) noexcept;
PmrStatus PMR_CALL lastError(PmrContext context, char* buffer, uint64_t capacity,
                             uint64_t* needed) noexcept;
PmrStatus PMR_CALL createMesh(PmrContext context, const PmrMeshDesc* desc, PmrMesh* mesh) noexcept;
PmrStatus PMR_CALL createCage(PmrContext context, const PmrCageDesc* desc, PmrMesh* mesh) noexcept;
PmrStatus PMR_CALL createSphere(PmrContext context, const PmrSphereDesc* desc,
                                PmrMesh* mesh) noexcept;
PmrStatus PMR_CALL retainMesh(PmrMesh mesh) noexcept;
PmrStatus PMR_CALL releaseMesh(PmrMesh mesh) noexcept;
PmrStatus PMR_CALL createTexture(PmrContext context, const PmrTextureDesc* desc,
                                 PmrTexture* texture) noexcept;
PmrStatus PMR_CALL retainTexture(PmrTexture texture) noexcept;
PmrStatus PMR_CALL releaseTexture(PmrTexture texture) noexcept;
PmrStatus PMR_CALL createMaterial(PmrContext context, const PmrMaterialDesc* desc,
                                  PmrMaterial* material) noexcept;
PmrStatus PMR_CALL retainMaterial(PmrMaterial material) noexcept;
PmrStatus PMR_CALL releaseMaterial(PmrMaterial material) noexcept;
PmrStatus PMR_CALL createScene(PmrContext context, const PmrSceneDesc* desc,
                               PmrScene* scene) noexcept;
PmrStatus PMR_CALL retainScene(PmrScene scene) noexcept;
PmrStatus PMR_CALL releaseScene(PmrScene scene) noexcept;
PmrStatus PMR_CALL addInstance(PmrScene scene, const PmrInstanceDesc* desc) noexcept;
PmrStatus PMR_CALL addLight(PmrScene scene, const PmrLightDesc* desc) noexcept;
PmrStatus PMR_CALL setEnvironment(PmrScene scene, const PmrEnvironmentDesc* desc) noexcept;
PmrStatus PMR_CALL setCamera(PmrScene scene, const PmrCameraDesc* desc) noexcept;
PmrStatus PMR_CALL commitScene(PmrScene scene) noexcept;
PmrStatus PMR_CALL sceneBounds(PmrScene scene, double bounds[6]) noexcept;
PmrStatus PMR_CALL createRender(PmrScene scene, const PmrRenderDesc* desc,
                                PmrRender* render) noexcept;
PmrStatus PMR_CALL setSettingInteger(PmrRender render, const char* name, int64_t value) noexcept;
PmrStatus PMR_CALL setSettingNumber(PmrRender render, const char* name, double value) noexcept;
PmrStatus PMR_CALL setSettingText(PmrRender render, const char* name, const char* value) noexcept;
PmrStatus PMR_CALL settingText(PmrRender render, const char* name, char* buffer, uint64_t capacity,
                               uint64_t* needed) noexcept;
PmrStatus PMR_CALL explainRender(PmrRender render, char* buffer, uint64_t capacity,
                                 uint64_t* needed) noexcept;
PmrStatus PMR_CALL startRender(PmrRender render) noexcept;
PmrStatus PMR_CALL pollRender(PmrRender render, double timeoutSeconds) noexcept;
PmrStatus PMR_CALL waitRender(PmrRender render, double timeoutSeconds) noexcept;
PmrStatus PMR_CALL cancelRender(PmrRender render) noexcept;
PmrStatus PMR_CALL renderState(PmrRender render, int32_t* state, PmrStatus* status) noexcept;
PmrStatus PMR_CALL destroyRender(PmrRender render) noexcept;
PmrStatus PMR_CALL renderLayerCount(PmrRender render, uint32_t* count) noexcept;
PmrStatus PMR_CALL renderLayerInfo(PmrRender render, uint32_t index, PmrLayerInfo* info) noexcept;
PmrStatus PMR_CALL readPixels(PmrRender render, const PmrRectangle* rectangle, const char* layer,
                              float* destination, int64_t pixelStrideBytes,
                              int64_t rowStrideBytes) noexcept;
PmrStatus PMR_CALL renderStatistics(PmrRender render, char* buffer, uint64_t capacity,
                                    uint64_t* needed) noexcept;
PmrStatus PMR_CALL renderStopReason(PmrRender render, int32_t* reason) noexcept;
PmrStatus PMR_CALL renderDelivery(PmrRender render, int32_t* delivery) noexcept;
PmrStatus PMR_CALL createMerge(PmrContext context, PmrMerge* merge) noexcept;
PmrStatus PMR_CALL addPart(PmrMerge merge, const char* file) noexcept;
PmrStatus PMR_CALL mergeMissing(PmrMerge merge, char* buffer, uint64_t capacity,
                                uint64_t* needed) noexcept;
PmrStatus PMR_CALL mergeSettingText(PmrMerge merge, const char* name, char* buffer,
                                    uint64_t capacity, uint64_t* needed) noexcept;
PmrStatus PMR_CALL mergeLayerCount(PmrMerge merge, uint32_t* count) noexcept;
PmrStatus PMR_CALL mergeLayerInfo(PmrMerge merge, uint32_t index, PmrLayerInfo* info) noexcept;
PmrStatus PMR_CALL readMergedPixels(PmrMerge merge, const PmrRectangle* rectangle,
                                    const char* layer, float* destination, int64_t pixelStrideBytes,
                                    int64_t rowStrideBytes) noexcept;
PmrStatus PMR_CALL mergeStatistics(PmrMerge merge, char* buffer, uint64_t capacity,
                                   uint64_t* needed) noexcept;
PmrStatus PMR_CALL releaseMerge(PmrMerge merge) noexcept;
PmrStatus PMR_CALL cancelBuilds(PmrContext context, int32_t on) noexcept;
uint32_t PMR_CALL parameterCount(int32_t object) noexcept;
PmrStatus PMR_CALL parameterInfo(int32_t object, uint32_t index, PmrParameterInfo* info) noexcept;
PmrStatus PMR_CALL setParameter(const PmrParameterDesc* desc) noexcept;
PmrStatus PMR_CALL createShape(PmrContext context, int32_t object,
                               const PmrParameterDesc* const* parameters, uint32_t count,
                               PmrMesh* mesh) noexcept;
const char* PMR_CALL objectName(int32_t object) noexcept;
uint64_t PMR_CALL memoryLeft(double limitGib) noexcept;

}  // namespace pm::plugin::api
