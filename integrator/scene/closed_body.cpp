// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/scene/closed_body.h"

#include <algorithm>
#include <cstdint>
#include <tuple>
#include <vector>

namespace pm {

namespace {

using Key = std::tuple<double, double, double>;

// An edge between two corners, the lesser first, and which way a triangle passes it.
struct Edge {
    Key a, b;
    int way;
};

}  // namespace

BodyShape lookAtBody(
    const std::function<void(const std::function<void(const std::array<Vec3d, 3>&)>&)>& forEach,
    const CancelCheck& cancel) {
    BodyShape body;
    std::vector<Edge> edges;
    Vec3d origin;
    forEach([&](const std::array<Vec3d, 3>& corners) {
        if (edges.empty()) origin = corners[0];
        body.volume +=
            dot(corners[0] - origin, cross(corners[1] - origin, corners[2] - origin)) / 6;
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3d &p = corners[i], &q = corners[(i + 1) % 3];
            // Adding 0 makes one of both zeros.
            const Key a{p.x + 0.0, p.y + 0.0, p.z + 0.0}, b{q.x + 0.0, q.y + 0.0, q.z + 0.0};
            if (a < b) edges.push_back({a, b, 1});
            if (b < a) edges.push_back({b, a, -1});
        }
    });
    cancel.throwIfSet("looking for open glass");
    std::ranges::sort(edges, {}, [](const Edge& e) { return std::tie(e.a, e.b); });
    for (std::size_t i = 0; i < edges.size();) {
        int sum = 0;
        const Edge& first = edges[i];
        for (; i < edges.size() && edges[i].a == first.a && edges[i].b == first.b; ++i)
            sum += edges[i].way;
        if (sum != 0) ++body.openEdges;
    }
    return body;
}

}  // namespace pm
