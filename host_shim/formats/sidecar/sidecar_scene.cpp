// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// A sidecar and the scene that it stands beside.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "host_shim/formats/sidecar/sidecar.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

constexpr std::size_t kMostInstances = std::size_t{16} << 20;

// What is said in a list of what is allowed, and no more.
template <typename Names>
std::string listed(const Names& names) {
    constexpr std::size_t kMost = 12;
    std::string text;
    std::size_t count = 0;
    for (const std::string& name : names)
        if (!name.empty() && count++ < kMost)
            text += fmt::format("{}'{}'", text.empty() ? "" : ", ", name);
    if (count > kMost) text += fmt::format(" and {} more", count - kMost);
    return text.empty() ? "none" : text;
}

Bounds boxOf(const SphereData& sphere) {
    Bounds box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        box.low[axis] = sphere.centre[axis] - sphere.radius;
        box.high[axis] = sphere.centre[axis] + sphere.radius;
    }
    return box;
}

class Addition {
  public:
    Addition(const Sidecar& sidecar, SceneData& scene) : m_sidecar(sidecar), m_scene(scene) {
        for (std::uint32_t i = 0; i < scene.meshes.size(); ++i)
            m_groups[scene.meshes[i].name].push_back(i);
        for (std::uint32_t i = 0; i < scene.materials.size(); ++i)
            m_materials.emplace(scene.materials[i].name, i);
    }

    void add() {
        std::vector<InstanceData> placed;
        std::set<std::uint32_t> moved;
        for (const SidecarInstance& instance : m_sidecar.instances) {
            for (const std::uint32_t mesh : meshesOf(instance)) {
                moved.insert(mesh);
                placed.push_back(place(instance, mesh));
                if (placed.size() > kMostInstances)
                    refuse(instance.place, fmt::format("makes more than {} instances, which is the "
                                                       "most of a scene",
                                                       kMostInstances));
            }
        }
        std::erase_if(m_scene.instances, [&moved](const InstanceData& instance) {
            return instance.shape == InstanceData::Shape::kMesh && moved.contains(instance.index);
        });
        std::ranges::move(placed, std::back_inserter(m_scene.instances));
        for (const SidecarSphere& sphere : m_sidecar.spheres) add(sphere);
        if (!m_sidecar.instances.empty() || !m_sidecar.spheres.empty()) measure();
        m_scene.lights.insert(m_scene.lights.end(), m_sidecar.lights.begin(),
                              m_sidecar.lights.end());
        for (const SidecarMaterial& given : m_sidecar.materials) {
            MaterialData& known = m_scene.materials[material(given.name, given.place)];
            known.byName = given.values;
        }
        if (m_sidecar.environment) m_scene.environment = m_sidecar.environment;
        if (m_sidecar.sky) m_scene.sky = m_sidecar.sky;
        m_scene.cameras.insert(m_scene.cameras.end(), m_sidecar.cameras.begin(),
                               m_sidecar.cameras.end());
    }

  private:
    [[noreturn]] void refuse(const std::string& place, const std::string& text) const {
        throw HostError(ExitCode::kBadInput, fmt::format("{}: {} {}", m_sidecar.file, place, text));
    }

    std::vector<std::uint32_t> meshesOf(const SidecarInstance& instance) const {
        if (instance.of.empty()) {
            std::vector<std::uint32_t> all(m_scene.meshes.size());
            for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
            return all;
        }
        const auto found = m_groups.find(instance.of);
        if (found != m_groups.end()) return found->second;
        std::vector<std::string> names;
        for (const auto& [name, meshes] : m_groups) names.push_back(name);
        refuse(instance.place + ".of",
               fmt::format("is '{}', and no group of the scene; they are {}", instance.of,
                           listed(names)));
    }

    std::uint32_t material(const std::string& name, const std::string& place) const {
        const auto found = m_materials.find(name);
        if (found != m_materials.end()) return found->second;
        std::vector<std::string> names;
        for (const auto& [known, index] : m_materials) names.push_back(known);
        refuse(place, fmt::format("is '{}', which no material library of the scene has; of those "
                                  "that faces use there are {}",
                                  name, listed(names)));
    }

    InstanceData place(const SidecarInstance& from, std::uint32_t mesh) const {
        InstanceData instance;
        instance.name = from.name.value_or(m_scene.meshes[mesh].name);
        instance.index = mesh;
        instance.transform = from.transform;
        instance.hiddenFrom = from.hiddenFrom;
        if (from.material.empty() && from.materials.empty()) return instance;
        const std::string where = from.place + ".materials";
        instance.materials = m_scene.meshes[mesh].slotMaterials;
        for (std::uint32_t& slot : instance.materials) {
            if (!from.material.empty()) slot = material(from.material, where);
            const auto found = std::ranges::find(from.materials, m_scene.materials[slot].name,
                                                 &std::pair<std::string, std::string>::first);
            if (found != from.materials.end()) slot = material(found->second, where);
        }
        return instance;
    }

    void add(const SidecarSphere& sphere) {
        InstanceData instance;
        instance.name = sphere.sphere.name;
        instance.shape = InstanceData::Shape::kSphere;
        instance.index = static_cast<std::uint32_t>(m_scene.spheres.size());
        instance.transform = sphere.transform;
        instance.materials = {material(sphere.material, sphere.place + ".material")};
        instance.hiddenFrom = sphere.hiddenFrom;
        m_scene.spheres.push_back(sphere.sphere);
        m_scene.instances.push_back(std::move(instance));
    }

    // The bounds of the scene, from the boxes of its shapes.
    void measure() {
        std::vector<Bounds> meshes;
        for (const MeshData& mesh : m_scene.meshes) {
            Bounds& box = meshes.emplace_back(Bounds::nothing());
            const std::vector<float>& p = mesh.positions;
            for (std::size_t i = 0; i + 2 < p.size(); i += 3) {
                const std::array<double, 3> vertex{p[i], p[i + 1], p[i + 2]};
                box.add(vertex);
            }
        }
        Bounds all = Bounds::nothing();
        for (const InstanceData& instance : m_scene.instances) {
            const bool isMesh = instance.shape == InstanceData::Shape::kMesh;
            all.add(transformed(
                m_scene.toWorld(instance),
                isMesh ? meshes[instance.index] : boxOf(m_scene.spheres[instance.index])));
        }
        m_scene.bounds = all;
    }

    const Sidecar& m_sidecar;
    SceneData& m_scene;
    std::map<std::string, std::vector<std::uint32_t>> m_groups;
    std::map<std::string, std::uint32_t> m_materials;
};

// Names that an instance would replace and no mesh of it has would say nothing in silence.
void checkReplaced(const Sidecar& sidecar, const SceneData& scene) {
    for (const SidecarInstance& instance : sidecar.instances) {
        if (instance.materials.empty()) continue;
        std::set<std::string> has;
        for (const MeshData& mesh : scene.meshes) {
            if (!instance.of.empty() && mesh.name != instance.of) continue;
            for (const std::uint32_t slot : mesh.slotMaterials)
                has.insert(scene.materials[slot].name);
        }
        for (const auto& [old, name] : instance.materials)
            if (!has.contains(old))
                throw HostError(ExitCode::kBadInput,
                                fmt::format("{}: {}.materials names '{}', which is on no face of "
                                            "it; there are {}",
                                            sidecar.file, instance.place, old, listed(has)));
    }
}

}  // namespace

void addSidecar(const Sidecar& sidecar, SceneData& scene) {
    Addition addition(sidecar, scene);
    checkReplaced(sidecar, scene);
    addition.add();
    scene.sidecar = sidecar.file;
    scene.files.push_back(sidecar.file);
}

}  // namespace pm::host
