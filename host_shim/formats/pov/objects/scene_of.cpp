// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/pov/objects/scene_of.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "host_shim/formats/pov/objects/camera_of.h"
#include "host_shim/formats/pov/objects/meshes_of.h"
#include "host_shim/formats/pov/objects/objects.h"
#include "host_shim/values/host_error.h"

namespace pm::host::pov {
namespace {

using NodePtr = std::shared_ptr<const Node>;

class Assembly {
  public:
    Assembly(const Evaluated& scene, const std::array<std::int32_t, 2>& size)
        : m_scene(scene), m_size(size) {}

    SceneOf run() {
        m_made.data.bounds = Bounds::nothing();
        const NodePtr* camera = nullptr;
        for (const NodePtr& statement : m_scene.statements) {
            if (statement->kind == "camera") {
                ++m_made.cameras;
                camera = &statement;
            } else if (isObject(statement->kind)) {
                object(*statement, {kIdentityMatrix, nullptr});
            } else if (statement->kind != "global_settings") {
                leaveOut(*statement, "waits for looks");
            }
        }
        if (camera != nullptr) addCamera(**camera);
        return std::move(m_made);
    }

  private:
    // What objects have of those around them.
    struct Around {
        Matrix place;
        const Node* look{};  // the texture or pigment of the innermost that has one
    };

    void leaveOut(const Node& node, std::string_view why) {
        LeftOut& entry = m_made.leftOut[fmt::format("{}: {}", node.kind, why)];
        if (entry.count++ == 0) entry.first = node.place;
    }

    void addCamera(const Node& node) {
        for (const std::string_view kind : kOtherCameras)
            if (node.find(kind) != nullptr) leaveOut(*node.find(kind), "waits for shapes");
        if (auto camera = cameraOf(povCameraOf(node), m_size))
            m_made.data.cameras.push_back(std::move(*camera));
        else
            leaveOut(node, "has direction, right and up in one plane");
    }

    void object(const Node& node, const Around& around) {
        constexpr std::uint64_t kMostObjects = 10'000'000;
        if (++m_placed > kMostObjects)
            throw HostError(ExitCode::kBadInput,
                            fmt::format("{}: more than {} objects in each other", node.place.text(),
                                        kMostObjects));
        Around inside = around;
        inside.place = after(around.place, transformOfItems(node));
        for (const auto& item : node.items)
            if (item->kind == "texture" || item->kind == "pigment" || item->kind == "material")
                inside.look = item.get();
        if (node.kind == "light_source") {
            ++m_made.lights;
            return leaveOut(node, "waits for looks");
        }
        if (node.kind == "object" || node.kind == "union" || node.kind == "merge")
            return children(node, inside);
        ++m_made.objects;
        if (node.kind == "sphere") return sphere(node, inside);
        MeshData mesh;
        if (meshOf(node, mesh)) return addMesh(std::move(mesh), inside);
        leaveOut(node, "waits for shapes");
    }

    void children(const Node& node, const Around& around) {
        for (const Value& argument : node.arguments)
            if (const auto* const child = std::get_if<NodePtr>(&argument); child)
                if (isObject((*child)->kind)) object(**child, around);
        for (const NodePtr& item : node.items)
            if (isObject(item->kind) && item->isBlock) object(*item, around);
    }

    void sphere(const Node& node, const Around& around) {
        const Numbers *const centre = node.numbers(0), *const radius = node.numbers(1);
        if (centre == nullptr || radius == nullptr || !(radius->at[0] > 0))
            return leaveOut(node, "has no centre and radius");
        SphereData sphere;
        const Numbers at = centre->promoted(3);
        sphere.centre = mirrored({at.at[0], at.at[1], at.at[2]});
        sphere.radius = radius->at[0];
        InstanceData instance;
        instance.shape = InstanceData::Shape::kSphere;
        instance.index = static_cast<std::uint32_t>(m_made.data.spheres.size());
        instance.transform = mirroredTransform(around.place);
        instance.materials = {material(around.look)};
        Bounds box{sphere.centre, sphere.centre};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            box.low[axis] -= sphere.radius;
            box.high[axis] += sphere.radius;
        }
        m_made.data.bounds.add(pm::host::transformed(*instance.transform, box));
        m_made.data.spheres.push_back(sphere);
        m_made.data.instances.push_back(std::move(instance));
    }

    void addMesh(MeshData mesh, const Around& around) {
        mesh.slotMaterials = {material(around.look)};
        InstanceData instance;
        instance.index = static_cast<std::uint32_t>(m_made.data.meshes.size());
        instance.transform = mirroredTransform(around.place);
        for (std::size_t i = 0; i < mesh.positions.size() / 3; ++i)
            m_made.data.bounds.add(pm::host::transformed(*instance.transform, mesh.position(i)));
        m_made.data.faceCount += mesh.faceSizes.size();
        m_made.data.meshes.push_back(std::move(mesh));
        m_made.data.instances.push_back(std::move(instance));
    }

    // The number of a material of one colour.
    std::uint32_t material(const Node* look) {
        const std::array<float, 3> colour = colourOf(look);
        const auto [found, isNew] = m_materials.try_emplace(
            colour, static_cast<std::uint32_t>(m_made.data.materials.size()));
        if (isNew) {
            MaterialData& made = m_made.data.materials.emplace_back();
            made.name = fmt::format("colour {}", found->second + 1);
            made.diffuse = colour;
        }
        return found->second;
    }

    std::array<float, 3> colourOf(const Node* look) {
        constexpr float kDiffuse = 0.6f;  // of POV-Ray's default finish
        const Node* const pigment = look == nullptr ? nullptr : pigmentOf(*look);
        const Numbers* const colour = pigment == nullptr ? nullptr : pigment->numbers(0);
        if (colour == nullptr) {
            if (look != nullptr) leaveOut(*look, "waits for looks, gray stands for it");
            return {0.5f * kDiffuse, 0.5f * kDiffuse, 0.5f * kDiffuse};
        }
        std::array<float, 3> diffuse{};
        const Numbers all = colour->promoted(5);
        for (std::size_t i = 0; i < 3; ++i)
            diffuse[i] = std::clamp(static_cast<float>(all.at[i]) * kDiffuse, 0.0f, 1.0f);
        return diffuse;
    }

    // The pigment of a texture or material, through what was declared.
    static const Node* pigmentOf(const Node& look) {
        if (look.kind == "pigment" && look.numbers(0) != nullptr) return &look;
        if (const Node* const inner =
                look.kind == "material" ? look.find("texture") : look.find("pigment"))
            if (look.kind != "pigment") return pigmentOf(*inner);
        for (const Value& argument : look.arguments)
            if (const auto* const declared = std::get_if<NodePtr>(&argument))
                return pigmentOf(**declared);
        return nullptr;
    }

    const Evaluated& m_scene;
    std::array<std::int32_t, 2> m_size;
    SceneOf m_made;
    std::uint64_t m_placed = 0;
    std::map<std::array<float, 3>, std::uint32_t> m_materials;
};

}  // namespace

SceneOf sceneOf(const Evaluated& scene, const std::array<std::int32_t, 2>& size) {
    return Assembly(scene, size).run();
}

}  // namespace pm::host::pov
