// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "host_shim/formats/json/json_reader.h"
#include "host_shim/formats/sidecar/sidecar.h"
#include "host_shim/formats/sidecar/sidecar_parts.h"
#include "host_shim/formats/source_file.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::uint64_t kMostBytes = std::uint64_t{2} << 30;

std::uint32_t readHiddenFrom(const JsonPlace& at) {
    std::uint32_t bits = 0;
    for (const JsonPlace& word : at.entriesOf("hiddenFrom")) {
        constexpr std::uint32_t kBits[] = {kHiddenFromCamera, kHiddenFromShadow,
                                           kHiddenFromReflection};
        bits |= kBits[word.choice({"camera", "shadow", "reflection"})];
    }
    return bits;
}

void readReplaced(const JsonPlace& at, NameTable& names, SidecarInstance& instance) {
    if (at.isText()) {
        instance.material = names.numberOf(at.text());
    } else if (at.isObject()) {
        for (const auto& [old, name] : at.members())
            instance.materials.emplace_back(names.numberOf(old), names.numberOf(name.text()));
        std::ranges::sort(instance.materials);
    } else {
        at.refuse(" must be the name of a material, or an object with names in place of names");
    }
}

SidecarInstance readInstance(const JsonPlace& at, NameTable& names) {
    at.allowKeys(
        {"of", "name", "matrix", "translate", "rotate", "scale", "materials", "hiddenFrom"});
    SidecarInstance instance;
    if (at.has("of")) instance.of = names.numberOf(at.member("of").text());
    if (at.has("name")) instance.name = at.member("name").text();
    instance.transform = readPlacement(at);
    instance.hiddenFrom = readHiddenFrom(at);
    if (at.has("materials")) readReplaced(at.member("materials"), names, instance);
    return instance;
}

SidecarSphere readSphere(const JsonPlace& at, NameTable& names) {
    at.allowKeys({"name", "centre", "radius", "material", "matrix", "translate", "rotate", "scale",
                  "hiddenFrom"});
    SidecarSphere sphere;
    sphere.sphere.name = at.has("name") ? at.member("name").text() : at.path();
    if (at.has("centre")) sphere.sphere.centre = at.member("centre").triple();
    sphere.sphere.radius = at.member("radius").number({0, 1e30, false, true, "scene units"});
    sphere.material = names.numberOf(at.member("material").text());
    sphere.transform = readPlacement(at);
    sphere.hiddenFrom = readHiddenFrom(at);
    return sphere;
}

TextureUse readPicture(const JsonPlace& at, SceneFiles& files) {
    const std::string name = at.text();
    const auto file = files.find(files.folder(), name);
    if (!file) at.refuse(": " + files.whyNone(files.folder(), name));
    TextureUse use;
    use.file = file->string();
    use.place = fmt::format("{}: {}", at.file(), at.path());
    return use;
}

SidecarMaterial readMaterial(const std::string& name, const JsonPlace& at, SceneFiles& files) {
    SidecarMaterial material;
    material.name = name;
    for (const auto& [key, value] : at.members()) {
        if (key == "weightTexture") {
            material.weightTexture = readPicture(value, files);
            material.weightTexture->isData = true;
            continue;
        }
        NamedValue& named = material.values.emplace_back();
        named.name = key;
        named.place = fmt::format("{}: {}", value.file(), value.path());
        if (value.isText())
            named.text = value.text();
        else if (value.isNumber())
            named.numbers = {value.number()};
        else
            for (const JsonPlace& entry : value.entriesOr("a number, a text or a list of numbers"))
                named.numbers.push_back(entry.number());
    }
    return material;
}

EnvironmentData readEnvironment(const JsonPlace& at, SceneFiles& files) {
    at.allowKeys({"radiance", "texture", "rotate", "matrix"});
    EnvironmentData environment;
    if (at.has("texture")) environment.texture = readPicture(at.member("texture"), files);
    environment.radiance = {1, 1, 1};
    if (at.has("radiance") || !environment.texture) {
        const auto value = at.member("radiance")
                               .oneOrThree({0, std::numeric_limits<float>::max(), true, true, ""});
        for (std::size_t i = 0; i < 3; ++i) environment.radiance[i] = static_cast<float>(value[i]);
    }
    if (at.has("rotate") && at.has("matrix"))
        at.refuse(" has rotate and matrix; it is one of them");
    if (at.has("rotate")) environment.transform = rotationOf(at.member("rotate").triple());
    if (at.has("matrix")) environment.transform = readRotation(at.member("matrix"));
    return environment;
}

SkyData readSky(const JsonPlace& at) {
    at.allowKeys({"azimuth", "elevation", "turbidity", "strength"});
    SkyData sky;
    sky.azimuth = at.member("azimuth").number({-360, 360, true, true, "degrees"});
    sky.elevation = at.member("elevation").number({0, 90, false, true, "degrees"});
    if (at.has("turbidity"))
        sky.turbidity = at.member("turbidity").number({1.7, 10, true, true, ""});
    if (at.has("strength")) sky.strength = at.member("strength").number({0, 1e6, true, true, ""});
    return sky;
}

// What an entry of a list takes beside its own size.
std::uint64_t bytesOf(const SidecarInstance& instance) {
    return instance.name.size() + instance.materials.size() * sizeof instance.materials[0];
}
std::uint64_t bytesOf(const SidecarSphere& sphere) {
    return sphere.sphere.name.size();
}
std::uint64_t bytesOf(const LightData& light) {
    return light.name.size();
}
std::uint64_t bytesOf(const CameraData& camera) {
    return camera.name.size();
}
std::uint64_t bytesOf(const SidecarMaterial& material) {
    std::uint64_t bytes = material.name.size();
    for (const NamedValue& value : material.values)
        bytes += sizeof value + value.name.size() + value.place.size() + value.text.size() +
                 value.numbers.size() * sizeof(double);
    return bytes;
}

// Takes the parts of a sidecar as they come.
class SidecarParts {
  public:
    SidecarParts(const std::string& file, std::uint64_t textBytes, SceneFiles& files,
                 const SidecarLimits& limits)
        : m_files(files),
          m_goOn(limits.goOn),
          m_limit(limits.memoryBytes),
          m_held(file, 2 * textBytes + kFewEntries, limits.memoryBytes) {
        m_sidecar.file = file;
    }

    Sidecar read(std::string_view text) {
        m_held.take(text.size());
        JsonBudget parsed(m_sidecar.file, text.size(), m_limit);
        const Json whole = readJsonParts(
            text, parsed, m_goOn,
            {[](const std::string& key, bool isObject) {
                 return isObject ? key == "materials"
                                 : key == "instances" || key == "spheres" || key == "lights" ||
                                       key == "cameras";
             },
             [this](const JsonPart& part) { part.isEntry ? takeEntry(part) : takeMember(part); }});
        const JsonPlace all(whole, m_sidecar.file);
        all.allowKeys({});
        if (!m_hasSchema) all.member("schema");
        if (m_sidecar.environment && m_sidecar.sky)
            all.refuse(" has environment and sky; it is one of them");
        return std::move(m_sidecar);
    }

  private:
    template <typename Entry>
    void keep(Entry entry, std::vector<Entry>& list) {
        // As lists grow they are copied: both are there.
        m_held.take(2 * sizeof entry + bytesOf(entry));
        list.push_back(std::move(entry));
    }

    void takeEntry(const JsonPart& part) {
        if (part.key == "materials") {
            const JsonPlace at(part.value, m_sidecar.file,
                               JsonPlace::memberPath(part.key, part.name));
            keep(readMaterial(part.name, at, m_files), m_sidecar.materials);
            return;
        }
        const JsonPlace at(part.value, m_sidecar.file, fmt::format("{}[{}]", part.key, part.index));
        if (part.key == "instances") {
            if (part.index >= kMostInstances)
                at.refuse(fmt::format(" is one of more than {}, which is the most of a scene",
                                      kMostInstances));
            SidecarInstance instance = readInstance(at, m_sidecar.names);
            instance.index = static_cast<std::uint32_t>(part.index);
            keep(std::move(instance), m_sidecar.instances);
        } else if (part.key == "spheres") {
            keep(readSphere(at, m_sidecar.names), m_sidecar.spheres);
        } else if (part.key == "lights") {
            keep(readLight(at), m_sidecar.lights);
        } else {
            CameraData camera = readCamera(at);
            if (!m_cameras.insert(camera.name).second)
                at.refuse(fmt::format(" is named '{}' like one before it", camera.name));
            keep(std::move(camera), m_sidecar.cameras);
        }
    }

    void takeMember(const JsonPart& part) {
        const JsonPlace at(part.value, m_sidecar.file, part.key);
        if (part.key == "schema") {
            at.choice({kSidecarSchema});
            m_hasSchema = true;
        } else if (part.key == "sky") {
            m_sidecar.sky = readSky(at);
        } else if (part.key == "environment") {
            m_sidecar.environment = readEnvironment(at, m_files);
        } else if (part.key == "materials") {
            at.members();
        } else if (part.key != "$schema") {
            const Json none{{part.key, nullptr}};
            JsonPlace(none, m_sidecar.file)
                .allowKeys({"$schema", "schema", "instances", "spheres", "materials", "lights",
                            "environment", "sky", "cameras"});
            at.entries();
        }
    }

    // Lists that grow are there twice. Bytes: of a file of very short entries.
    static constexpr std::uint64_t kFewEntries = std::uint64_t{32} << 20;

    SceneFiles& m_files;
    const GoOn& m_goOn;
    std::uint64_t m_limit;
    JsonBudget m_held;
    Sidecar m_sidecar;
    std::set<std::string> m_cameras;
    bool m_hasSchema{};
};

}  // namespace

fs::path sidecarOf(const fs::path& scene) {
    fs::path file = scene;
    return file.replace_extension(".pm.json");
}

std::vector<std::string> Sidecar::materialNames() const {
    std::vector<bool> isPut(names.size());
    for (const SidecarInstance& instance : instances) {
        if (instance.material != NameTable::kNone) isPut[instance.material] = true;
        for (const auto& [old, name] : instance.materials) isPut[name] = true;
    }
    for (const SidecarSphere& sphere : spheres) isPut[sphere.material] = true;
    std::vector<std::string> all;
    for (std::uint32_t number = 0; number < isPut.size(); ++number)
        if (isPut[number]) all.push_back(names[number]);
    for (const SidecarMaterial& material : materials) {
        all.push_back(material.name);
        for (const NamedValue& value : material.values)
            if (value.name == "first" || value.name == "second") all.push_back(value.text);
    }
    std::ranges::sort(all);
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

Sidecar readSidecar(std::string_view text, const std::string& file, SceneFiles& files,
                    const SidecarLimits& limits) {
    return SidecarParts(file, text.size(), files, limits).read(text);
}

Sidecar readSidecarFile(const fs::path& file, SceneFiles& files, const SidecarLimits& limits) {
    return readSidecar(readWholeFile(file, limits.goOn, kMostBytes), file.string(), files, limits);
}

}  // namespace pm::host
