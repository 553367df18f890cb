// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/tri/tri_reader.h"

#include <fmt/format.h>

#include <sstream>

#include "host_shim/formats/source_file.h"
#include "host_shim/values/host_error.h"

namespace pm::host {

std::span<const std::string_view> TriReader::endings() const {
    static constexpr std::string_view kEndings[] = {".tri"};
    return kEndings;
}

SceneData TriReader::read(const ReadRequest& request) const {
    checkSceneFile(request.file, ".tri");
    SceneData scene;
    scene.bounds = Bounds::nothing();
    scene.materials.resize(2);
    scene.materials[0].name = "matt";
    scene.materials[1].name = "lamp";
    scene.materials[1].diffuse = {};
    scene.materials[1].emission = {5, 5, 5};
    MeshData mesh;
    mesh.name = "triangles";
    mesh.slotMaterials = {0, 1};
    std::istringstream lines(readWholeFile(request.file));
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
        std::istringstream words(line);
        std::string material;
        std::array<float, 9> corners{};
        words >> material;
        for (float& value : corners) words >> value;
        if (!words || (material != "matt" && material != "lamp"))
            throw HostError(ExitCode::kBadInput,
                            fmt::format("{}:{}: must be matt or lamp, then nine numbers",
                                        request.file.string(), number));
        for (std::size_t i = 0; i < 9; i += 3) {
            mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size() / 3));
            mesh.positions.insert(mesh.positions.end(),
                                  {corners[i], corners[i + 1], corners[i + 2]});
            scene.bounds.add(std::array<double, 3>{corners[i], corners[i + 1], corners[i + 2]});
        }
        mesh.faceSizes.push_back(3);
        mesh.faceSlots.push_back(material == "lamp" ? 1 : 0);
    }
    scene.faceCount = mesh.faceSizes.size();
    scene.meshes.push_back(std::move(mesh));
    scene.placeEachMesh();
    return scene;
}

}  // namespace pm::host
