// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Shapes that are no meshes.
#include <fmt/format.h>

#include <array>
#include <utility>
#include <variant>

#include "plugin/api/objects.h"
#include "plugin/api/parameter_reader.h"
#include "plugin/api/parameter_tables.h"
#include "plugin/values/call_error.h"

namespace pm::plugin {

namespace {

template <typename Kind>
std::shared_ptr<MeshObject> makeOf(std::shared_ptr<Context> context,
                                   ParameterSet<Parameter<Kind>> values, const std::string& owner) {
    values.check(0, owner);
    Kind shape;
    values.putInto(shape);
    return std::make_shared<MeshObject>(std::move(context), shape, 1);
}

template <typename Kind>
std::shared_ptr<MeshObject> makeByName(std::shared_ptr<Context> context, std::int32_t object,
                                       std::span<const PmrParameterDesc> parameters) {
    ParameterSet<Parameter<Kind>> values(rowsOf<Kind>(sceneTables().shapes));
    for (const PmrParameterDesc& desc : parameters) {
        if (desc.object != object)
            throw argumentError(
                fmt::format("PmrParameterDesc: object is {}; of this shape it must "
                            "be {}",
                            desc.object, object));
        if (desc.material != nullptr || desc.scene != nullptr)
            throw argumentError("PmrParameterDesc: material and scene must be null");
        setByName(values, desc, *context, Kind::kName);
    }
    return makeOf<Kind>(std::move(context), std::move(values), Kind::kName);
}

using MakeByName = std::shared_ptr<MeshObject> (*)(std::shared_ptr<Context>, std::int32_t,
                                                   std::span<const PmrParameterDesc>);

// How each kind is made, in the order of Shape.
template <typename Kinds>
struct MakersOf;
template <typename Mesh, typename Limit, typename... Curved>
struct MakersOf<std::variant<Mesh, Limit, Curved...>> {
    static constexpr std::array<MakeByName, sizeof...(Curved)> kMakers = {makeByName<Curved>...};
};

}  // namespace

std::shared_ptr<MeshObject> makeSphere(std::shared_ptr<Context> context,
                                       const PmrSphereDesc& desc) {
    ParameterSet<SphereParameter> values(sphereParameters());
    readStructInto(values, &desc, *context, "PmrSphereDesc");
    return makeOf<SphereShape>(std::move(context), std::move(values), "PmrSphereDesc");
}

std::shared_ptr<MeshObject> makeShape(std::shared_ptr<Context> context, std::int32_t object,
                                      std::span<const PmrParameterDesc> parameters) {
    constexpr auto& kMakers = MakersOf<Shape>::kMakers;
    const std::int64_t kind = std::int64_t{object} - PMR_OBJECT_SPHERE;
    if (kind < 0 || kind >= std::ssize(kMakers))
        throw argumentError(
            fmt::format("object is {}; of a shape it must be {} to {} "
                        "(PMR_OBJECT_SPHERE and those that follow)",
                        object, PMR_OBJECT_SPHERE, PMR_OBJECT_SPHERE + std::ssize(kMakers) - 1));
    return kMakers[static_cast<std::size_t>(kind)](std::move(context), object, parameters);
}

}  // namespace pm::plugin
