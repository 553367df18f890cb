// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Where a scene lies, how large it is, and from where it is seen.
#include <cmath>
#include <numbers>

#include "tests/bench/stability/sweep.h"
#include "tests/bench/stability/sweep_look.h"
#include "tests/support/rooms.h"

namespace pm::bench {

namespace {

// A closed room of width 2, with a lamp close under its ceiling, a ball of glass and one of grey.
test::SceneMaker closedRoom() {
    test::SceneMaker maker;
    const auto grey = maker.diffuse(Rgb(0.5f));
    maker.box({-1, -1, -1}, {1, 1, 1}, grey, true);
    maker.quad({-0.3, 0.99, -0.3}, {0.6, 0, 0}, {0, 0, 0.6}, maker.diffuse({}, Rgb(10.0f)));
    maker.sphere({0.4, -0.6, -0.3}, 0.25, maker.material(test::glass()));
    maker.meshSphere({-0.4, -0.7, -0.2}, 0.3, grey, false, 8);
    maker.camera({0, 0, 0.9}, {0, -0.1, 0}, {0, 1, 0}, 60);
    return maker;
}

Sweep moved(IntegratorKind integrator) {
    Sweep sweep{.kind = "placement", .name = "moved", .variant = nameOf(integrator)};
    sweep.parameter = "moved by, room widths / 2";
    sweep.values = decades(0, 8);
    sweep.against = "a closed room with a lamp and glass, at the origin";
    sweep.reported = "pbrt-v3#265";
    sweep.measure = [=](double by, std::uint64_t seed) {
        return look(placed(closedRoom(), 1, Vec3d{1, 0.7, -0.4} * by), {integrator, seed}).beauty;
    };
    sweep.wellAt = 0;
    return sweep;
}

Sweep scaled(IntegratorKind integrator) {
    Sweep sweep{.kind = "placement", .name = "scaled", .variant = nameOf(integrator)};
    sweep.parameter = "scale";
    sweep.values = decades(-6, 6);
    sweep.against = "the same room at scale 1";
    sweep.reported = "mitsuba3#1236, appleseed#2718";
    sweep.measure = [=](double by, std::uint64_t seed) {
        return look(placed(closedRoom(), by, {}), {integrator, seed}).beauty;
    };
    sweep.wellAt = 1;
    return sweep;
}

// Moves the corners themselves, which are floats: by `by` and, if wanted, back again.
test::SceneMaker withCornersMoved(double by, bool back) {
    test::SceneMaker maker = closedRoom();
    const Vec3d offset = Vec3d(Vec3f(Vec3d{1, 0.7, -0.4} * by));
    const auto place = [&](const Vec3d& p) {
        const Vec3d moved = Vec3d(Vec3f(p + offset));
        return back ? moved - offset : moved;
    };
    for (InstanceDescription& instance : maker.description.instances)
        if (auto* const mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&instance.shape)) {
            TriangleMesh moved = **mesh;
            for (Vec3f& p : moved.positions) p = Vec3f(place(Vec3d(p)));
            *mesh = std::make_shared<const TriangleMesh>(std::move(moved));
        } else {
            Vec3d& centre = std::get<SphereShape>(instance.shape).centre;
            centre = place(centre);
        }
    Transform& camera = maker.description.camera->cameraToWorld;
    const Vec3d eye = place({camera[3], camera[7], camera[11]});
    camera[3] = eye.x;
    camera[7] = eye.y;
    camera[11] = eye.z;
    return maker;
}

Sweep cornersMoved(IntegratorKind integrator) {
    Sweep sweep{.kind = "placement", .name = "corners moved", .variant = nameOf(integrator)};
    sweep.parameter = "corners moved by, room widths / 2";
    sweep.isLong = integrator == IntegratorKind::kPhoton;
    // Beyond, the floats hold no room any more.
    sweep.values = decades(0, 6);
    sweep.against = "what the rounded corners make, moved back to the origin";
    sweep.measure = [=](double by, std::uint64_t seed) {
        return look(withCornersMoved(by, false), {integrator, seed}).beauty;
    };
    sweep.expected = [=](double by, std::uint64_t seed) {
        return look(withCornersMoved(by, true), {integrator, seed}).beauty;
    };
    return sweep;
}

Sweep farObject(IntegratorKind integrator) {
    Sweep sweep{.kind = "placement", .name = "one far object", .variant = nameOf(integrator)};
    sweep.parameter = "its distance, room widths / 2";
    sweep.values = decades(1, 9);
    sweep.against = "the room with an object 3 away";
    sweep.measure = [=](double far, std::uint64_t seed) {
        test::SceneMaker maker = closedRoom();
        maker.quad(Vec3d{far, -1, -1}, {0, 2, 0}, {0, 0, 2}, maker.diffuse(Rgb(0.5f)));
        return look(maker, {integrator, seed}).beauty;
    };
    sweep.wellAt = 3;
    return sweep;
}

// A camera so far from the middle of a ball of radius 1 that looks at it; what of the frame's
// height the ball takes.
void cameraAtBall(test::SceneMaker& maker, double distance, double share) {
    const double half = std::atan(std::tan(std::asin(1 / distance)) / share);
    maker.camera(Vec3d{2, 1, 2} * (distance / 3), {0, 0, 0}, {0, 1, 0},
                 2 * half * 180 / std::numbers::pi);
}

Sweep farCameraSeesADisc(bool isSphere) {
    Sweep sweep{.kind = "placement", .name = "far camera sees a disc"};
    sweep.variant = isSphere ? "sphere" : "mesh";
    sweep.parameter = "camera's distance, radii";
    sweep.values = {1.1, 10, 1e2, 1e3, 1e4, 1e5, 1e6};
    sweep.against = isSphere ? "share of the frame that a ball covers" : "the same from 100 radii";
    sweep.reported = "mitsuba3#512, pytracer#22";
    sweep.measure = [=](double distance, std::uint64_t seed) {
        test::SceneMaker maker;
        const auto shining = maker.diffuse({}, Rgb(1.0f));
        isSphere ? maker.sphere({}, 1, shining) : maker.meshSphere({}, 1, shining, false, 32);
        cameraAtBall(maker, distance, 0.8);
        return look(maker, {IntegratorKind::kPath, seed, 16, 4}).beauty;
    };
    sweep.expected = [](double, std::uint64_t) { return std::numbers::pi / 4 * 0.64; };
    if (isSphere) return sweep;
    // Near by, another part of the mesh is its rim.
    sweep.values = decades(2, 6);
    sweep.wellAt = 100;
    return sweep;
}

Sweep farCameraSeesTheSky(IntegratorKind integrator, bool isSphere) {
    Sweep sweep{.kind = "placement", .name = "far camera, ball under a sky"};
    sweep.variant = nameOf(integrator) + (isSphere ? ", sphere" : ", mesh");
    sweep.parameter = "camera's distance, radii";
    sweep.values = {1.1, 10, 1e2, 1e3, 1e4, 1e5, 1e6};
    sweep.against = "what a white ball reflects of an even sky: all";
    sweep.measure = [=](double distance, std::uint64_t seed) {
        test::SceneMaker maker;
        const auto white = maker.diffuse(Rgb(1.0f));
        isSphere ? maker.sphere({}, 1, white) : maker.meshSphere({}, 1, white, false, 64);
        maker.sky(Rgb(1.0f));
        cameraAtBall(maker, distance, 1.5);
        return look(maker, {integrator, seed}).beauty;
    };
    sweep.expected = [](double, std::uint64_t) { return 1.0; };
    return sweep;
}

}  // namespace

std::vector<Sweep> placementSweeps() {
    std::vector<Sweep> sweeps;
    for (const IntegratorKind integrator : kBoth) sweeps.push_back(moved(integrator));
    for (const IntegratorKind integrator : kBoth) sweeps.push_back(scaled(integrator));
    for (const IntegratorKind integrator : kBoth) sweeps.push_back(cornersMoved(integrator));
    for (const IntegratorKind integrator : kBoth) sweeps.push_back(farObject(integrator));
    for (const bool isSphere : {true, false}) sweeps.push_back(farCameraSeesADisc(isSphere));
    for (const IntegratorKind integrator : kBoth)
        for (const bool isSphere : {true, false})
            sweeps.push_back(farCameraSeesTheSky(integrator, isSphere));
    return sweeps;
}

}  // namespace pm::bench
