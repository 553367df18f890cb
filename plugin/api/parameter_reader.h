// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Structs of the interface as presets of parameters, and parameters by name.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "plugin/api/context.h"
#include "plugin/include/pm_plugin.h"
#include "plugin/parameters/parameter_set.h"
#include "plugin/parameters/scene_tables.h"

namespace pm::plugin {

using MaterialSet = ParameterSet<MaterialParameter>;
using LightSet = ParameterSet<LightParameter>;
using EnvironmentSet = ParameterSet<EnvironmentParameter>;
using CameraSet = ParameterSet<CameraParameter>;
using InstanceSet = ParameterSet<InstanceParameter>;

// What a struct says of one parameter, not checked yet but for transforms. type: the struct's, for
// errors. Errors: those of readTransform; CallError HANDLE for a texture that is not live, ARGUMENT
// for one of another context.
ParameterValue readMember(const void* desc, const StructPlace& place, const ParameterInfo& info,
                          const Context& context, const std::string& type);

// All that a struct says, not checked yet; what is not in it has its default. Errors as above.
template <typename Set>
void readStructInto(Set& set, const void* desc, const Context& context, const std::string& type) {
    for (std::size_t i = 0; i < set.rows().size(); ++i) {
        const auto& row = set.rows()[i];
        if (row.inStruct.kind != StructPlace::Kind::kNone)
            set.assign(i, readMember(desc, row.inStruct, row.info, context, type));
    }
}

// Sets what setParameter was given. Errors: CallError NAME, ARGUMENT, HANDLE; nothing is changed
// then.
template <typename Set>
void setByName(Set& set, const PmrParameterDesc& desc, const Context& context,
               const std::string& owner);

// The texture of a handle; null for a null one. member: for errors, as "PmrMaterialDesc:
// diffuseTexture". Errors: CallError HANDLE, ARGUMENT.
std::shared_ptr<const Texture> findTexture(const Context& context, PmrTexture handle,
                                           const std::string& member);

// What setParameter was given for a row, not checked yet.
ParameterValue givenValue(const ParameterInfo& info, const PmrParameterDesc& desc,
                          const Context& context, const std::string& owner);

template <typename Set>
void setByName(Set& set, const PmrParameterDesc& desc, const Context& context,
               const std::string& owner) {
    const std::string name = desc.name == nullptr ? "" : desc.name;
    const auto& row = set.rows()[indexOf(set.rows(), name, owner)];
    ParameterValue value = givenValue(row.info, desc, context, owner);
    // A number that a struct holds as a float is one here as well.
    if (row.inStruct.kind == StructPlace::Kind::kFloats)
        for (double& number : value.numbers)
            number = static_cast<double>(static_cast<float>(number));
    set.set(name, std::move(value), owner);
}

}  // namespace pm::plugin
