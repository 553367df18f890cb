// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// POV-Ray 3.7. Its light sources have no area, distance or angle law of physics by themselves; they
// are given one here:
//   - `spotlight` of 90 degrees with tightness 1 shines with the cosine of the lamp's surface;
//   - `fade_distance` f and `fade_power 2` make 2 / (1 + (d/f)^2) of distance d, which is 2 f^2/d^2
//     for f much smaller than any d;
//   - a diffuse surface shows albedo times light times cosine, without 1/pi;
// so a lamp of radiance L and area A is a light source of colour L A / (2 pi f^2). The visible lamp
// is a polygon that neither casts shadows nor is seen by radiosity, else its light would count
// twice. What stays wrong: the radiosity's indirect light, interpolated and cut off after some
// bounces, and the one distance and cosine that all points of the lamp share.
#include <fmt/format.h>

#include <array>
#include <fstream>
#include <numbers>

#include "integrator/values/error.h"
#include "tests/bench/peers/peers.h"
#include "tests/bench/run/child_process.h"

namespace pm::bench {

namespace {

constexpr double kFadeDistance = 0.01;  // scene units; 1 % of the scenes' half width
constexpr double kLampGap = 1e-4;       // the light source lies this far below the visible lamp

// Each step of quality takes three to five times as long as the one before.
struct Quality {
    int radiosityRays;
    double radiosityError;
    int bounces;
    double pretraceEnd;  // share of the picture's width
    int photons;
    int lampPoints;    // a side
    int samplesASide;  // of a pixel
};
constexpr std::array<Quality, 6> kQualities = {{
    {20, 1.0, 3, 0.04, 20000, 4, 1},
    {35, 0.8, 4, 0.02, 60000, 4, 2},
    {60, 0.6, 5, 0.02, 200000, 8, 2},
    {150, 0.4, 8, 0.01, 600000, 8, 3},
    {400, 0.25, 10, 0.005, 2000000, 12, 4},
    {1000, 0.15, 12, 0.004, 6000000, 16, 4},
}};

std::string text(Vec3d v) {
    return fmt::format("<{},{},{}>", v.x, v.y, v.z);
}

std::string text(Rgb c) {
    return fmt::format("rgb <{},{},{}>", c.r, c.g, c.b);
}

std::string globalSettings(const Quality& q, bool photons) {
    std::string result = fmt::format(
        "#version 3.7;\nglobal_settings {{\n  assumed_gamma 1.0\n  max_trace_level 16\n"
        "  adc_bailout 0.002\n  radiosity {{\n    pretrace_start 0.08 pretrace_end {}\n"
        "    count {} nearest_count 10 error_bound {} low_error_factor 0.6 recursion_limit {}\n"
        "    gray_threshold 0 brightness 1 minimum_reuse 0.003 adc_bailout 0.0005\n  }}\n",
        q.pretraceEnd, q.radiosityRays, q.radiosityError, q.bounces);
    if (photons)
        result +=
            fmt::format("  photons {{ count {} autostop 0 max_trace_level 16 }}\n", q.photons);
    return result + "}\nbackground { rgb 0 }\n";
}

std::string camera(const NeutralCamera& c) {
    const CameraAxes axes = axesOf(c);
    const double distance = 0.5 / std::tan(c.verticalDegrees * std::numbers::pi / 360);
    return fmt::format("camera {{ location {} direction {} up {} right {} }}\n", text(c.position),
                       text(axes.back * -distance), text(axes.up), text(axes.right));
}

std::string polygon(const NeutralQuad& quad, const std::string& look) {
    const Vec3d a = quad.p, b = a + quad.e0, c = b + quad.e1, d = a + quad.e1;
    return fmt::format("polygon {{ 5, {}, {}, {}, {}, {} {} }}\n", text(a), text(b), text(c),
                       text(d), text(a), look);
}

std::string lamp(const NeutralScene& scene, int points) {
    const NeutralQuad& q = scene.lamp;
    const Vec3d normal = normalize(cross(q.e0, q.e1));
    const Vec3d centre = q.p + (q.e0 + q.e1) * 0.5 + normal * kLampGap;
    const double strength =
        length(cross(q.e0, q.e1)) / (2 * std::numbers::pi * kFadeDistance * kFadeDistance);
    std::string result = fmt::format(
        "light_source {{ {} {} fade_distance {} fade_power 2\n  spotlight point_at {} radius 90 "
        "falloff 90 tightness 1\n  area_light {}, {}, {}, {} adaptive 0 area_illumination on\n"
        "  photons {{ area_light refraction on reflection on }} }}\n",
        text(centre), text(scene.radiance * static_cast<float>(strength)), kFadeDistance,
        text(centre + normal), text(q.e0), text(q.e1), points, points);
    return result +
           polygon(q, fmt::format("pigment {{ {} }} finish {{ ambient 0 diffuse 0 emission "
                                  "1 }} no_radiosity no_shadow",
                                  text(scene.radiance)));
}

std::string sphere(const NeutralSphere& s) {
    const char* const mirror =
        "pigment { rgb 0 } finish { ambient 0 diffuse 0 reflection { 1 } }\n"
        "  photons { target reflection on refraction off }";
    const char* const glass =
        "pigment { rgbf 1 } finish { ambient 0 diffuse 0 reflection { 0, 1 fresnel on } "
        "conserve_energy }\n  interior { ior 1.5 } photons { target reflection on refraction on }";
    return fmt::format("sphere {{ {}, {} {} }}\n", text(s.centre), s.radius,
                       s.material == "mirror" ? mirror : glass);
}

void writeScene(const std::filesystem::path& file, const NeutralScene& scene, const Quality& q) {
    std::ofstream out(file);
    out << globalSettings(q, !scene.spheres.empty()) << camera(scene.camera)
        << lamp(scene, q.lampPoints);
    for (const NeutralQuad& quad : scene.quads)
        out << polygon(quad, fmt::format("pigment {{ {} }} finish {{ ambient 0 diffuse 1 }}",
                                         text(scene.reflectances.at(quad.material))));
    for (const NeutralSphere& each : scene.spheres) out << sphere(each);
    if (!out.flush()) throw Error(Status::kIo, file.string() + ": can't be written");
}

}  // namespace

std::vector<PeerPicture> renderWithPovray(const NeutralScene& scene, const PeerRequest& request) {
    if (!findProgram("povray")) return {};
    std::vector<PeerPicture> pictures;
    for (std::size_t i = 0; i < kQualities.size(); ++i) {
        // The next step takes some four times as long as the last one.
        if (!pictures.empty() &&
            4 * pictures.back().processorSeconds > request.seconds * request.threads)
            break;
        const std::string name = fmt::format("povray_{}_{}", scene.key, i + 1);
        const std::filesystem::path log = request.folder / (name + ".log");
        writeScene(request.folder / (name + ".pov"), scene, kQualities[i]);
        const std::string size = std::to_string(scene.size);
        // Files by their names alone: POV-Ray may read and write in its working folder. All pixels
        // get all samples (threshold 0), averaged in linear values.
        const ChildResult done = runChild(
            {"povray", name + ".pov", "+O" + name + ".exr", "+FE", "+W" + size, "+H" + size,
             "+A0.0", "+AM1", fmt::format("+R{}", kQualities[i].samplesASide), "-J", "-D", "-GA",
             fmt::format("+WT{}", request.threads), "Antialias_Gamma=1.0", "File_Gamma=1.0"},
            request.folder, log);
        if (done.exitCode != 0)
            throw Error(Status::kInternal,
                        fmt::format("povray ended with {}: {}", done.exitCode, lastLineOf(log)));
        pictures.push_back({fmt::format("quality {}", i + 1), done.seconds, done.processorSeconds,
                            request.folder / (name + ".exr")});
    }
    return pictures;
}

}  // namespace pm::bench
