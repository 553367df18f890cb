// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/integrator/geometry/obj_cage.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>
#include <sstream>

namespace pm::test {
namespace {

template <typename T>
T number(std::string_view word) {
    T value{};
    std::from_chars(word.data(), word.data() + word.size(), value);
    return value;
}

std::vector<std::string_view> split(std::string_view line) {
    std::vector<std::string_view> words;
    std::size_t at = 0;
    while ((at = line.find_first_not_of(" \t\r", at)) != std::string_view::npos) {
        const std::size_t end = std::min(line.find_first_of(" \t\r", at), line.size());
        words.push_back(line.substr(at, end - at));
        at = end;
    }
    return words;
}

using Words = std::vector<std::string_view>;

void addTag(const Words& words, SubdivisionCage& cage) {
    const std::string_view name = words[1];
    const auto index = [&](std::size_t i) { return number<std::uint32_t>(words[i]); };
    if (name == "crease") cage.creases.push_back({{index(3), index(4)}, number<float>(words[5])});
    if (name == "corner") cage.corners.push_back({index(3), number<float>(words[4])});
    if (name == "hole") cage.holes.push_back(index(3));
    if (name == "interpolateboundary") {
        constexpr BoundaryInterpolation kRules[] = {BoundaryInterpolation::kNone,
                                                    BoundaryInterpolation::kEdgeAndCorner,
                                                    BoundaryInterpolation::kEdgeOnly};
        cage.boundary = kRules[index(3)];
    }
    if (name == "smoothtriangles") cage.smoothTriangles = true;
    if (name == "creasemethod" && words[3] == "chaikin") cage.creaseMethod = CreaseMethod::kChaikin;
}

void addFace(const Words& words, PolygonMesh& mesh) {
    mesh.faceVertexCounts.push_back(static_cast<std::uint32_t>(words.size() - 1));
    for (std::size_t i = 1; i < words.size(); ++i) {
        const std::size_t slash = words[i].find('/');
        const int vertex = number<int>(words[i].substr(0, slash));
        mesh.vertexIndices.push_back(
            vertex > 0
                ? static_cast<std::uint32_t>(vertex - 1)
                : static_cast<std::uint32_t>(static_cast<int>(mesh.positions.size()) + vertex));
        const bool hasTexcoord = slash != std::string_view::npos && words[i].size() > slash + 1 &&
                                 words[i][slash + 1] != '/';
        const int texcoord = hasTexcoord ? number<int>(words[i].substr(slash + 1)) : 0;
        mesh.texcoordIndices.push_back(texcoord > 0 ? texcoord - 1 : -1);
    }
}

}  // namespace

SubdivisionCage parseObjCage(std::string_view text) {
    SubdivisionCage cage;
    cage.boundary = BoundaryInterpolation::kEdgeOnly;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const Words words = split(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
        if (words.empty()) continue;
        const auto value = [&](std::size_t i) { return number<float>(words[i]); };
        if (words[0] == "v") cage.mesh.positions.emplace_back(value(1), value(2), value(3));
        if (words[0] == "vt") cage.mesh.texcoords.push_back({value(1), value(2)});
        if (words[0] == "f") addFace(words, cage.mesh);
        if (words[0] == "t") addTag(words, cage);
    }
    if (cage.mesh.texcoords.empty()) cage.mesh.texcoordIndices.clear();
    return cage;
}

SubdivisionCage readObjCage(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    SubdivisionCage cage = parseObjCage(text);
    const std::string name = path.filename().string();
    if (name.starts_with("loop")) cage.scheme = SubdivisionScheme::kLoop;
    if (name.starts_with("bilinear")) cage.scheme = SubdivisionScheme::kBilinear;
    return cage;
}

std::vector<std::filesystem::path> objFiles(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
        if (entry.path().extension() == ".obj") files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    return files;
}

SubdivisionCage cubeCage() {
    return parseObjCage(
        "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n"
        "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n");
}

SubdivisionCage gridCage(int side) {
    SubdivisionCage cage;
    for (int y = 0; y <= side; ++y) {
        for (int x = 0; x <= side; ++x) {
            cage.mesh.positions.emplace_back(static_cast<float>(x), static_cast<float>(y), 0.0f);
        }
    }
    const auto at = [side](int x, int y) { return static_cast<std::uint32_t>(y * (side + 1) + x); };
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            cage.mesh.faceVertexCounts.push_back(4);
            for (const std::uint32_t vertex :
                 {at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)}) {
                cage.mesh.vertexIndices.push_back(vertex);
            }
        }
    }
    return cage;
}

}  // namespace pm::test
