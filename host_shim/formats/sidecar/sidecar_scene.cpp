// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// A sidecar and the scene that it stands beside.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "host_shim/formats/json/json_budget.h"
#include "host_shim/formats/sidecar/json_place.h"
#include "host_shim/formats/sidecar/sidecar.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

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

using Numbers = std::vector<std::uint32_t>;

// What names of a sidecar are in the scene that it stands beside, each looked for once.
class SceneNames {
  public:
    SceneNames(const NameTable& names, const SceneData& scene) : m_names(names), m_scene(scene) {
        m_meshesOf.resize(names.size());
        for (std::uint32_t i = 0; i < scene.meshes.size(); ++i) {
            m_all.push_back(i);
            const std::uint32_t number = names.find(scene.meshes[i].name);
            if (number != NameTable::kNone) m_meshesOf[number].push_back(i);
        }
        m_materialOf.resize(names.size(), kNoIndex);
        for (std::uint32_t i = 0; i < scene.materials.size(); ++i) {
            m_numbers.push_back(names.find(scene.materials[i].name));
            if (m_numbers[i] != NameTable::kNone && m_materialOf[m_numbers[i]] == kNoIndex)
                m_materialOf[m_numbers[i]] = i;
        }
    }

    // The meshes of a name, all of them where it is none; empty where there are none of it.
    const Numbers& meshesOf(std::uint32_t name) const {
        return name == NameTable::kNone ? m_all : m_meshesOf[name];
    }
    // The material of a name; kNoIndex: none.
    std::uint32_t materialOf(std::uint32_t name) const { return m_materialOf[name]; }
    // The number of a material's name; NameTable::kNone where the sidecar doesn't say it.
    std::uint32_t numberOf(std::uint32_t material) const { return m_numbers[material]; }

    // Whether a face of the meshes of a name has a material of that name.
    bool hasMaterial(std::uint32_t meshes, std::uint32_t material) {
        const auto [known, isNew] = m_slots.try_emplace(meshes);
        if (isNew) {
            for (const std::uint32_t mesh : meshesOf(meshes))
                for (const std::uint32_t slot : m_scene.meshes[mesh].slotMaterials)
                    known->second.push_back(m_numbers[slot]);
            std::ranges::sort(known->second);
            known->second.erase(std::unique(known->second.begin(), known->second.end()),
                                known->second.end());
        }
        return std::ranges::binary_search(known->second, material);
    }

  private:
    const NameTable& m_names;
    const SceneData& m_scene;
    Numbers m_all, m_materialOf, m_numbers;
    std::vector<Numbers> m_meshesOf;
    std::map<std::uint32_t, Numbers> m_slots;  // names on the faces of the meshes of a name
};

class Addition {
  public:
    Addition(const Sidecar& sidecar, SceneData& scene, const SidecarLimits& limits)
        : m_sidecar(sidecar),
          m_scene(scene),
          m_goOn(limits.goOn),
          m_held(JsonBudget::ofLimit(sidecar.file, limits.memoryBytes)),
          m_names(sidecar.names, scene) {}

    void add() {
        for (const SidecarInstance& instance : m_sidecar.instances) {
            look();
            checkReplaced(instance);
        }
        addInstances();
        for (const SidecarSphere& sphere : m_sidecar.spheres) add(sphere);
        if (!m_sidecar.instances.empty() || !m_sidecar.spheres.empty()) measure();
        m_scene.lights.insert(m_scene.lights.end(), m_sidecar.lights.begin(),
                              m_sidecar.lights.end());
        addMaterials();
        if (m_sidecar.environment) m_scene.environment = m_sidecar.environment;
        if (m_sidecar.sky) m_scene.sky = m_sidecar.sky;
        m_scene.cameras = m_sidecar.cameras;
    }

  private:
    [[noreturn]] void refuse(const std::string& place, const std::string& text) const {
        throw HostError(ExitCode::kBadInput, fmt::format("{}: {} {}", m_sidecar.file, place, text));
    }

    // Called for each of many.
    void look() {
        constexpr std::size_t kBetweenLooks = 1024;
        if (++m_looks % kBetweenLooks == 0 && m_goOn) m_goOn();
    }

    static std::string placeOf(const SidecarInstance& instance, const char* key) {
        return fmt::format("instances[{}]{}", instance.index, key);
    }

    void addInstances() {
        std::vector<InstanceData> placed;
        std::vector<bool> isMoved(m_scene.meshes.size());
        for (const SidecarInstance& instance : m_sidecar.instances) {
            for (const std::uint32_t mesh : meshesOf(instance)) {
                look();
                isMoved[mesh] = true;
                placed.push_back(place(instance, mesh));
                if (placed.size() > kMostInstances)
                    refuse(placeOf(instance, ""),
                           fmt::format("makes more than {} instances, which is the most of a scene",
                                       kMostInstances));
            }
        }
        std::erase_if(m_scene.instances, [&isMoved](const InstanceData& instance) {
            return instance.shape == InstanceData::Shape::kMesh && isMoved[instance.index];
        });
        if (m_scene.instances.empty())
            m_scene.instances = std::move(placed);
        else
            std::ranges::move(placed, std::back_inserter(m_scene.instances));
    }

    const Numbers& meshesOf(const SidecarInstance& instance) const {
        const Numbers& meshes = m_names.meshesOf(instance.of);
        if (!meshes.empty() || instance.of == NameTable::kNone) return meshes;
        std::set<std::string> names;
        for (const MeshData& mesh : m_scene.meshes) names.insert(mesh.name);
        refuse(placeOf(instance, ".of"),
               fmt::format("is '{}', and no group of the scene; they are {}",
                           m_sidecar.names[instance.of], listed(names)));
    }

    // place: makes the text that messages begin with.
    template <typename Place>
    std::uint32_t material(std::uint32_t name, const Place& place) const {
        const std::uint32_t found = m_names.materialOf(name);
        if (found != kNoIndex) return found;
        refuseMaterial(m_sidecar.names[name], place());
    }
    [[noreturn]] void refuseMaterial(const std::string& name, const std::string& place) const {
        std::set<std::string> names;
        for (const MaterialData& material : m_scene.materials) names.insert(material.name);
        refuse(place, fmt::format("is '{}', which no material library of the scene has; of those "
                                  "that faces use there are {}",
                                  name, listed(names)));
    }

    InstanceData place(const SidecarInstance& from, std::uint32_t mesh) {
        InstanceData instance;
        instance.name = from.name.empty() ? m_scene.meshes[mesh].name : from.name;
        instance.index = mesh;
        instance.transform = from.transform;
        instance.hiddenFrom = from.hiddenFrom;
        const bool isReplaced = from.material != NameTable::kNone || !from.materials.empty();
        if (isReplaced) instance.materials = replaced(from, m_scene.meshes[mesh].slotMaterials);
        m_held.take(2 * sizeof instance + instance.name.size() +
                    instance.materials.size() * sizeof(std::uint32_t));
        return instance;
    }

    Numbers replaced(const SidecarInstance& from, Numbers slots) {
        const auto where = [&from] { return placeOf(from, ".materials"); };
        for (std::uint32_t& slot : slots) {
            look();
            if (from.material != NameTable::kNone) slot = material(from.material, where);
            const std::uint32_t number = m_names.numberOf(slot);
            const auto found = std::ranges::lower_bound(
                from.materials, number, {}, &std::pair<std::uint32_t, std::uint32_t>::first);
            if (found != from.materials.end() && found->first == number)
                slot = material(found->second, where);
        }
        return slots;
    }

    // Names that an instance would replace and no mesh of it has would say nothing in silence.
    void checkReplaced(const SidecarInstance& instance) {
        for (const auto& [old, name] : instance.materials) {
            if (m_names.hasMaterial(instance.of, old)) continue;
            std::set<std::string> has;
            for (const std::uint32_t mesh : meshesOf(instance))
                for (const std::uint32_t slot : m_scene.meshes[mesh].slotMaterials)
                    has.insert(m_scene.materials[slot].name);
            refuse(placeOf(instance, ".materials"),
                   fmt::format("names '{}', which is on no face of it; there are {}",
                               m_sidecar.names[old], listed(has)));
        }
    }

    void add(const SidecarSphere& sphere) {
        look();
        InstanceData instance;
        instance.name = sphere.sphere.name;
        instance.shape = InstanceData::Shape::kSphere;
        instance.index = static_cast<std::uint32_t>(m_scene.spheres.size());
        instance.transform = sphere.transform;
        instance.materials = {material(sphere.material, [&] {
            return fmt::format("spheres[{}].material", &sphere - m_sidecar.spheres.data());
        })};
        instance.hiddenFrom = sphere.hiddenFrom;
        m_held.take(2 * (sizeof instance + sizeof sphere.sphere + sphere.sphere.name.size()));
        m_scene.spheres.push_back(sphere.sphere);
        m_scene.instances.push_back(std::move(instance));
    }

    void addMaterials() {
        std::map<std::string_view, std::uint32_t> known;
        if (!m_sidecar.materials.empty())
            for (std::uint32_t i = 0; i < m_scene.materials.size(); ++i)
                known.emplace(m_scene.materials[i].name, i);
        for (const SidecarMaterial& given : m_sidecar.materials) {
            look();
            const auto found = known.find(given.name);
            if (found == known.end())
                refuseMaterial(given.name, JsonPlace::memberPath("materials", given.name));
            for (const NamedValue& value : given.values)
                if ((value.name == "first" || value.name == "second") &&
                    !known.contains(value.text))
                    refuseMaterial(value.text, value.place);
            MaterialData& material = m_scene.materials[found->second];
            material.byName = given.values;
            if (given.weightTexture) material.weightTexture = given.weightTexture;
        }
    }

    // The bounds of the scene, from the boxes of its shapes.
    void measure() {
        std::vector<Bounds> meshes;
        for (const MeshData& mesh : m_scene.meshes) {
            Bounds& box = meshes.emplace_back(Bounds::nothing());
            const std::vector<float>& p = mesh.positions;
            for (std::size_t i = 0; i + 2 < p.size(); i += 3) {
                look();
                const std::array<double, 3> vertex{p[i], p[i + 1], p[i + 2]};
                box.add(vertex);
            }
        }
        Bounds all = Bounds::nothing();
        for (const InstanceData& instance : m_scene.instances) {
            look();
            const bool isMesh = instance.shape == InstanceData::Shape::kMesh;
            all.add(transformed(
                m_scene.toWorld(instance),
                isMesh ? meshes[instance.index] : boxOf(m_scene.spheres[instance.index])));
        }
        m_scene.bounds = all;
    }

    const Sidecar& m_sidecar;
    SceneData& m_scene;
    const GoOn& m_goOn;
    JsonBudget m_held;
    SceneNames m_names;
    std::size_t m_looks{};
};

}  // namespace

void addSidecar(const Sidecar& sidecar, SceneData& scene, const SidecarLimits& limits) {
    Addition(sidecar, scene, limits).add();
    scene.sidecar = sidecar.file;
    scene.files.push_back(sidecar.file);
}

}  // namespace pm::host
