// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/rays/ray_device.h"
#include "integrator/rays/shared_mesh.h"
#include "integrator/rays/user_shapes.h"

namespace pm {

struct SharedMesh::Impl {
    std::shared_ptr<RayDevice> device;
    RTCScene scene = nullptr;
    RimTriangles rim;  // Embree keeps a pointer to it
    std::uint64_t bytes = 0;

    ~Impl() {
        if (scene) rtcReleaseScene(scene);
    }
};

// Attaches what is intersected by functions of ours; shape must outlive the scene. Returns the
// geometry's number. Functions: where those for Embree are.
template <typename Kind, typename Functions = UserGeometry<Kind>>
std::uint32_t attachUserGeometry(RTCDevice device, RTCScene scene, Kind& shape,
                                 std::size_t primitives, Viewers seenBy = kAllRays) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<std::uint32_t>(primitives));
    rtcSetGeometryUserData(geometry, &shape);
    rtcSetGeometryBoundsFunction(geometry, Functions::bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry, Functions::intersect);
    rtcSetGeometryOccludedFunction(geometry, Functions::occluded);
    rtcSetGeometryMask(geometry, seenBy);
    rtcCommitGeometry(geometry);
    const std::uint32_t id = rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    return id;
}

}  // namespace pm
