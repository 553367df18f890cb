// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "integrator/values/cancel_check.h"
#include "integrator/values/vec.h"

namespace pm {

// Where on a lamp its texture shines. The lamp is a unit square (of a sphere its picture) or the
// triangle of barycentric coordinates b1, b2; it is divided in four cells of the same area, those
// again, as deep as what is seen of them differs. A cell is chosen in proportion to what shines
// there, a point within it evenly; a small share of the points is chosen evenly over all, so that
// what was overlooked is found all the same. Threads: const functions from any, at once.
class LampTexture {
  public:
    enum class Domain : std::uint8_t { kTriangle, kSquare };

    // What is looked at: the mean of the channels of what shines at a point of the domain, >= 0,
    // and the lamp's area there over its mean, where that is not the same all over.
    struct Look {
        double radiance = 0, area = 1;
    };
    struct Lamp {
        Domain domain = Domain::kTriangle;
        double texels = 1;  // along the domain's longest side
        std::size_t mostLooks = 1 << 24;
        // Called from many threads at once. step: between places where texels are finer than places
        // are dense, so that each stands for what is around it; else 0.
        std::function<Look(Vec2f, float step)> look;
    };

    // One that shows nothing.
    LampTexture() = default;

    // Looks in parallel in the calling TBB arena. Throws Error(kCancelled) soon after cancel is
    // set.
    explicit LampTexture(const Lamp& lamp, const CancelCheck& cancel = {});

    // The same all over, or nearly: nothing to choose by, every density is 1.
    bool isEven() const { return m_nodes.empty(); }
    // Of the radiance over the lamp's area.
    double mean() const { return m_mean; }

    // A point of the domain for two random numbers; its density times the domain's area, > 0.
    Vec2f sample(Vec2f u, float& density) const;
    float density(Vec2f point) const;

    std::uint64_t memoryBytes() const { return m_nodes.size() * sizeof(Node); }

    // Of one lamp; cells that show least are left whole where it would have more.
    static constexpr std::size_t kMostNodes = 1 << 18;

  private:
    struct Node {
        float upTo[3];           // shares of the first one, two, three of its four parts
        std::uint32_t parts[4];  // their numbers plus 1; 0: not divided

        std::size_t partAt(double u) const {
            return (u >= begin(1) ? 1 : 0) + (u >= begin(2) ? 1 : 0) + (u >= begin(3) ? 1 : 0);
        }
        double begin(std::size_t i) const { return i > 0 ? static_cast<double>(upTo[i - 1]) : 0; }
        double share(std::size_t i) const { return (i < 3 ? begin(i + 1) : 1.0) - begin(i); }
    };
    class Builder;

    Domain m_domain = Domain::kTriangle;
    std::vector<Node> m_nodes;  // the root comes last
    double m_mean = 0;
};

}  // namespace pm
