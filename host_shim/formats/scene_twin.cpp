// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/scene_twin.h"

#include <array>
#include <bit>
#include <cstddef>

namespace pm::host {
namespace {

constexpr double kMost = 1e-7;

// The finalizer of SplitMix64 (Steele, Lea, Flood, 2014): every bit of the result depends on every
// bit of the value.
std::uint64_t mixed(std::uint64_t value) {
    value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9ull;
    value = (value ^ (value >> 27)) * 0x94d049bb133111ebull;
    return value ^ (value >> 31);
}

class Mover {
  public:
    explicit Mover(std::uint32_t twin) : m_twin(twin) {}

    // Of one place all components move by keys of their own.
    template <typename Number, std::size_t count>
    std::array<Number, count> moved(const std::array<Number, count>& place) const {
        std::uint64_t key = mixed(m_twin);
        for (const Number value : place)
            key = mixed(key ^ std::bit_cast<std::uint64_t>(static_cast<double>(value)));
        std::array<Number, count> result;
        for (std::size_t i = 0; i < count; ++i) {
            key = mixed(key + kStep);
            const double u = 2 * (static_cast<double>(key >> 11) * 0x1p-53) - 1;
            result[i] = static_cast<Number>(static_cast<double>(place[i]) * (1 + kMost * u));
        }
        return result;
    }

  private:
    static constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15ull;
    std::uint64_t m_twin;
};

}  // namespace

void makeTwin(std::uint32_t twin, SceneData& scene) {
    const Mover mover(twin);
    for (MeshData& mesh : scene.meshes)
        for (std::size_t i = 0; i + 2 < mesh.positions.size(); i += 3) {
            const auto moved = mover.moved(
                std::array{mesh.positions[i], mesh.positions[i + 1], mesh.positions[i + 2]});
            for (std::size_t axis = 0; axis < 3; ++axis) mesh.positions[i + axis] = moved[axis];
        }
    for (SphereData& sphere : scene.spheres) {
        sphere.centre = mover.moved(sphere.centre);
        sphere.radius = mover.moved(std::array{sphere.radius})[0];
    }
}

}  // namespace pm::host
