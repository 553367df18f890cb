// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "integrator/lights/environment.h"
#include "integrator/lights/lamp_texture.h"
#include "integrator/lights/lamp_triangle.h"
#include "integrator/lights/light.h"
#include "integrator/materials/absorption.h"
#include "integrator/materials/material_traits.h"
#include "integrator/materials/materials.h"
#include "integrator/rays/ray_tracer.h"
#include "integrator/scene/scene_core.h"
#include "integrator/scene/scene_description.h"
#include "integrator/shapes/bump_map.h"
#include "integrator/shapes/ray_footprint.h"
#include "integrator/shapes/smooth_point.h"
#include "integrator/shapes/surface.h"
#include "integrator/tessellation/limit_groups.h"
#include "integrator/values/notice.h"

namespace pm {

// A scene as it is rendered: immutable, moved to its own centre, ray-tracing structure built. Its
// own coordinates are world coordinates minus centre(), in float. The centre is the middle of all
// shapes, or of its core, where a few lie far away from that (see findCore). Threads: all const
// functions from any, at once.
class Scene {
  public:
    // isa: see RayTracer. Builds in parallel in the calling TBB arena. Throws Error (kInvalidScene,
    // kUnsupported, kOutOfMemory; kCancelled soon after cancel is set).
    static std::shared_ptr<const Scene> build(SceneDescription description, const std::string& isa,
                                              const CancelCheck& cancel = {});
    ~Scene();

    // footprint: of the ray, becomes that at the surface, whose textures are looked up by it. Null,
    // or one that is not known: they are looked up at their finest level.
    bool intersect(const Ray& ray, Surface& surface, RayFootprint* footprint = nullptr) const;
    // The same of the shape alone: no texture is looked up, to turn the shading normal.
    bool meet(const Ray& ray, Surface& surface) const;
    // By anything that any ray meets.
    bool occluded(Ray ray) const {
        const CacheWatch::As as(CacheUser::kShadow);
        ray.viewer = kAllRays;
        return m_tracer.occluded(ray);
    }
    // Share of radiance that goes straight along a ray from tMax to its origin: what cut-outs,
    // half-transparent sheets and glass that bends nothing let through, and what the media on it
    // leave. All that the ray crosses counts once, faces that rays can't tell apart as one. What
    // bends light lets none through. In [0, 1] a channel but where both ends are in unlike media.
    Rgb transmittance(const Ray& ray) const;
    // The same of one surface, where a ray along `direction` meets it; black where none goes on.
    Rgb straightShare(const Surface& surface, const Vec3f& direction) const;

    // The point of the curved surface that a triangle with normals stands for, over a point of the
    // triangle, and the normal there, on the same side as `side`. False: it stands for itself.
    bool smoothPoint(const Surface& surface, const Vec3f& side, SmoothPoint& smooth) const;

    // The same as a ray that starts at `origin`, any distance away, along the unit direction; but
    // it starts where it comes near the core, where nothing is in between: a float far away has no
    // digits left for what it meets there.
    Ray rayFromAfar(const Vec3d& origin, const Vec3d& direction) const;

    // World space: min x, y, z, max x, y, z.
    const std::array<double, 6>& bounds() const { return m_bounds; }
    const Vec3d& centre() const { return m_centre; }
    // Radius of a sphere around the origin of the scene's own coordinates that holds all shapes.
    double radius() const { return m_radius; }
    // The same without what lies far away from the core; radius() without a core.
    double coreRadius() const { return m_coreRadius; }
    bool hasCore() const { return m_coreRadius < m_radius; }
    // For PhotonMap: infinity without a core.
    float coreRadiusIfAny() const {
        return hasCore() ? static_cast<float>(m_coreRadius)
                         : std::numeric_limits<float>::infinity();
    }
    // What the roundings of a place and its surroundings go by: radius(), or with a core how far
    // from the origin they may be.
    float roundingRadius(const Vec3f& position) const {
        if (!hasCore()) return static_cast<float>(m_radius);
        return std::max(static_cast<float>(m_coreRadius), std::sqrt(lengthSquared(position)));
    }
    // Half the size of the box around the origin that holds all shapes, along the axes.
    const Vec3d& halfSize() const { return m_halfSize; }

    const SceneDescription& description() const { return m_description; }
    const Materials& materials() const { return m_materials; }
    // What is left of light that came to a surface by a ray: less than 1 inside of what absorbs.
    Rgb leftAlong(const Ray& ray, const Surface& surface) const {
        if (!m_absorbs) return Rgb(1.0f);
        if (m_media) return leftIn(surface.medium, length(surface.position - ray.origin));
        return leftOnTheWay(m_materials[surface.material], surface, ray);
    }
    const MaterialDescription& material(std::uint32_t index) const {
        return m_description.materials[index];
    }
    const MaterialTraits& traits(std::uint32_t material) const { return m_traits[material]; }
    const TextureSource* textures() const { return m_description.textures.get(); }
    // Those that are infinitely far come last.
    const std::vector<Light>& lights() const { return m_lights; }
    std::span<const Light> nearLights() const { return {m_lights.data(), m_nearLightCount}; }
    std::span<const Light> farLights() const {
        return std::span(m_lights).subspan(m_nearLightCount);
    }
    // Whether a light is an environment; and the one that there is then.
    bool hasEnvironment() const { return m_environment != nullptr; }
    const Environment& environment() const { return *m_environment; }

    // Radiance of the environment that there is, W m^-2 sr^-1, along a unit direction from that
    // side of a surface to which `normal` points; black where something is in the way.
    Rgb skyRadiance(const Surface& from, const Vec3f& normal, const Vec3f& direction) const;
    // Whether a ray that meets nothing sees light.
    bool seesFarLight(const Vec3f& direction) const;

    // How far off its surface what was stored as a point of it has to be for no ray to meet that
    // surface there. Scene units.
    float liftOfPoints(const Vec3f& position) const {
        constexpr float kRoundings = 36.0f * 0x1p-24f;
        return kRoundings * roundingRadius(position);
    }
    // A hit's place as it is kept, and a ray onwards from there: by a height of which half is still
    // off the surface. ray: that led to the hit; normal: on its side.
    Vec3f pointUnderRay(const Vec3f& position, const Ray& ray, const Vec3f& normal) const {
        return pm::pointUnderRay(position, ray, normal, 2.0f * liftOfPoints(position));
    }
    Ray rayOnwards(const Vec3f& position, const Vec3f& normal, const Vec3f& direction,
                   float time = 0.0f) const {
        return pm::rayOnwards(position, normal, direction, 2.0f * liftOfPoints(position), time);
    }

    // Whether some material has a texture that is filtered, so that footprints are worth their
    // time.
    bool filtersTextures() const { return m_filtersTextures; }
    // Of a ray that leaves a surface or a light as one of many, along a unit direction. Not known
    // where there is nothing to filter. width: where it starts, scene units.
    RayFootprint coneAround(const Vec3f& direction, float width = 0.0f) const {
        return m_filtersTextures ? RayFootprint::cone(direction, RayFootprint::kWidest, width)
                                 : RayFootprint{};
    }

    // True when all that reflects or lets light through are triangles in one plane (to rounding),
    // so that no light goes from one surface by way of another.
    bool isFlat() const { return m_isFlat; }

    // Whether shadow rays and others that leave a surface may meet different things there: then
    // lamps that a lobe leads to are to be looked for beside what else its ray meets, see
    // lightAlong().
    bool viewersDiffer() const { return m_viewersDiffer; }
    bool isHiddenFrom(std::uint32_t shape, Viewers viewer) const {
        return (m_description.instances[shape].hiddenFrom & viewer) != 0;
    }

    // Whether rays meet a mesh, used several times, where its instances have it.
    bool hasInstances() const { return m_hasInstances; }

    // Whether something in it isSheet(): photons may lie on two surfaces that are as close as can
    // be.
    bool hasSheets() const { return m_hasSheets; }

    // A point on an area light's primitive, uniform over its area, as a Surface.
    Surface pointOnLight(const SurfaceLight& light, Vec2f u) const;
    Surface pointOnLight(const Light& light, Vec2f u) const {
        return pointOnLight(*light.surface(), u);
    }
    // The same, chosen by what the light's texture shows; density: times the light's area.
    Surface pointOnLight(const SurfaceLight& light, Vec2f u, float& density) const;
    // That density at any point of the light; 1 of a light that shines evenly.
    float lampDensity(const SurfaceLight& light, const Surface& point) const;
    // Null of a light that shines evenly.
    const LampTexture* lampTexture(const SurfaceLight& light) const {
        return light.shinesEvenly() ? nullptr
                                    : &m_lampTextures[static_cast<std::size_t>(light.texture)];
    }
    // Radiance of a material's front, W m^-2 sr^-1, >= 0.
    // footprint: over which it is the mean; without sides, at the finest level.
    Rgb emission(std::uint32_t material, Vec2f uv, const UvFootprint& footprint = {}) const;
    // That is not exceeded anywhere.
    Rgb mostEmission(std::uint32_t material) const;
    // The point of a sphere shape that lies in a direction (of any length) from its centre.
    Surface pointOnSphere(std::uint32_t shape, const Vec3d& direction) const;
    // Of the light of that number; says no of one that is no triangle, has a texture, or is
    // intersected in double.
    const LampTriangle& lampTriangle(std::size_t light) const { return m_lampTriangles[light]; }
    // The sphere of a sphere light, scene's own coordinates.
    SphereShape sphere(std::uint32_t shape) const;
    // Of a shape that is no mesh: whether it is a sphere, and a ball that holds it, which then is
    // that.
    bool isSphere(std::uint32_t shape) const;
    // Balls that together hold a shape that is no mesh, one after another.
    std::uint32_t partCount(std::uint32_t shape) const;
    SphereShape ballAroundPart(std::uint32_t shape, std::uint32_t part) const;
    SphereShape ballAround(std::uint32_t shape) const;

    const std::vector<Notice>& notices() const { return m_notices; }
    const std::string& isa() const { return m_tracer.isa(); }
    std::uint64_t memoryBytes() const;
    std::uint64_t describedBytes() const;
    // Of the triangles that limit surfaces are cut into where rays meet them: what may be held at
    // once, and what would be held if all were. The picture is the same. Threads: any.
    void setGroupBudget(std::uint64_t bytes) const {
        if (m_groupCache) m_groupCache->setBudget(bytes);
    }
    // Null where nothing is cut on demand.
    const GroupCache* groupCache() const { return m_groupCache.get(); }
    std::uint64_t groupBudget() const { return m_groupCache ? m_groupCache->budget() : 0; }
    std::uint64_t groupBytes() const { return m_groupBytes; }
    CacheCounts groupCounts() const {
        return m_groupCache ? m_groupCache->counts() : CacheCounts{};
    }
    std::uint64_t triangleCount() const { return m_triangleCount; }
    // Mean over the triangles, scene units squared; 0 of none.
    double meanTriangleArea() const {
        return m_triangleCount > 0 ? m_triangleArea / static_cast<double>(m_triangleCount) : 0.0;
    }

  private:
    struct ShapeRecord;
    class Builder;
    class CoincidentFaces;
    class Media;
    Scene(SceneDescription description, const std::string& isa, const CancelCheck& cancel);

    // A triangle's first vertex and the edges from it.
    struct Corner {
        Vec3d vertex, e1, e2;
    };
    struct Facet;
    struct Attributes;
    // A ray that meets a surface, and its footprint, null where nobody asks for it.
    struct Arrival {
        const Ray* ray;
        RayFootprint* footprint;
        bool ofShapeOnly;  // no texture turns the shading normal
    };
    // Sets centre and bounds.
    void place(const Box3d& whole, const std::optional<Box3d>& core);
    bool findFlat(const CancelCheck& cancel) const;
    // The face that the ray meets first, whatever is on its sides.
    bool findFace(Surface& surface, const Arrival& arrival) const;
    // What is left of light on a way through a medium.
    Rgb leftIn(std::int32_t medium, float way) const {
        return medium == kNoMedium
                   ? Rgb(1.0f)
                   : leftAfter(m_materials[static_cast<std::uint32_t>(medium)], way);
    }
    // What its ray meets.
    bool find(Surface& surface, const Arrival& arrival) const;
    // Of that, shape and all else but isPane.
    void surfaceAt(const RayHit& hit, Surface& surface, const Arrival& arrival) const;
    float openShare(const Ray& ray, const RayHit& hit) const;
    // Where textures are looked up at a hit, without the rest of the surface.
    TextureContext contextAt(const Ray& ray, const RayHit& hit) const;
    // Whether a straight way may go on through glass.
    bool mayEnter(const RayHit& hit) const;
    class StraightWay;
    bool areOne(const Ray& ray, const RayHit& crossing, const RayHit& next) const;
    void surfaceOnTriangle(const ShapeRecord& shape, std::uint32_t primitive, const Corner& corner,
                           double b1, double b2, Surface& surface,
                           const Arrival& arrival = {nullptr, nullptr, false}) const;
    void footprintOnTriangle(const MaterialTraits& material, const Attributes& attributes,
                             const Corner& corner, Vec2f at, const Arrival& arrival,
                             Surface& surface) const;
    void footprintOnCurved(const ShapeRecord& shape, const Arrival& arrival,
                           Surface& surface) const;
    // Makes a shape's tangents where its materials ask for them; gives notice of what has none.
    void prepareMaps(ShapeRecord& shape, const InstanceDescription& instance,
                     const CancelCheck& cancel);
    // Turns the shading normal by the material's maps, and sets the tangent where it is asked for.
    // footprint: over which maps are looked up.
    void applyMaps(const ShapeRecord& shape, std::uint32_t primitive, const Attributes& attributes,
                   const TexturedEdges& edges, Vec2f barycentric, const UvFootprint& footprint,
                   Surface& surface) const;
    void turnByNormalMap(const MaterialDescription& material, const Vec3f& tangent,
                         float normalLength, const UvFootprint& footprint, Surface& surface) const;
    void turnByBumpMap(const MaterialDescription& material, const TexturedEdges& edges,
                       const UvFootprint& footprint, Surface& surface) const;
    static float smoothness(const Attributes& attributes, Vec2f barycentric,
                            const Surface& surface);
    // All that decide what a material emits where; and whether one is of its radiance.
    std::vector<std::int32_t> texturesOfEmission(std::uint32_t material) const;
    bool isOfEmission(std::int32_t texture) const;
    // Of a texture of lights; gives notice the first time.
    bool findBadTexels(std::int32_t texture, const CancelCheck& cancel);
    // Whether the texture alone says that it is black between uv.
    bool isKnownBlack(std::uint32_t material, std::span<const Vec2f> uv) const;
    LampTexture lookAtLamp(const SurfaceLight& light, std::size_t mostLooks,
                           const CancelCheck& cancel) const;
    // For the powers of textured lamps, and where on them light is.
    void lookAtTextures(const CancelCheck& cancel);
    // Which surface it is.
    static void nameSurface(const ShapeRecord& shape, std::uint32_t primitive, Surface& surface);

    SceneDescription m_description;
    std::vector<MaterialTraits> m_traits;  // of the materials
    MaterialTables m_tables;
    Materials m_materials{m_description.materials, m_description.textures.get(), &m_tables};
    std::vector<std::unique_ptr<const HeightField>> m_heights;  // of the materials that displace
    std::vector<ShapeRecord> m_shapes;
    std::unique_ptr<GroupCache> m_groupCache;  // null where nothing is cut on demand
    std::uint64_t m_groupBytes = 0;
    std::vector<Light> m_lights;
    std::vector<LampTriangle> m_lampTriangles;  // of the lights
    std::vector<LampTexture> m_lampTextures;
    std::vector<bool> m_hasBadTexels;  // of the textures of lights, by their numbers
    std::size_t m_nearLightCount = 0;
    std::unique_ptr<const Environment> m_environment;
    std::vector<Notice> m_notices;
    Vec3d m_centre;
    Vec3d m_halfSize;
    std::array<double, 6> m_bounds{};
    double m_radius = 0, m_coreRadius = 0;
    std::uint64_t m_triangleCount = 0;
    double m_triangleArea = 0;  // of all
    bool m_isFlat = false, m_hasSheets = false;
    bool m_letsThrough = false;  // some material does
    bool m_hasThinWalls = false;
    bool m_filtersTextures = false;
    bool m_absorbs = false;  // some material does
    bool m_hasInstances = false, m_viewersDiffer = false;
    RayTracer m_tracer;  // last: it refers to the shapes' arrays and is destroyed before them
    std::unique_ptr<const CoincidentFaces> m_coincident;  // null where there are none
    std::unique_ptr<const Media> m_media;                 // null where faces say all
};

}  // namespace pm
