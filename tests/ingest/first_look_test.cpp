// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Where a camera stands that nobody placed: in rooms, and where much is seen of what is no room.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "host_shim/look/framing.h"
#include "host_shim/look/outside_view.h"
#include "host_shim/look/room_view.h"

namespace pm::host::test {
namespace {

using Point = std::array<double, 3>;

// Builds scenes of quads.
class Maker {
  public:
    Maker() {
        m_scene.materials.resize(2);
        m_scene.materials[1].emission = {1, 1, 1};
        m_mesh.slotMaterials = {0, 1};
        m_scene.bounds = {{1e30, 1e30, 1e30}, {-1e30, -1e30, -1e30}};
    }
    void quad(std::initializer_list<Point> corners, std::uint32_t slot = 0) {
        for (const Point& corner : corners) {
            m_mesh.indices.push_back(static_cast<std::uint32_t>(m_mesh.positions.size() / 3));
            for (std::size_t axis = 0; axis < 3; ++axis) {
                m_mesh.positions.push_back(static_cast<float>(corner[axis]));
                m_scene.bounds.low[axis] = std::min(m_scene.bounds.low[axis], corner[axis]);
                m_scene.bounds.high[axis] = std::max(m_scene.bounds.high[axis], corner[axis]);
            }
        }
        m_mesh.faceSizes.push_back(static_cast<std::uint32_t>(corners.size()));
        m_mesh.faceSlots.push_back(slot);
    }
    // Sides -x, +x, -y, +y, -z, +z of a box; fronts are outside, or inside.
    void box(const Point& a, const Point& b, bool inward = false, int without = -1) {
        const auto [x0, y0, z0] = a;
        const auto [x1, y1, z1] = b;
        const std::array<std::array<Point, 4>, 6> sides{{
            {{{x0, y0, z0}, {x0, y0, z1}, {x0, y1, z1}, {x0, y1, z0}}},
            {{{x1, y0, z1}, {x1, y0, z0}, {x1, y1, z0}, {x1, y1, z1}}},
            {{{x0, y0, z0}, {x1, y0, z0}, {x1, y0, z1}, {x0, y0, z1}}},
            {{{x0, y1, z1}, {x1, y1, z1}, {x1, y1, z0}, {x0, y1, z0}}},
            {{{x1, y0, z0}, {x0, y0, z0}, {x0, y1, z0}, {x1, y1, z0}}},
            {{{x0, y0, z1}, {x1, y0, z1}, {x1, y1, z1}, {x0, y1, z1}}},
        }};
        for (int side = 0; side < 6; ++side) {
            if (side == without) continue;
            const auto& s = sides[static_cast<std::size_t>(side)];
            if (inward)
                quad({s[3], s[2], s[1], s[0]});
            else
                quad({s[0], s[1], s[2], s[3]});
        }
    }
    void lampBelow(const Point& at, double half) {
        quad({{at[0] - half, at[1], at[2] - half},
              {at[0] + half, at[1], at[2] - half},
              {at[0] + half, at[1], at[2] + half},
              {at[0] - half, at[1], at[2] + half}},
             1);
    }
    OccupancyGrid grid() const { return OccupancyGrid(scene()); }
    SceneData scene() const {
        SceneData made = m_scene;
        made.meshes = {m_mesh};
        made.placeEachMesh();
        return made;
    }

  private:
    SceneData m_scene;
    MeshData m_mesh;
};

void expectInside(const std::optional<ViewPoint>& view, const Point& low, const Point& high) {
    ASSERT_TRUE(view.has_value());
    for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_GT(view->eye[axis], low[axis]) << axis;
        EXPECT_LT(view->eye[axis], high[axis]) << axis;
    }
    EXPECT_DOUBLE_EQ(view->eye[1], view->lookAt[1]) << "level";
}

// Cosine between the view and a direction.
double along(const ViewPoint& view, const Point& direction) {
    double dot = 0, squared = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double d = view.lookAt[axis] - view.eye[axis];
        dot += d * direction[axis];
        squared += d * d;
    }
    return std::abs(dot) / std::sqrt(squared);
}

TEST(RoomView, standsInAClosedRoomAndLooksAlongIt) {
    Maker maker;
    maker.box({-6, 0, -1}, {6, 2.5, 1}, true);
    const auto view = viewOfRoom(maker.grid());
    expectInside(view, {-6, 0, -1}, {6, 2.5, 1});
    EXPECT_GT(along(*view, {1, 0, 0}), 0.95);
    // From one end: what is looked at lies at the other.
    EXPECT_GT(std::abs(view->eye[0]), 4);
    EXPECT_LT(view->eye[0] * view->lookAt[0], 0);
}

// Walls of one sheet whose fronts are outside, a lamp in it: from outside all would be black.
TEST(RoomView, goesWhereTheLampsShine) {
    Maker maker;
    maker.box({0, 0, 0}, {4, 3, 4});
    EXPECT_FALSE(viewOfRoom(maker.grid())) << "a box";
    maker.lampBelow({2, 2.99, 2}, 0.5);
    expectInside(viewOfRoom(maker.grid()), {0, 0, 0}, {4, 3, 4});
}

TEST(RoomView, takesTheLargestOfTheRoomsOfAHouse) {
    Maker maker;
    constexpr double t = 0.3;
    maker.box({0, 0, 0}, {10, t, 6});
    maker.box({0, 3, 0}, {10, 3 + t, 6});
    maker.box({0, t, 0}, {t, 3, 6});
    maker.box({10 - t, t, 0}, {10, 3, 6});
    maker.box({t, t, 0}, {10 - t, 3, t});
    maker.box({t, t, 6 - t}, {10 - t, 3, 6});
    maker.box({3, t, t}, {3 + t, 3, 4});
    maker.box({3, 2.2, 4}, {3 + t, 3, 6 - t});
    expectInside(viewOfRoom(maker.grid()), {3, t, t}, {10 - t, 3, 6 - t});
}

TEST(RoomView, aWindowDoesntMakeItAnOpenBox) {
    Maker maker;
    maker.box({0, 0, 0}, {5, 3, 4}, true, 1);
    maker.quad({{5, 0, 0}, {5, 0, 4}, {5, 1, 4}, {5, 1, 0}});
    maker.quad({{5, 2, 0}, {5, 2, 4}, {5, 3, 4}, {5, 3, 0}});
    maker.quad({{5, 1, 0}, {5, 1, 1}, {5, 2, 1}, {5, 2, 0}});
    maker.quad({{5, 1, 3}, {5, 1, 4}, {5, 2, 4}, {5, 2, 3}});
    expectInside(viewOfRoom(maker.grid()), {0, 0, 0}, {5, 3, 4});
}

TEST(RoomView, whatIsNoRoomIsSeenFromOutside) {
    for (int side = 0; side < 6; ++side) {
        Maker open;
        open.box({0, 0, 0}, {4, 3, 4}, true, side);
        open.lampBelow({2, 2.99, 2}, 0.5);
        EXPECT_FALSE(viewOfRoom(open.grid())) << "open at side " << side;
    }
    Maker blocks;
    blocks.box({0, 0, 0}, {1, 1, 1});
    blocks.box({3, 0, 0}, {4, 2, 1});
    EXPECT_FALSE(viewOfRoom(blocks.grid()));
    Maker house;  // on a ground that is wider
    house.box({0, 0, 0}, {4, 3, 4});
    house.quad({{-9, 0, 9}, {9, 0, 9}, {9, 0, -9}, {-9, 0, -9}});
    EXPECT_FALSE(viewOfRoom(house.grid()));
    EXPECT_FALSE(viewOfRoom(OccupancyGrid(SceneData{})));
}

// What the grid says of a large scene that is far from the origin is the same.
TEST(RoomView, isTheSameAtAnyScaleAndPlace) {
    for (const double scale : {1e-6, 1.0, 4096.0}) {
        Maker maker;
        maker.box({0, 0, 0}, {6 * scale, 2 * scale, 2 * scale}, true);
        SceneData scene = maker.scene();
        const Point offset{1e6 * scale, -2e6 * scale, 3e5 * scale};
        scene.centre = offset;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            scene.bounds.low[axis] += offset[axis];
            scene.bounds.high[axis] += offset[axis];
        }
        const auto view = viewOfRoom(OccupancyGrid(scene));
        ASSERT_TRUE(view);
        EXPECT_NEAR((view->eye[1] - offset[1]) / scale, 1, 0.2) << scale;
        EXPECT_GT(along(*view, {1, 0, 0}), 0.9) << scale;
    }
}

std::optional<Point> better(const Maker& maker) {
    const SceneData scene = maker.scene();
    const double fov = frameCamera({}, scene.bounds, 4.0 / 3).verticalFov;
    const Point front = frameCamera({}, scene.bounds, 4.0 / 3).eye;
    const auto view = betterView(maker.grid(), {front, scene.bounds, fov, 4.0 / 3});
    return view ? std::optional(view->eye) : std::nullopt;
}

TEST(OutsideView, theFrontIsKeptWhereItShowsTheScene) {
    Maker quad;
    quad.quad({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
    EXPECT_FALSE(better(quad));
    Maker open;
    open.box({0, 0, 0}, {4, 3, 4}, true, 5);
    EXPECT_FALSE(better(open)) << "a box that is open to the front";
    EXPECT_FALSE(better(Maker{}));
}

TEST(OutsideView, aGroundABlockAndAnOpenTopAreSeenFromAbove) {
    Maker hills;
    for (int i = 0; i < 20; ++i)
        for (int j = 0; j < 20; ++j) {
            const auto at = [](int x, int z) { return Point{0.0 + x, (x + z) % 3 * 0.2, 0.0 + z}; };
            hills.quad({at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)});
        }
    Maker block, open;
    block.box({0, 0, 0}, {1, 1, 1});
    open.box({0, 0, 0}, {4, 3, 4}, true, 3);
    for (const Maker* maker : {&hills, &block, &open}) {
        const auto eye = better(*maker);
        ASSERT_TRUE(eye);
        EXPECT_GT((*eye)[1], maker->scene().bounds.high[1]);
    }
}

// A chair's seat and legs on a ground, z up and y up; a relief on a wall; a box in a corner.
TEST(OutsideView, zIsUpWhereTheSceneStandsOnIt) {
    const auto stands = [](const Maker& maker) {
        return standsOnZ(maker.grid(), maker.scene().bounds);
    };
    Maker zUp, yUp, above, relief, corner, tower;
    zUp.box({-0.5, -0.5, 0}, {0.5, 0.5, 1.2});
    zUp.quad({{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}});
    EXPECT_TRUE(stands(zUp));
    tower.box({-5, -5, 0}, {5, 5, 1});
    tower.box({-2, -2, 1}, {2, 2, 80});
    EXPECT_TRUE(stands(tower));
    yUp.box({-0.5, 0, -0.5}, {0.5, 1.2, 0.5});
    yUp.quad({{-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}});
    EXPECT_FALSE(stands(yUp));
    above.box({-0.5, -0.5, 1}, {0.5, 0.5, 2.2});
    above.quad({{-2, -2, 1}, {2, -2, 1}, {2, 2, 1}, {-2, 2, 1}});
    EXPECT_FALSE(stands(above)) << "not on z = 0";
    relief.box({-0.5, -0.5, 0}, {0.5, 0.5, 0.1});
    relief.quad({{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}});
    EXPECT_FALSE(stands(relief));
    corner.quad({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}});
    corner.quad({{0, 0, 0}, {0, 0, 2}, {2, 0, 2}, {2, 0, 0}});
    EXPECT_FALSE(stands(corner));
    const Point place{1, 2, 3};
    EXPECT_EQ(backToZUp(asIfYWereUp(place)), place);
    EXPECT_EQ(asIfYWereUp(Point{0, 0, 1}), (Point{0, 1, 0}));
}

TEST(OutsideView, anOpenSideIsLookedInto) {
    Maker right, left;
    right.box({0, 0, 0}, {4, 3, 4}, true, 1);
    left.box({0, 0, 0}, {4, 3, 4}, true, 0);
    ASSERT_TRUE(better(right) && better(left));
    EXPECT_GT((*better(right))[0], 4);
    EXPECT_LT((*better(left))[0], 0);
}

TEST(OutsideView, allCornersAreInThePicture) {
    const Bounds bounds{{-1, 0, -3}, {2, 5, 1}};
    for (const double aspect : {0.5, 1.0, 3.0}) {
        CameraOptions options;
        options.eye = eyeFrom({0.7, 0.5, -1}, bounds, 0.7, aspect);
        const CameraPose pose = frameCamera(options, bounds, aspect);
        double most = 0;
        for (unsigned corner = 0; corner < 8; ++corner) {
            Point local{};
            for (std::size_t row = 0; row < 3; ++row) {
                const double off =
                    ((corner >> row & 1) != 0 ? bounds.high : bounds.low)[row] - pose.eye[row];
                for (std::size_t column = 0; column < 3; ++column)
                    local[column] += pose.transform[row * 4 + column] * off;
            }
            ASSERT_LT(local[2], 0);
            const double tangent = std::tan(0.35) * -local[2];
            most = std::max(
                {most, std::abs(local[0]) / tangent / aspect, std::abs(local[1]) / tangent});
        }
        EXPECT_NEAR(most, 1 / 1.05, 1e-9);
    }
}

// All points, and no more: left and right, or above and below, they reach the margin.
TEST(OutsideView, allIsJustInThePicture) {
    const std::array<Point, 5> points{
        {{1e5, 0, -3}, {1e5 + 2, 5, 1}, {1e5 - 1, 0, 1}, {1e5, 4, 4}, {1e5 + 1, 1, 0}}};
    for (const Point& direction : {Point{0.7, 0.5, -1}, Point{0, 0, 1}, Point{-1, 0, 0}})
        for (const double aspect : {0.5, 1.0, 3.0}) {
            const ViewPoint view = viewOf(points, direction, 0.7, aspect);
            CameraOptions options;
            options.eye = view.eye;
            options.lookAt = view.lookAt;
            const CameraPose pose = frameCamera(options, Bounds{}, aspect);
            std::array<double, 2> low{2, 2}, high{-2, -2};
            for (const Point& point : points) {
                Point local{};
                for (std::size_t row = 0; row < 3; ++row)
                    for (std::size_t column = 0; column < 3; ++column)
                        local[column] +=
                            pose.transform[row * 4 + column] * (point[row] - pose.eye[row]);
                ASSERT_LT(local[2], 0);
                const double tangent = std::tan(0.35) * -local[2];
                for (const std::size_t i : {0u, 1u}) {
                    const double at = local[i] / tangent / (i == 0 ? aspect : 1);
                    low[i] = std::min(low[i], at);
                    high[i] = std::max(high[i], at);
                }
            }
            const std::size_t tight = high[0] - low[0] > high[1] - low[1] ? 0 : 1;
            EXPECT_NEAR(high[tight], 1 / 1.05, 1e-6) << aspect;
            EXPECT_NEAR(low[tight], -1 / 1.05, 1e-6) << aspect;
            EXPECT_LE(std::max(high[1 - tight], -low[1 - tight]), 1 / 1.05 + 1e-6) << aspect;
        }
    const std::array<Point, 1> single{{{1, 2, 3}}};
    EXPECT_EQ(viewOf(single, {0, 0, 1}, 0.7, 1).lookAt, single[0]);
}

// Floor, ceiling and back wall, all of some thickness, and blocks between them; or with sides and
// boards as well. Open to +z, turned to one side or another.
Maker shelf(std::size_t axis, double sign, bool isCase) {
    Maker maker;
    const auto box = [&](Point a, Point b) {
        if (sign < 0) {
            std::swap(a[2], b[2]);
            a[2] = -a[2];
            b[2] = -b[2];
        }
        std::swap(a[axis], a[2]);
        std::swap(b[axis], b[2]);
        maker.box(a, b);
    };
    const double high = isCase ? 30 : 5;
    box({-25, -high - 0.05, -12.5}, {25, -high + 0.05, 12.5});
    box({-25, high - 0.05, -12.5}, {25, high + 0.05, 12.5});
    box({-25, -high, -12.55}, {25, high, -12.45});
    for (const double x : {-18.0, -6.0, 6.0, 18.0}) box({x - 1, -4, -1}, {x + 1, -2, 1});
    for (const double y : {-10.0, 10.0})
        if (isCase) box({-25, y - 0.05, -12.5}, {25, y + 0.05, 12.5});
    for (const double x : {-25.0, 25.0})
        if (isCase) box({x - 0.05, -high, -12.5}, {x + 0.05, high, 12.5});
    return maker;
}

TEST(OutsideView, shelvesAreSeenFromTheirOpenSide) {
    for (const bool isCase : {false, true})
        for (const std::size_t axis : {0u, 1u, 2u})
            for (const double sign : {-1.0, 1.0}) {
                if (axis == 1 && sign < 0) continue;  // from below nothing is seen
                const Maker maker = shelf(axis, sign, isCase);
                const SceneData scene = maker.scene();
                const CameraPose front = frameCamera({}, scene.bounds, 4.0 / 3);
                const Point at = better(maker).value_or(front.eye);
                EXPECT_GT(sign * at[axis], 12.5) << isCase << axis << sign;
                if (axis != 1) {
                    EXPECT_NEAR(at[1], 0, 1) << isCase << axis << sign;
                }
            }
}

}  // namespace
}  // namespace pm::host::test
