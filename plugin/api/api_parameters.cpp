// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Parameters by name, and their enumeration.
#include <fmt/format.h>

#include <array>
#include <tuple>
#include <variant>
#include <vector>

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

// A kind of object, by its number PMR_OBJECT_*.
struct ObjectTable {
    const char* name;
    std::vector<const ParameterInfo*> infos;
};

template <typename Kinds>
struct NamesOf;
template <typename Mesh, typename Limit, typename... Curved>
struct NamesOf<std::variant<Mesh, Limit, Curved...>> {
    static constexpr std::array<const char*, sizeof...(Curved)> kNames = {Curved::kName...};
};

const std::vector<ObjectTable>& objectTables() {
    static const std::vector<ObjectTable> tables = [] {
        const SceneTables rows = sceneTables();
        std::vector<ObjectTable> made = {{"material", infosOf(rows.materials)},
                                         {"light", infosOf(rows.lights)},
                                         {"environment", infosOf(rows.environments)},
                                         {"camera", infosOf(rows.cameras)},
                                         {"instance", infosOf(rows.instances)}};
        const auto* name = NamesOf<Shape>::kNames.data();
        std::apply(
            [&](const auto&... ofShape) {
                (made.push_back({*name++, infosOf(ofShape)}), ...);
            },
            rows.shapes);
        return made;
    }();
    return tables;
}

// Null where there is none of that number.
const ObjectTable* findTable(std::int32_t object) {
    const std::vector<ObjectTable>& tables = objectTables();
    const bool isThere = object >= 0 && object < std::ssize(tables);
    return isThere ? &tables[static_cast<std::size_t>(object)] : nullptr;
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
        const ObjectTable* table = findTable(object);
        return table == nullptr ? 0 : static_cast<uint32_t>(table->infos.size());
    } catch (...) {
        return 0;
    }
}

PmrStatus PMR_CALL parameterInfo(int32_t object, uint32_t index, PmrParameterInfo* info) noexcept {
    return onNothing([&] {
        const ObjectTable* table = findTable(object);
        checkIndex(index, table == nullptr ? 0 : table->infos.size());
        writeStruct(info, toInfo(*table->infos[index]), "PmrParameterInfo");
    });
}

const char* PMR_CALL objectName(int32_t object) noexcept {
    try {
        const ObjectTable* table = findTable(object);
        return table == nullptr ? nullptr : table->name;
    } catch (...) {
        return nullptr;
    }
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
