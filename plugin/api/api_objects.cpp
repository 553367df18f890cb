// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Contexts, reusable objects and scenes.
#include <fmt/format.h>

#include <vector>

#include "plugin/api/api_functions.h"
#include "plugin/api/context.h"
#include "plugin/api/entry.h"
#include "plugin/api/last_error.h"
#include "plugin/api/objects.h"
#include "plugin/api/scene_object.h"
#include "plugin/api/struct_reader.h"
#include "plugin/session/callback_scope.h"
#include "plugin/values/failure.h"

namespace pm::plugin::api {

namespace {

// Reads the description and makes an object from it and the context.
template <typename Desc, typename Handle, typename Make>
PmrStatus create(PmrContext context, const Desc* desc, Handle* result, const char* type,
                 const char* name, Make&& make) noexcept {
    return onObject<Context>(context, [&](const std::shared_ptr<Context>& owner) {
        clearResult(result, name);
        *result = publish<Handle>(make(owner, readStruct(desc, type)));
    });
}

}  // namespace

PmrStatus PMR_CALL createContext(const PmrContextDesc* desc, PmrContext* context) noexcept {
    return onNothing([&] {
        clearResult(context, "context");
        const PmrContextDesc known =
            desc == nullptr ? PMR_INIT(PmrContextDesc) : readStruct(desc, "PmrContextDesc");
        *context = publish<PmrContext>(std::make_shared<Context>(known));
    });
}

PmrStatus PMR_CALL releaseContext(PmrContext context) noexcept {
    if (isHandleCutOff<Context>(context)) return releaseHandle<Context>(context);
    return onObject<Context>(context, [&](const std::shared_ptr<Context>&) {
        if (CallbackScope::active())
            throw CallError(CallStatus::kInCallback,
                            "releaseContext is not allowed inside a callback");
        return releaseHandle<Context>(context);
    });
}

PmrStatus PMR_CALL lastError(PmrContext context, char* buffer, uint64_t capacity,
                             uint64_t* needed) noexcept {
    // Not onObject: neither a failure here nor a success is the last call that the host asks for.
    try {
        if (context != nullptr && !isHandleCutOff<Context>(context) &&
            !findObject<Context>(context))
            return PMR_ERROR_HANDLE;
        writeText(plugin::lastError(), buffer, capacity, needed);
        return PMR_OK;
    } catch (...) {
        std::string text;
        return toPmr(statusOfException(text));
    }
}

PmrStatus PMR_CALL cancelBuilds(PmrContext context, int32_t on) noexcept {
    return onObject<Context>(context, [&](const std::shared_ptr<Context>& owner) {
        if (on != 0 && on != 1) throw argumentError(fmt::format("on is {}; it must be 0 or 1", on));
        owner->cancelBuilds(on == 1);
    });
}

PmrStatus PMR_CALL createMesh(PmrContext context, const PmrMeshDesc* desc, PmrMesh* mesh) noexcept {
    return create(context, desc, mesh, "PmrMeshDesc", "mesh", makeMesh);
}

PmrStatus PMR_CALL createCage(PmrContext context, const PmrCageDesc* desc, PmrMesh* mesh) noexcept {
    return create(context, desc, mesh, "PmrCageDesc", "mesh", makeCage);
}

PmrStatus PMR_CALL createSphere(PmrContext context, const PmrSphereDesc* desc,
                                PmrMesh* mesh) noexcept {
    return create(context, desc, mesh, "PmrSphereDesc", "mesh", makeSphere);
}

PmrStatus PMR_CALL createShape(PmrContext context, int32_t object,
                               const PmrParameterDesc* const* parameters, uint32_t count,
                               PmrMesh* mesh) noexcept {
    return onObject<Context>(context, [&](const std::shared_ptr<Context>& owner) {
        clearResult(mesh, "mesh");
        if (parameters == nullptr && count > 0)
            throw argumentError(fmt::format("parameters is null, but count is {}", count));
        std::vector<PmrParameterDesc> known;
        for (uint32_t i = 0; i < count; ++i)
            known.push_back(readStruct(parameters[i], "PmrParameterDesc"));
        *mesh = publish<PmrMesh>(makeShape(owner, object, known));
    });
}

PmrStatus PMR_CALL retainMesh(PmrMesh mesh) noexcept {
    return retainHandle<MeshObject>(mesh);
}

PmrStatus PMR_CALL releaseMesh(PmrMesh mesh) noexcept {
    return releaseHandle<MeshObject>(mesh);
}

PmrStatus PMR_CALL createTexture(PmrContext context, const PmrTextureDesc* desc,
                                 PmrTexture* texture) noexcept {
    return create(context, desc, texture, "PmrTextureDesc", "texture", makeTexture);
}

PmrStatus PMR_CALL retainTexture(PmrTexture texture) noexcept {
    return retainHandle<TextureObject>(texture);
}

PmrStatus PMR_CALL releaseTexture(PmrTexture texture) noexcept {
    return releaseHandle<TextureObject>(texture);
}

PmrStatus PMR_CALL createMaterial(PmrContext context, const PmrMaterialDesc* desc,
                                  PmrMaterial* material) noexcept {
    return create(context, desc, material, "PmrMaterialDesc", "material", makeMaterial);
}

PmrStatus PMR_CALL retainMaterial(PmrMaterial material) noexcept {
    return retainHandle<MaterialObject>(material);
}

PmrStatus PMR_CALL releaseMaterial(PmrMaterial material) noexcept {
    return releaseHandle<MaterialObject>(material);
}

PmrStatus PMR_CALL createScene(PmrContext context, const PmrSceneDesc* desc,
                               PmrScene* scene) noexcept {
    return onObject<Context>(context, [&](const std::shared_ptr<Context>& owner) {
        clearResult(scene, "scene");
        const PmrSceneDesc known =
            desc == nullptr ? PMR_INIT(PmrSceneDesc) : readStruct(desc, "PmrSceneDesc");
        *scene = publish<PmrScene>(std::make_shared<SceneObject>(owner, known));
    });
}

PmrStatus PMR_CALL retainScene(PmrScene scene) noexcept {
    return retainHandle<SceneObject>(scene);
}

PmrStatus PMR_CALL releaseScene(PmrScene scene) noexcept {
    return releaseHandle<SceneObject>(scene);
}

PmrStatus PMR_CALL addInstance(PmrScene scene, const PmrInstanceDesc* desc) noexcept {
    return onObject<SceneObject>(scene, [&](const std::shared_ptr<SceneObject>& object) {
        object->addInstance(readStruct(desc, "PmrInstanceDesc"));
    });
}

PmrStatus PMR_CALL addLight(PmrScene scene, const PmrLightDesc* desc) noexcept {
    return onObject<SceneObject>(scene, [&](const std::shared_ptr<SceneObject>& object) {
        object->addLight(readStruct(desc, "PmrLightDesc"));
    });
}

PmrStatus PMR_CALL setEnvironment(PmrScene scene, const PmrEnvironmentDesc* desc) noexcept {
    return onObject<SceneObject>(scene, [&](const std::shared_ptr<SceneObject>& object) {
        object->setEnvironment(readStruct(desc, "PmrEnvironmentDesc"));
    });
}

PmrStatus PMR_CALL setCamera(PmrScene scene, const PmrCameraDesc* desc) noexcept {
    return onObject<SceneObject>(scene, [&](const std::shared_ptr<SceneObject>& object) {
        object->setCamera(readStruct(desc, "PmrCameraDesc"));
    });
}

PmrStatus PMR_CALL commitScene(PmrScene scene) noexcept {
    return onObject<SceneObject>(
        scene, [&](const std::shared_ptr<SceneObject>& object) { object->commit(); });
}

PmrStatus PMR_CALL sceneBounds(PmrScene scene, double bounds[6]) noexcept {
    return onObject<SceneObject>(scene, [&](const std::shared_ptr<SceneObject>& object) {
        if (bounds == nullptr) throw argumentError("bounds is null");
        const std::array<double, 6> values = object->bounds();
        std::copy(values.begin(), values.end(), bounds);
    });
}

}  // namespace pm::plugin::api
