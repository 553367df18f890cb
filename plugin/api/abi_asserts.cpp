// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The layout of every struct of the interface, for ever: a host that was compiled long ago reads
// and writes at these places. Members are only ever appended, with lines appended here.
#include <cstddef>

#include "plugin/include/pm_plugin.h"

static_assert(sizeof(void*) == 8, "the offsets below are those of 64-bit processors");

static_assert(sizeof(PmrContextDesc) == 40);
static_assert(offsetof(PmrContextDesc, size) == 0);
static_assert(offsetof(PmrContextDesc, message) == 8);
static_assert(offsetof(PmrContextDesc, user) == 16);
static_assert(offsetof(PmrContextDesc, isa) == 24);
static_assert(offsetof(PmrContextDesc, threads) == 32);
static_assert(offsetof(PmrContextDesc, reserved) == 36);

static_assert(sizeof(PmrMeshDesc) == 120);
static_assert(offsetof(PmrMeshDesc, size) == 0);
static_assert(offsetof(PmrMeshDesc, positions) == 8);
static_assert(offsetof(PmrMeshDesc, positionCount) == 16);
static_assert(offsetof(PmrMeshDesc, faceSizes) == 24);
static_assert(offsetof(PmrMeshDesc, faceCount) == 32);
static_assert(offsetof(PmrMeshDesc, indices) == 40);
static_assert(offsetof(PmrMeshDesc, indexCount) == 48);
static_assert(offsetof(PmrMeshDesc, normals) == 56);
static_assert(offsetof(PmrMeshDesc, normalCount) == 64);
static_assert(offsetof(PmrMeshDesc, normalIndices) == 72);
static_assert(offsetof(PmrMeshDesc, uvs) == 80);
static_assert(offsetof(PmrMeshDesc, uvCount) == 88);
static_assert(offsetof(PmrMeshDesc, uvIndices) == 96);
static_assert(offsetof(PmrMeshDesc, materialSlots) == 104);
static_assert(offsetof(PmrMeshDesc, slotCount) == 112);

static_assert(sizeof(PmrCageDesc) == 96);
static_assert(offsetof(PmrCageDesc, size) == 0);
static_assert(offsetof(PmrCageDesc, mesh) == 8);
static_assert(offsetof(PmrCageDesc, scheme) == 16);
static_assert(offsetof(PmrCageDesc, boundary) == 20);
static_assert(offsetof(PmrCageDesc, creases) == 24);
static_assert(offsetof(PmrCageDesc, creaseSharpness) == 32);
static_assert(offsetof(PmrCageDesc, creaseCount) == 40);
static_assert(offsetof(PmrCageDesc, corners) == 48);
static_assert(offsetof(PmrCageDesc, cornerSharpness) == 56);
static_assert(offsetof(PmrCageDesc, cornerCount) == 64);
static_assert(offsetof(PmrCageDesc, holes) == 72);
static_assert(offsetof(PmrCageDesc, holeCount) == 80);
static_assert(offsetof(PmrCageDesc, tessellationRate) == 88);
static_assert(offsetof(PmrCageDesc, faceVarying) == 92);

static_assert(sizeof(PmrSphereDesc) == 40);
static_assert(offsetof(PmrSphereDesc, size) == 0);
static_assert(offsetof(PmrSphereDesc, centre) == 8);
static_assert(offsetof(PmrSphereDesc, radius) == 32);

static_assert(sizeof(PmrTextureDesc) == 64);
static_assert(offsetof(PmrTextureDesc, size) == 0);
static_assert(offsetof(PmrTextureDesc, fileName) == 8);
static_assert(offsetof(PmrTextureDesc, wrapS) == 16);
static_assert(offsetof(PmrTextureDesc, wrapT) == 20);
static_assert(offsetof(PmrTextureDesc, uvScale) == 24);
static_assert(offsetof(PmrTextureDesc, uvOffset) == 32);
static_assert(offsetof(PmrTextureDesc, gain) == 40);
static_assert(offsetof(PmrTextureDesc, base) == 44);
static_assert(offsetof(PmrTextureDesc, texelHash) == 48);

static_assert(sizeof(PmrMaterialDesc) == 136);
static_assert(offsetof(PmrMaterialDesc, size) == 0);
static_assert(offsetof(PmrMaterialDesc, name) == 8);
static_assert(offsetof(PmrMaterialDesc, kind) == 16);
static_assert(offsetof(PmrMaterialDesc, fresnel) == 20);
static_assert(offsetof(PmrMaterialDesc, diffuse) == 24);
static_assert(offsetof(PmrMaterialDesc, glossy) == 36);
static_assert(offsetof(PmrMaterialDesc, glossyExponent) == 48);
static_assert(offsetof(PmrMaterialDesc, ior) == 52);
static_assert(offsetof(PmrMaterialDesc, transmission) == 56);
static_assert(offsetof(PmrMaterialDesc, emission) == 68);
static_assert(offsetof(PmrMaterialDesc, transparency) == 80);
static_assert(offsetof(PmrMaterialDesc, reserved) == 84);
static_assert(offsetof(PmrMaterialDesc, diffuseTexture) == 88);
static_assert(offsetof(PmrMaterialDesc, glossyTexture) == 96);
static_assert(offsetof(PmrMaterialDesc, glossyExponentTexture) == 104);
static_assert(offsetof(PmrMaterialDesc, transmissionTexture) == 112);
static_assert(offsetof(PmrMaterialDesc, emissionTexture) == 120);
static_assert(offsetof(PmrMaterialDesc, opacityTexture) == 128);

static_assert(sizeof(PmrSceneDesc) == 88);
static_assert(offsetof(PmrSceneDesc, size) == 0);
static_assert(offsetof(PmrSceneDesc, renderingSpace) == 8);
static_assert(offsetof(PmrSceneDesc, rgbToXyz) == 16);

static_assert(sizeof(PmrInstanceDesc) == 64);
static_assert(offsetof(PmrInstanceDesc, size) == 0);
static_assert(offsetof(PmrInstanceDesc, mesh) == 8);
static_assert(offsetof(PmrInstanceDesc, transforms) == 16);
static_assert(offsetof(PmrInstanceDesc, transformCount) == 24);
static_assert(offsetof(PmrInstanceDesc, materials) == 32);
static_assert(offsetof(PmrInstanceDesc, materialCount) == 40);
static_assert(offsetof(PmrInstanceDesc, name) == 48);
static_assert(offsetof(PmrInstanceDesc, id) == 56);
static_assert(offsetof(PmrInstanceDesc, hiddenFrom) == 60);

static_assert(sizeof(PmrLightDesc) == 64);
static_assert(offsetof(PmrLightDesc, size) == 0);
static_assert(offsetof(PmrLightDesc, kind) == 8);
static_assert(offsetof(PmrLightDesc, id) == 12);
static_assert(offsetof(PmrLightDesc, transforms) == 16);
static_assert(offsetof(PmrLightDesc, transformCount) == 24);
static_assert(offsetof(PmrLightDesc, emission) == 32);
static_assert(offsetof(PmrLightDesc, coneAngle) == 44);
static_assert(offsetof(PmrLightDesc, coneFalloff) == 48);
static_assert(offsetof(PmrLightDesc, angularRadius) == 52);
static_assert(offsetof(PmrLightDesc, name) == 56);

static_assert(sizeof(PmrEnvironmentDesc) == 48);
static_assert(offsetof(PmrEnvironmentDesc, size) == 0);
static_assert(offsetof(PmrEnvironmentDesc, radiance) == 8);
static_assert(offsetof(PmrEnvironmentDesc, reserved) == 20);
static_assert(offsetof(PmrEnvironmentDesc, texture) == 24);
static_assert(offsetof(PmrEnvironmentDesc, transforms) == 32);
static_assert(offsetof(PmrEnvironmentDesc, transformCount) == 40);

static_assert(sizeof(PmrCameraDesc) == 72);
static_assert(offsetof(PmrCameraDesc, size) == 0);
static_assert(offsetof(PmrCameraDesc, kind) == 8);
static_assert(offsetof(PmrCameraDesc, reserved) == 12);
static_assert(offsetof(PmrCameraDesc, transforms) == 16);
static_assert(offsetof(PmrCameraDesc, transformCount) == 24);
static_assert(offsetof(PmrCameraDesc, fieldOfView) == 32);
static_assert(offsetof(PmrCameraDesc, height) == 40);
static_assert(offsetof(PmrCameraDesc, lensRadius) == 48);
static_assert(offsetof(PmrCameraDesc, focusDistance) == 56);
static_assert(offsetof(PmrCameraDesc, pixelAspect) == 64);

static_assert(sizeof(PmrParameterInfo) == 88);
static_assert(offsetof(PmrParameterInfo, size) == 0);
static_assert(offsetof(PmrParameterInfo, name) == 8);
static_assert(offsetof(PmrParameterInfo, unit) == 16);
static_assert(offsetof(PmrParameterInfo, defaultText) == 24);
static_assert(offsetof(PmrParameterInfo, choices) == 32);
static_assert(offsetof(PmrParameterInfo, help) == 40);
static_assert(offsetof(PmrParameterInfo, minimum) == 48);
static_assert(offsetof(PmrParameterInfo, maximum) == 56);
static_assert(offsetof(PmrParameterInfo, type) == 64);
static_assert(offsetof(PmrParameterInfo, count) == 68);
static_assert(offsetof(PmrParameterInfo, excludesMinimum) == 72);
static_assert(offsetof(PmrParameterInfo, excludesMaximum) == 76);
static_assert(offsetof(PmrParameterInfo, changesPixels) == 80);
static_assert(offsetof(PmrParameterInfo, reserved) == 84);

static_assert(sizeof(PmrParameterDesc) == 72);
static_assert(offsetof(PmrParameterDesc, size) == 0);
static_assert(offsetof(PmrParameterDesc, object) == 8);
static_assert(offsetof(PmrParameterDesc, index) == 12);
static_assert(offsetof(PmrParameterDesc, material) == 16);
static_assert(offsetof(PmrParameterDesc, scene) == 24);
static_assert(offsetof(PmrParameterDesc, name) == 32);
static_assert(offsetof(PmrParameterDesc, numbers) == 40);
static_assert(offsetof(PmrParameterDesc, numberCount) == 48);
static_assert(offsetof(PmrParameterDesc, text) == 56);
static_assert(offsetof(PmrParameterDesc, texture) == 64);

static_assert(sizeof(PmrSettingInfo) == 80);
static_assert(offsetof(PmrSettingInfo, size) == 0);
static_assert(offsetof(PmrSettingInfo, name) == 8);
static_assert(offsetof(PmrSettingInfo, unit) == 16);
static_assert(offsetof(PmrSettingInfo, defaultText) == 24);
static_assert(offsetof(PmrSettingInfo, choices) == 32);
static_assert(offsetof(PmrSettingInfo, help) == 40);
static_assert(offsetof(PmrSettingInfo, cost) == 48);
static_assert(offsetof(PmrSettingInfo, minimum) == 56);
static_assert(offsetof(PmrSettingInfo, maximum) == 64);
static_assert(offsetof(PmrSettingInfo, type) == 72);
static_assert(offsetof(PmrSettingInfo, changesPixels) == 76);

static_assert(sizeof(PmrLayerInfo) == 48);
static_assert(offsetof(PmrLayerInfo, size) == 0);
static_assert(offsetof(PmrLayerInfo, name) == 8);
static_assert(offsetof(PmrLayerInfo, channels) == 16);
static_assert(offsetof(PmrLayerInfo, help) == 24);
static_assert(offsetof(PmrLayerInfo, channelCount) == 32);
static_assert(offsetof(PmrLayerInfo, kind) == 36);
static_assert(offsetof(PmrLayerInfo, isDefault) == 40);
static_assert(offsetof(PmrLayerInfo, reserved) == 44);

static_assert(sizeof(PmrRectangle) == 16);
static_assert(offsetof(PmrRectangle, x0) == 0);
static_assert(offsetof(PmrRectangle, y0) == 4);
static_assert(offsetof(PmrRectangle, x1) == 8);
static_assert(offsetof(PmrRectangle, y1) == 12);

static_assert(sizeof(PmrBucketInfo) == 64);
static_assert(offsetof(PmrBucketInfo, size) == 0);
static_assert(offsetof(PmrBucketInfo, rectangle) == 8);
static_assert(offsetof(PmrBucketInfo, bucketIndex) == 24);
static_assert(offsetof(PmrBucketInfo, bucketCount) == 28);
static_assert(offsetof(PmrBucketInfo, passIndex) == 32);
static_assert(offsetof(PmrBucketInfo, passCount) == 36);
static_assert(offsetof(PmrBucketInfo, sampleCount) == 40);
static_assert(offsetof(PmrBucketInfo, seconds) == 48);
static_assert(offsetof(PmrBucketInfo, timedPasses) == 56);
static_assert(offsetof(PmrBucketInfo, reserved) == 60);

static_assert(sizeof(PmrRenderDesc) == 64);
static_assert(offsetof(PmrRenderDesc, size) == 0);
static_assert(offsetof(PmrRenderDesc, callbackMode) == 8);
static_assert(offsetof(PmrRenderDesc, reserved) == 12);
static_assert(offsetof(PmrRenderDesc, user) == 16);
static_assert(offsetof(PmrRenderDesc, message) == 24);
static_assert(offsetof(PmrRenderDesc, progress) == 32);
static_assert(offsetof(PmrRenderDesc, bucketStarted) == 40);
static_assert(offsetof(PmrRenderDesc, bucketFinished) == 48);
static_assert(offsetof(PmrRenderDesc, finished) == 56);

static_assert(sizeof(PmrApi) == 512);
static_assert(offsetof(PmrApi, versionText) == 16);
static_assert(offsetof(PmrApi, statusText) == 24);
static_assert(offsetof(PmrApi, settingCount) == 32);
static_assert(offsetof(PmrApi, settingInfo) == 40);
static_assert(offsetof(PmrApi, layerCount) == 48);
static_assert(offsetof(PmrApi, layerInfo) == 56);
static_assert(offsetof(PmrApi, createContext) == 64);
static_assert(offsetof(PmrApi, releaseContext) == 72);
static_assert(offsetof(PmrApi, lastError) == 80);
static_assert(offsetof(PmrApi, createMesh) == 88);
static_assert(offsetof(PmrApi, createCage) == 96);
static_assert(offsetof(PmrApi, createSphere) == 104);
static_assert(offsetof(PmrApi, retainMesh) == 112);
static_assert(offsetof(PmrApi, releaseMesh) == 120);
static_assert(offsetof(PmrApi, createTexture) == 128);
static_assert(offsetof(PmrApi, retainTexture) == 136);
static_assert(offsetof(PmrApi, releaseTexture) == 144);
static_assert(offsetof(PmrApi, createMaterial) == 152);
static_assert(offsetof(PmrApi, retainMaterial) == 160);
static_assert(offsetof(PmrApi, releaseMaterial) == 168);
static_assert(offsetof(PmrApi, createScene) == 176);
static_assert(offsetof(PmrApi, retainScene) == 184);
static_assert(offsetof(PmrApi, releaseScene) == 192);
static_assert(offsetof(PmrApi, addInstance) == 200);
static_assert(offsetof(PmrApi, addLight) == 208);
static_assert(offsetof(PmrApi, setEnvironment) == 216);
static_assert(offsetof(PmrApi, setCamera) == 224);
static_assert(offsetof(PmrApi, commitScene) == 232);
static_assert(offsetof(PmrApi, sceneBounds) == 240);
static_assert(offsetof(PmrApi, createRender) == 248);
static_assert(offsetof(PmrApi, setSettingInteger) == 256);
static_assert(offsetof(PmrApi, setSettingNumber) == 264);
static_assert(offsetof(PmrApi, setSettingText) == 272);
static_assert(offsetof(PmrApi, settingText) == 280);
static_assert(offsetof(PmrApi, explainRender) == 288);
static_assert(offsetof(PmrApi, startRender) == 296);
static_assert(offsetof(PmrApi, pollRender) == 304);
static_assert(offsetof(PmrApi, waitRender) == 312);
static_assert(offsetof(PmrApi, cancelRender) == 320);
static_assert(offsetof(PmrApi, renderState) == 328);
static_assert(offsetof(PmrApi, destroyRender) == 336);
static_assert(offsetof(PmrApi, renderLayerCount) == 344);
static_assert(offsetof(PmrApi, renderLayerInfo) == 352);
static_assert(offsetof(PmrApi, readPixels) == 360);
static_assert(offsetof(PmrApi, renderStatistics) == 368);
static_assert(offsetof(PmrApi, renderStopReason) == 376);
static_assert(offsetof(PmrApi, createMerge) == 384);
static_assert(offsetof(PmrApi, addPart) == 392);
static_assert(offsetof(PmrApi, mergeMissing) == 400);
static_assert(offsetof(PmrApi, mergeSettingText) == 408);
static_assert(offsetof(PmrApi, mergeLayerCount) == 416);
static_assert(offsetof(PmrApi, mergeLayerInfo) == 424);
static_assert(offsetof(PmrApi, readMergedPixels) == 432);
static_assert(offsetof(PmrApi, mergeStatistics) == 440);
static_assert(offsetof(PmrApi, releaseMerge) == 448);
static_assert(offsetof(PmrApi, renderDelivery) == 456);
static_assert(offsetof(PmrApi, cancelBuilds) == 464);
static_assert(offsetof(PmrApi, parameterCount) == 472);
static_assert(offsetof(PmrApi, parameterInfo) == 480);
static_assert(offsetof(PmrApi, setParameter) == 488);
static_assert(offsetof(PmrApi, createShape) == 496);
static_assert(offsetof(PmrApi, objectName) == 504);
