// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/support/scene_maker.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <numbers>

#include "integrator/geometry/polygon_mesh.h"

namespace pm::test {

std::uint32_t SceneMaker::material(const MaterialDescription& material) {
    description.materials.push_back(material);
    return static_cast<std::uint32_t>(description.materials.size() - 1);
}

std::uint32_t SceneMaker::diffuse(Rgb reflectance, Rgb emission) {
    MaterialDescription m;
    m.diffuse = reflectance;
    m.emission = emission;
    return material(m);
}

void SceneMaker::mesh(TriangleMesh mesh, std::uint32_t material) {
    mesh.materials.assign(mesh.triangles.size(), 0);
    mesh.faces.resize(mesh.triangles.size());
    InstanceDescription instance;
    instance.shape = std::make_shared<const TriangleMesh>(std::move(mesh));
    instance.materials = {material};
    description.instances.push_back(std::move(instance));
}

void SceneMaker::quad(Vec3d p, Vec3d e0, Vec3d e1, std::uint32_t material,
                      std::uint32_t divisions) {
    TriangleMesh mesh;
    const std::uint32_t n = divisions;
    for (std::uint32_t j = 0; j <= n; ++j)
        for (std::uint32_t i = 0; i <= n; ++i)
            mesh.positions.push_back(
                Vec3f(p + e0 * (static_cast<double>(i) / n) + e1 * (static_cast<double>(j) / n)));
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t a = j * (n + 1) + i, b = a + 1, c = b + n + 1, d = a + n + 1;
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({a, c, d});
        }
    this->mesh(std::move(mesh), material);
}

void SceneMaker::polygon(const std::vector<Vec3d>& corners, std::uint32_t material) {
    TriangleMesh mesh;
    for (const Vec3d& corner : corners) mesh.positions.push_back(Vec3f(corner));
    for (std::uint32_t i = 2; i < corners.size(); ++i) mesh.triangles.push_back({0, i - 1, i});
    this->mesh(std::move(mesh), material);
}

void SceneMaker::box(Vec3d lo, Vec3d hi, std::uint32_t material, bool inwards) {
    const Vec3d size = hi - lo;
    const Vec3d x{size.x, 0, 0}, y{0, size.y, 0}, z{0, 0, size.z};
    const auto wall = [&](Vec3d p, Vec3d a, Vec3d b) {
        inwards ? quad(p, a, b, material) : quad(p, b, a, material);
    };
    wall(lo, z, x);      // bottom, up
    wall(lo + y, x, z);  // top, down
    wall(lo, y, z);      // left, towards +x
    wall(lo + x, z, y);  // right, towards -x
    wall(lo, x, y);      // back, towards +z
    wall(lo + z, y, x);  // front, towards -z
}

void SceneMaker::sphere(Vec3d centre, double radius, std::uint32_t material) {
    InstanceDescription instance;
    instance.shape = SphereShape{centre, radius};
    instance.materials = {material};
    description.instances.push_back(std::move(instance));
}

void SceneMaker::meshSphere(Vec3d centre, double radius, std::uint32_t material, bool inwards,
                            int rings) {
    TriangleMesh mesh;
    const int segments = 2 * rings;
    for (int j = 0; j <= rings; ++j)
        for (int i = 0; i < segments; ++i) {
            const double theta = std::numbers::pi * j / rings;
            const double phi = 2 * std::numbers::pi * i / segments;
            const Vec3d n{std::sin(theta) * std::cos(phi), std::cos(theta),
                          std::sin(theta) * std::sin(phi)};
            mesh.positions.push_back(Vec3f(centre + n * radius));
            mesh.normals.push_back(Vec3f(inwards ? -n : n));
        }
    const auto at = [&](int j, int i) {
        return static_cast<std::uint32_t>(j * segments + i % segments);
    };
    for (int j = 0; j < rings; ++j)
        for (int i = 0; i < segments; ++i) {
            TriangleMesh::Corners first{at(j, i), at(j, i + 1), at(j + 1, i + 1)};
            TriangleMesh::Corners second{at(j, i), at(j + 1, i + 1), at(j + 1, i)};
            if (inwards) {
                std::swap(first[1], first[2]);
                std::swap(second[1], second[2]);
            }
            if (j > 0) mesh.triangles.push_back(first);
            if (j < rings - 1) mesh.triangles.push_back(second);
        }
    mesh.normalIndices = mesh.triangles;
    this->mesh(std::move(mesh), material);
}

void SceneMaker::bendNormals(Vec3d normal) {
    auto& shape = description.instances.back().shape;
    TriangleMesh mesh = *std::get<std::shared_ptr<const TriangleMesh>>(shape);
    mesh.normals = {Vec3f(normalize(normal))};
    mesh.normalIndices.assign(mesh.triangles.size(), {0, 0, 0});
    shape = std::make_shared<const TriangleMesh>(std::move(mesh));
}

void SceneMaker::pointLight(Vec3d position, Rgb intensity) {
    description.lights.push_back(PointLightDescription{position, intensity, ""});
}

void SceneMaker::spot(Vec3d position, Vec3d direction, Rgb intensity, double angle,
                      double falloff) {
    description.lights.push_back(
        SpotLightDescription{position, direction, intensity, angle, falloff, ""});
}

void SceneMaker::sun(Vec3d direction, Rgb irradiance, double angularRadius) {
    description.lights.push_back(
        DirectionalLightDescription{direction, irradiance, angularRadius, ""});
}

void SceneMaker::sky(Rgb radiance, std::shared_ptr<const TextureSource> picture,
                     const Transform& toWorld) {
    description.environment = {radiance, picture ? 0 : kNoTexture, toWorld};
    if (picture) description.textures = std::move(picture);
}

void SceneMaker::camera(Vec3d eye, Vec3d lookAt, Vec3d up, double verticalDegrees) {
    const Vec3d back = normalize(eye - lookAt);
    const Vec3d right = normalize(cross(up, back));
    const Vec3d u = cross(back, right);
    CameraDescription camera;
    camera.cameraToWorld = {right.x, u.x,   back.x,  eye.x, right.y, u.y,
                            back.y,  eye.y, right.z, u.z,   back.z,  eye.z};
    camera.verticalFieldOfView = verticalDegrees * std::numbers::pi / 180;
    description.camera = camera;
}

std::shared_ptr<const Scene> SceneMaker::build() const {
    return Scene::build(description, "best");
}

namespace {

// Sums of one layer over the region, pass by pass.
struct PassMeans {
    std::vector<std::array<double, 3>> means;

    Measured summarise() const {
        Measured m;
        const auto n = static_cast<double>(means.size());
        for (std::size_t c = 0; c < 3; ++c) {
            for (const auto& pass : means) m.mean[c] += pass[c] / n;
            double squares = 0;
            for (const auto& pass : means) squares += (pass[c] - m.mean[c]) * (pass[c] - m.mean[c]);
            m.standardError[c] = n > 1 ? std::sqrt(squares / (n * (n - 1))) : 0;
        }
        return m;
    }
};

// One pass of a rectangle of the frame.
struct RenderedPass {
    Rect area;
    std::size_t channels;
    std::vector<float> pixels, weights;

    RenderedPass(const FrameRenderer& renderer, const Rect& area_)
        : area(area_), channels(static_cast<std::size_t>(renderer.layout().count)) {
        const std::atomic<bool> cancelled{false};
        const auto width = static_cast<std::size_t>(area.width());
        pixels.resize(static_cast<std::size_t>(area.area()) * channels);
        weights.resize(static_cast<std::size_t>(area.area()));
        tbb::parallel_for(std::int32_t{0}, area.height(), [&](std::int32_t row) {
            const auto first = static_cast<std::size_t>(row) * width;
            const Rect line{area.x0, area.y0 + row, area.x1, area.y0 + row + 1};
            renderer.renderRegion(line,
                                  std::span(pixels).subspan(first * channels, width * channels),
                                  std::span(weights).subspan(first, width), cancelled);
        });
    }

    std::array<double, 3> mean(const Rect& region, std::int32_t offset) const {
        std::array<double, 3> mean{};
        double weight = 0;
        for (std::int32_t y = region.y0; y < region.y1; ++y)
            for (std::int32_t x = region.x0; x < region.x1; ++x) {
                const auto i = static_cast<std::size_t>((y - area.y0) * area.width() + x - area.x0);
                weight += static_cast<double>(weights[i]);
                for (std::size_t c = 0; c < 3; ++c)
                    mean[c] += static_cast<double>(weights[i]) *
                               static_cast<double>(
                                   pixels[i * channels + static_cast<std::size_t>(offset) + c]);
            }
        for (double& m : mean) m /= weight;
        return mean;
    }
};

}  // namespace

std::vector<MeasuredLayers> measureRegions(const std::shared_ptr<const Scene>& scene,
                                           const RenderSettings& settings, const Rect& area,
                                           const std::vector<Rect>& regions) {
    FrameRenderer renderer(scene, settings);
    const ChannelLayout layout = renderer.layout();
    const std::array<std::int32_t, 5> offsets = {layout.beauty, layout.direct, layout.indirect,
                                                 layout.caustic, layout.emission};
    std::vector<std::array<PassMeans, 5>> sums(regions.size());
    for (std::uint32_t pass = 0; pass < settings.passes; ++pass) {
        renderer.beginPass(pass, std::atomic<bool>{false}, {});
        const RenderedPass rendered(renderer, area);
        for (std::size_t r = 0; r < regions.size(); ++r)
            for (std::size_t l = 0; l < offsets.size(); ++l)
                sums[r][l].means.push_back(rendered.mean(regions[r], offsets[l]));
    }
    std::vector<MeasuredLayers> measured;
    for (const auto& s : sums)
        measured.push_back({s[0].summarise(), s[1].summarise(), s[2].summarise(), s[3].summarise(),
                            s[4].summarise(), renderer.counters()});
    return measured;
}

MeasuredLayers measure(const std::shared_ptr<const Scene>& scene, RenderSettings settings,
                       Rect region) {
    if (region.empty()) region = settings.window;
    return measureRegions(scene, settings, region, {region}).front();
}

RenderSettings smallFrame(std::int32_t width, std::int32_t height, IntegratorKind integrator,
                          std::uint32_t passes, std::uint32_t aaLevel) {
    RenderSettings settings;
    settings.width = width;
    settings.height = height;
    settings.window = {0, 0, width, height};
    settings.integrator = integrator;
    settings.passes = passes;
    settings.aaLevel = aaLevel;
    return settings;
}

::testing::AssertionResult agrees(const Measured& measured, Rgb expected, double relativeBias,
                                  double sigmas) {
    for (int c = 0; c < 3; ++c) {
        const auto i = static_cast<std::size_t>(c);
        const double want = static_cast<double>(expected[c]);
        // Sums in float along a path: a few units in the last place.
        const double allowed = sigmas * measured.standardError[i] + (relativeBias + 1e-6) * want;
        if (!(std::abs(measured.mean[i] - want) <= allowed))
            return ::testing::AssertionFailure() << fmt::format(
                       "channel {}: measured {} +- {}, expected {}, off by {:.3f} %, allowed {}", c,
                       measured.mean[i], measured.standardError[i], want,
                       100 * (measured.mean[i] / want - 1), allowed);
    }
    return ::testing::AssertionSuccess();
}

::testing::AssertionResult agree(const Measured& a, const Measured& b, double relativeBias,
                                 double sigmas) {
    Measured combined = a;
    for (std::size_t c = 0; c < 3; ++c)
        combined.standardError[c] = std::hypot(a.standardError[c], b.standardError[c]);
    return agrees(combined,
                  {static_cast<float>(b.mean[0]), static_cast<float>(b.mean[1]),
                   static_cast<float>(b.mean[2])},
                  relativeBias, sigmas);
}

}  // namespace pm::test
