/* SPDX-License-Identifier: Apache-2.0
 * SPDX-FileCopyrightText: The pm authors */
#include "tests/abi/box_scene.h"

#include <stddef.h>

/* A block of six quads, faces outwards: x0, y0, z0, x1, y1, z1. */
static const uint32_t kBlockIndices[24] = {0, 3, 2, 1, 4, 5, 6, 7, 0, 1, 5, 4,
                                           2, 3, 7, 6, 1, 2, 6, 5, 0, 4, 7, 3};
static const uint32_t kQuads[6] = {4, 4, 4, 4, 4, 4};

static void blockPositions(const float b[6], float positions[24]) {
    const float corners[24] = {b[0], b[1], b[2], b[3], b[1], b[2], b[3], b[4],
                               b[2], b[0], b[4], b[2], b[0], b[1], b[5], b[3],
                               b[1], b[5], b[3], b[4], b[5], b[0], b[4], b[5]};
    for (int i = 0; i < 24; ++i) positions[i] = corners[i];
}

/* Floor, ceiling, back, left (slot 1), right (slot 2); faces inwards. */
static PmrStatus makeRoom(const PmrApi* api, PmrContext context, PmrMesh* mesh) {
    static const float positions[24] = {-1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1,
                                        -1, -1, 1,  1, -1, 1,  1, 1, 1,  -1, 1, 1};
    static const uint32_t indices[20] = {4, 5, 1, 0, 3, 2, 6, 7, 0, 1,
                                         2, 3, 0, 3, 7, 4, 1, 5, 6, 2};
    static const uint32_t slots[5] = {0, 0, 0, 1, 2};
    PmrMeshDesc desc = PMR_INIT(PmrMeshDesc);
    desc.positions = positions;
    desc.positionCount = 8;
    desc.faceSizes = kQuads;
    desc.faceCount = 5;
    desc.indices = indices;
    desc.indexCount = 20;
    desc.materialSlots = slots;
    desc.slotCount = 3;
    return api->createMesh(context, &desc, mesh);
}

static PmrStatus makeBlock(const PmrApi* api, PmrContext context, const float bounds[6],
                           PmrMesh* mesh) {
    float positions[24];
    blockPositions(bounds, positions);
    PmrMeshDesc desc = PMR_INIT(PmrMeshDesc);
    desc.positions = positions;
    desc.positionCount = 8;
    desc.faceSizes = kQuads;
    desc.faceCount = 6;
    desc.indices = kBlockIndices;
    desc.indexCount = 24;
    return api->createMesh(context, &desc, mesh);
}

static PmrStatus makeSurface(const PmrApi* api, PmrContext context, float r, float g, float b,
                             float emission, float glossy, PmrMaterial* material) {
    PmrMaterialDesc desc = PMR_INIT(PmrMaterialDesc);
    desc.name = "surface";
    desc.diffuse[0] = r;
    desc.diffuse[1] = g;
    desc.diffuse[2] = b;
    for (int i = 0; i < 3; ++i) desc.emission[i] = emission;
    for (int i = 0; i < 3; ++i) desc.glossy[i] = glossy;
    desc.glossyExponent = glossy > 0 ? 32.0f : 0.0f;
    return api->createMaterial(context, &desc, material);
}

static PmrStatus makeSpecular(const PmrApi* api, PmrContext context, int32_t kind,
                              PmrMaterial* material) {
    PmrMaterialDesc desc = PMR_INIT(PmrMaterialDesc);
    desc.kind = kind;
    desc.ior = 1.5f;
    for (int i = 0; i < 3; ++i) desc.glossy[i] = 0.875f;
    for (int i = 0; i < 3; ++i) desc.transmission[i] = 1.0f;
    return api->createMaterial(context, &desc, material);
}

static PmrStatus makeBall(const PmrApi* api, PmrContext context, double x, double y, double z,
                          PmrMesh* mesh) {
    PmrSphereDesc desc = PMR_INIT(PmrSphereDesc);
    desc.centre[0] = x;
    desc.centre[1] = y;
    desc.centre[2] = z;
    desc.radius = 0.375;
    return api->createSphere(context, &desc, mesh);
}

static PmrStatus add(const PmrApi* api, PmrScene scene, PmrMesh mesh, const PmrMaterial* materials,
                     uint64_t count) {
    PmrInstanceDesc desc = PMR_INIT(PmrInstanceDesc);
    desc.mesh = mesh;
    desc.materials = materials;
    desc.materialCount = count;
    return api->addInstance(scene, &desc);
}

static PmrStatus setBoxCamera(const PmrApi* api, PmrScene scene) {
    static const double transform[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 3.5};
    PmrCameraDesc desc = PMR_INIT(PmrCameraDesc);
    desc.transforms = transform;
    desc.transformCount = 1;
    desc.fieldOfView = 0.75;
    return api->setCamera(scene, &desc);
}

/* After the first failure the rest is skipped. */
#define TRY(call)                              \
    do {                                       \
        if (status == PMR_OK) status = (call); \
    } while (0)

PmrStatus makeBoxScene(const PmrApi* api, PmrContext context, PmrScene* scene) {
    static const float kLamp[6] = {-0.25f, 0.96875f, -0.25f, 0.25f, 0.984375f, 0.25f};
    static const float kBlock[6] = {-0.25f, -1.0f, -0.75f, 0.25f, -0.25f, -0.375f};
    PmrMesh meshes[5] = {NULL};
    PmrMaterial materials[7] = {NULL}; /* white, red, green, lamp, glossy, mirror, glass */
    PmrStatus status = PMR_OK;
    *scene = NULL;
    TRY(makeRoom(api, context, &meshes[0]));
    TRY(makeBlock(api, context, kLamp, &meshes[1]));
    TRY(makeBlock(api, context, kBlock, &meshes[2]));
    TRY(makeBall(api, context, -0.5, -0.625, -0.25, &meshes[3]));
    TRY(makeBall(api, context, 0.5, -0.625, 0.25, &meshes[4]));
    TRY(makeSurface(api, context, 0.75f, 0.75f, 0.75f, 0, 0, &materials[0]));
    TRY(makeSurface(api, context, 0.625f, 0.0625f, 0.0625f, 0, 0, &materials[1]));
    TRY(makeSurface(api, context, 0.125f, 0.5f, 0.125f, 0, 0, &materials[2]));
    TRY(makeSurface(api, context, 0, 0, 0, 8, 0, &materials[3]));
    TRY(makeSurface(api, context, 0.25f, 0.25f, 0.5f, 0, 0.375f, &materials[4]));
    TRY(makeSpecular(api, context, PMR_MATERIAL_MIRROR, &materials[5]));
    TRY(makeSpecular(api, context, PMR_MATERIAL_DIELECTRIC, &materials[6]));
    TRY(api->createScene(context, NULL, scene));
    TRY(add(api, *scene, meshes[0], materials, 3));
    for (int i = 1; i < 5; ++i) TRY(add(api, *scene, meshes[i], &materials[i + 2], 1));
    TRY(setBoxCamera(api, *scene));
    TRY(api->commitScene(*scene));
    for (int i = 0; i < 5; ++i)
        if (meshes[i] != NULL) api->releaseMesh(meshes[i]);
    for (int i = 0; i < 7; ++i)
        if (materials[i] != NULL) api->releaseMaterial(materials[i]);
    if (status != PMR_OK && *scene != NULL) {
        api->releaseScene(*scene);
        *scene = NULL;
    }
    return status;
}

uint64_t hashBytes(const void* bytes, uint64_t count) {
    const unsigned char* at = bytes;
    uint64_t hash = 0xcbf29ce484222325u;
    for (uint64_t i = 0; i < count; ++i) hash = (hash ^ at[i]) * 0x100000001b3u;
    return hash;
}
