// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Parameters by name, and their enumeration.
#include <fmt/format.h>

#include "plugin/api/api_functions.h"
#include "plugin/api/entry.h"
#include "plugin/api/objects.h"
#include "plugin/api/parameter_tables.h"
#include "plugin/api/scene_object.h"
#include "plugin/api/struct_reader.h"

namespace pm::plugin::api {

namespace {

template <typename Row>
std::vector<const ParameterInfo*> infosOf(std::span<const Row> rows) {
    std::vector<const ParameterInfo*> infos;
    for (const Row& row : rows) infos.push_back(&row.info);
    return infos;
}

// Of a kind of object; empty where there is none of that number.
std::vector<const ParameterInfo*> infosOf(std::int32_t object) {
    const SceneTables tables = sceneTables();
    switch (object) {
        case PMR_OBJECT_MATERIAL:
            return infosOf(tables.materials);
        case PMR_OBJECT_LIGHT:
            return infosOf(tables.lights);
        case PMR_OBJECT_ENVIRONMENT:
            return infosOf(tables.environments);
        case PMR_OBJECT_CAMERA:
            return infosOf(tables.cameras);
        case PMR_OBJECT_INSTANCE:
            return infosOf(tables.instances);
        case PMR_OBJECT_SPHERE:
            return infosOf(tables.spheres);
        default:
            return {};
    }
}

PmrParameterInfo toInfo(const ParameterInfo& row) {
    PmrParameterInfo info{};
    info.size = sizeof info;
    info.name = row.name;
    info.unit = row.unit;
    info.defaultText = row.defaultText;
    info.choices = row.choices;
    info.help = row.help;
    info.minimum = row.minimum;
    info.maximum = row.maximum;
    info.type = static_cast<std::int32_t>(row.type);
    info.count = row.count;
    info.excludesMinimum = row.excludesMinimum ? 1 : 0;
    info.excludesMaximum = row.excludesMaximum ? 1 : 0;
    info.changesPixels = row.changesPixels ? 1 : 0;
    return info;
}

template <typename Object, typename Handle>
std::shared_ptr<Object> objectOf(Handle handle, const char* member) {
    auto object = findObject<Object>(handle);
    if (!object)
        throw CallError(CallStatus::kHandle,
                        fmt::format("PmrParameterDesc: {} is not a live one", member));
    return object;
}

}  // namespace

uint32_t PMR_CALL parameterCount(int32_t object) noexcept {
    try {
        return static_cast<uint32_t>(infosOf(object).size());
    } catch (...) {
        return 0;
    }
}

PmrStatus PMR_CALL parameterInfo(int32_t object, uint32_t index, PmrParameterInfo* info) noexcept {
    return onNothing([&] {
        const std::vector<const ParameterInfo*> infos = infosOf(object);
        checkIndex(index, infos.size());
        writeStruct(info, toInfo(*infos[index]), "PmrParameterInfo");
    });
}

PmrStatus PMR_CALL setParameter(const PmrParameterDesc* desc) noexcept {
    return onNothing([&] {
        const PmrParameterDesc known = readStruct(desc, "PmrParameterDesc");
        if (known.name == nullptr) throw argumentError("PmrParameterDesc: name is null");
        const bool ofMaterial = known.object == PMR_OBJECT_MATERIAL;
        if ((ofMaterial ? known.scene != nullptr : known.material != nullptr))
            throw argumentError(fmt::format("PmrParameterDesc: object is {}; {} must be null",
                                            known.object, ofMaterial ? "scene" : "material"));
        if (ofMaterial)
            objectOf<MaterialObject>(known.material, "material")->setParameter(known);
        else
            objectOf<SceneObject>(known.scene, "scene")->setParameter(known);
    });
}

}  // namespace pm::plugin::api
