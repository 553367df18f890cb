// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/ingest/materials.h"

#include "host_shim/ingest/material_maps.h"

#include <fmt/format.h>
#include <tiny_obj_loader.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace pm::host {
namespace {

// Exponents above are as sharp as float directions can tell.
constexpr double kLargestExponent = 1e7;
constexpr double kLargestIor = 100.0;
constexpr char kUsualChannel = 'm';  // of -imfchan, in the parser's letters

tinyobj::material_t parseSection(const std::string& text) {
    std::map<std::string, int> names;
    std::vector<tinyobj::material_t> materials;
    std::istringstream stream(text);
    std::string warning, error;
    tinyobj::LoadMtl(&names, &materials, &stream, &warning, &error);
    return materials.empty() ? tinyobj::material_t{} : materials.front();
}

std::array<float, 3> rounded(const tinyobj::real_t (&colour)[3]) {
    return {static_cast<float>(colour[0]), static_cast<float>(colour[1]),
            static_cast<float>(colour[2])};
}

bool isBlack(const std::array<float, 3>& colour) {
    return colour[0] == 0 && colour[1] == 0 && colour[2] == 0;
}

// Turns one section into a material.
class MaterialReader {
  public:
    MaterialReader(const MtlSection& section, const std::string& fileName,
                   const std::filesystem::path& folder, const WarningSink& warn)
        : m_section(section),
          m_file(fileName),
          m_folder(folder),
          m_warn(warn),
          m_parsed(parseSection(section.cleaned)) {}

    MaterialData read() {
        m_material.name = m_section.name;
        for (const auto& [statement, text] : m_section.notUnderstood) {
            note(Warning::kMaterialValue, statement,
                 fmt::format("'{} {}' is not understood and left out", statement, text));
        }
        readMaps();
        noteLeftOut();
        readColours();
        decideKind();
        readKind();
        limitSum();
        return std::move(m_material);
    }

  private:
    bool given(const char* statement) const {
        return m_section.has(statement) && !m_section.notUnderstood.contains(statement);
    }

    // FILE:LINE of a statement, or where the material begins.
    std::string place(const std::string& statement) const {
        const auto found = m_section.lines.find(statement);
        return fmt::format(
            "{}:{}", m_file,
            found != m_section.lines.end() ? found->second : m_section.lines.at("newmtl"));
    }

    void note(Warning code, const std::string& statement, const std::string& text) const {
        m_warn(code, fmt::format("{}: material {}: {}", place(statement), m_material.name, text));
    }

    std::optional<TextureUse> map(const char* statement, const std::string& name,
                                  const tinyobj::texture_option_t& options, bool isData) const {
        auto use = MapReader(m_folder).read(name, options, isData);
        if (!use) {
            if (m_section.has(statement))
                note(Warning::kTexture, statement, fmt::format("{} names no file", statement));
            return use;
        }
        use->place = place(statement);
        const auto leaveOut = [&](const char* option) {
            note(Warning::kTexture, statement,
                 fmt::format("the option {} of {} is not rendered yet and left out", option,
                             statement));
        };
        if (std::ranges::any_of(options.turbulence, [](auto size) { return size != 0; }))
            leaveOut("-t");
        if (options.imfchan != kUsualChannel) leaveOut("-imfchan");
        return use;
    }

    void readMaps() {
        m_material.diffuseTexture =
            map("map_Kd", m_parsed.diffuse_texname, m_parsed.diffuse_texopt, false);
        m_material.glossyTexture =
            map("map_Ks", m_parsed.specular_texname, m_parsed.specular_texopt, false);
        m_material.glossyExponentTexture = map("map_Ns", m_parsed.specular_highlight_texname,
                                               m_parsed.specular_highlight_texopt, true);
        m_material.opacityTexture =
            map("map_d", m_parsed.alpha_texname, m_parsed.alpha_texopt, true);
        m_material.emissionTexture =
            map("map_Ke", m_parsed.emissive_texname, m_parsed.emissive_texopt, false);
        if (!m_section.transmissionMap.empty()) {
            const tinyobj::material_t tint = parseSection(m_section.transmissionMap);
            m_material.transmissionTexture =
                map("map_Tf", tint.diffuse_texname, tint.diffuse_texopt, false);
        }
        for (const char* statement : {"map_bump", "map_Bump", "bump", "norm", "disp", "map_disp",
                                      "map_Disp", "refl", "map_Pr", "map_Pm", "map_Ps"}) {
            if (m_section.has(statement)) {
                note(Warning::kMaterialPart, statement,
                     fmt::format("{} is not rendered yet and left out", statement));
            }
        }
    }

    void noteLeftOut() const {
        const std::array<std::pair<const char*, double>, 4> numbers{
            {{"Pr", m_parsed.roughness},
             {"Pm", m_parsed.metallic},
             {"Ps", m_parsed.sheen},
             {"Pc", m_parsed.clearcoat_thickness}}};
        for (const auto& [statement, value] : numbers) {
            if (!given(statement) || value == 0) continue;
            note(Warning::kMaterialPart, statement,
                 fmt::format("{} is not rendered yet and left out", statement));
        }
        if (given("illum") && (m_parsed.illum < 0 || m_parsed.illum > 10)) {
            note(Warning::kMaterialValue, "illum",
                 fmt::format("illum {} is outside [0, 10] and left out", m_parsed.illum));
        }
    }

    // The number beside a map multiplies it, so one that is not given counts as 1.
    std::array<float, 3> colour(const char* statement, const tinyobj::real_t (&value)[3],
                                bool hasMap) const {
        if (!given(statement))
            return hasMap ? std::array<float, 3>{1, 1, 1} : std::array<float, 3>{};
        if (hasMap && isBlack(rounded(value))) {
            note(Warning::kMaterialValue, statement,
                 fmt::format("{} 0 0 0 multiplies map_{}, so the map has no effect", statement,
                             statement));
        }
        return rounded(value);
    }

    void readColours() {
        m_material.diffuse = reflectance(
            "Kd", colour("Kd", m_parsed.diffuse, m_material.diffuseTexture.has_value()));
        m_material.glossy = reflectance(
            "Ks", colour("Ks", m_parsed.specular, m_material.glossyTexture.has_value()));
        m_material.emission =
            colour("Ke", m_parsed.emission, m_material.emissionTexture.has_value());
        std::string faults;
        for (float& channel : m_material.emission) {
            if (channel >= 0 && std::isfinite(channel)) continue;
            faults += fmt::format(" {}", channel);
            channel = 0;
        }
        if (!faults.empty()) {
            note(Warning::kMaterialValue, "Ke",
                 fmt::format("Ke{} is not in [0, {}]; 0 is taken", faults,
                             std::numeric_limits<float>::max()));
        }
        const bool saysNothing = !given("Kd") && !given("Ks") && !given("Ke") && !given("Tf") &&
                                 !given("Kt") && !m_material.diffuseTexture &&
                                 !m_material.glossyTexture && !m_material.emissionTexture;
        if (saysNothing) m_material.diffuse = defaultMaterial("").diffuse;
    }

    std::array<float, 3> reflectance(const char* statement, std::array<float, 3> value) const {
        const auto clamped = clampedToUnit(value);
        if (clamped != value) {
            note(Warning::kMaterialValue, statement,
                 fmt::format("{} {} {} {} is outside [0,1]; {} {} {} is taken", statement, value[0],
                             value[1], value[2], clamped[0], clamped[1], clamped[2]));
        }
        return clamped;
    }

    static std::array<float, 3> clampedToUnit(std::array<float, 3> value) {
        for (float& channel : value) channel = channel > 0 ? std::min(channel, 1.0f) : 0.0f;
        return value;
    }

    double dissolve() const {
        const double value = m_parsed.dissolve;
        const double clamped = std::clamp(value, 0.0, 1.0);
        if (clamped != value) {
            note(Warning::kMaterialValue, given("d") ? "d" : "Tr",
                 fmt::format("opacity {} is outside [0,1]; {} is taken", value, clamped));
        }
        return clamped;
    }

    void decideKind() {
        const int illum = given("illum") ? m_parsed.illum : -1;
        const bool reflects = !isBlack(m_material.glossy);
        m_opacity = static_cast<float>(dissolve());
        const bool hasIor = given("Ni") && m_parsed.ior != 1.0;
        if (illum == 4 || illum == 6 || illum == 7 || (m_opacity < 1 && hasIor)) {
            m_material.kind = MaterialKind::kDielectric;
        } else if ((illum == 3 || illum == 5) && reflects) {
            m_material.kind = MaterialKind::kMirror;
            m_material.fresnel = illum == 5;
        } else {
            m_material.kind = MaterialKind::kSurface;
        }
    }

    void readKind() {
        if (m_material.kind == MaterialKind::kDielectric) {
            readDielectric();
            return;
        }
        m_material.transparency = 1.0f - m_opacity;
        if (m_opacity == 0 && !m_material.opacityTexture) {
            note(Warning::kMaterialValue, given("d") ? "d" : "Tr",
                 "fully transparent, so it can't be seen (d 1 or Tr 0 is opaque)");
        }
        if (m_material.kind == MaterialKind::kMirror) {
            readMirror();
        } else {
            readLobe();
        }
    }

    void readDielectric() {
        const bool hasTint = given("Tf") || given("Kt") || m_material.transmissionTexture;
        m_material.transmission = {1, 1, 1};
        if (hasTint) {
            const char* statement = given("Kt") ? "Kt" : "Tf";
            m_material.transmission =
                reflectance(statement, colour(statement, m_parsed.transmittance,
                                              m_material.transmissionTexture.has_value()));
            if (isBlack(m_material.transmission)) {
                note(Warning::kMaterialValue, statement, "this glass lets nothing through");
            }
        }
        const double ior = given("Ni") ? m_parsed.ior : 1.5;
        if (!given("Ni")) {
            note(Warning::kMaterialValue, "illum", "glass without Ni; 1.5 is taken");
        }
        const double allowed = ior > 0 ? std::clamp(ior, 1.0 / kLargestIor, kLargestIor) : 1.5;
        if (allowed != ior) {
            note(Warning::kMaterialValue, "Ni",
                 fmt::format("Ni {} is outside [{}, {}]; {} is taken", ior, 1.0 / kLargestIor,
                             kLargestIor, allowed));
        }
        m_material.ior = static_cast<float>(allowed);
        dropDiffuse("glass");
        m_material.glossy = {};
        m_material.glossyTexture.reset();
        m_material.glossyExponentTexture.reset();
    }

    void readMirror() {
        dropDiffuse("mirror");
        if (m_material.fresnel) {
            m_material.glossyExponentTexture.reset();
        } else {
            // 0 would mean a perfect mirror, and Ns 0 means the roughest.
            if (hasExponent()) m_material.glossyExponent = std::max(exponent(), 1e-3f);
        }
    }

    void readLobe() {
        const bool noLobe = given("illum") && (m_parsed.illum == 0 || m_parsed.illum == 1);
        if (noLobe || !hasExponent()) {
            m_material.glossy = {};
            m_material.glossyTexture.reset();
            m_material.glossyExponentTexture.reset();
            return;
        }
        m_material.glossyExponent = exponent();
    }

    bool hasExponent() const { return given("Ns") || m_material.glossyExponentTexture; }

    float exponent() const {
        const double value = given("Ns") ? m_parsed.shininess : 1.0;
        const double clamped = std::clamp(value, 0.0, kLargestExponent);
        if (clamped != value) {
            note(Warning::kMaterialValue, "Ns",
                 fmt::format("Ns {} is outside [0, {}]; {} is taken", value, kLargestExponent,
                             clamped));
        }
        return static_cast<float>(clamped);
    }

    void dropDiffuse(const char* kind) {
        // Boxes in common use give their spheres a Kd of 0.01; that much is not worth a line.
        constexpr float kWorthALine = 0.02f;
        const bool isGiven = given("Kd") || m_material.diffuseTexture;
        if (isGiven && *std::ranges::max_element(m_material.diffuse) > kWorthALine) {
            note(Warning::kMaterialPart, "Kd",
                 fmt::format("the diffuse part of a {} is not rendered and left out", kind));
        }
        m_material.diffuse = {};
        m_material.diffuseTexture.reset();
    }

    // No surface may reflect more than it gets.
    void limitSum() {
        float largest = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            largest = std::max(largest, m_material.diffuse[i] + m_material.glossy[i]);
        }
        constexpr float kRounding = 1e-5f;
        if (largest <= 1.0f) return;
        if (largest > 1.0f + kRounding) {
            note(Warning::kMaterialValue, "Ks",
                 fmt::format("Kd + Ks reach {} in a channel; both are divided by it", largest));
        }
        for (std::size_t i = 0; i < 3; ++i) {
            m_material.diffuse[i] /= largest;
            m_material.glossy[i] /= largest;
        }
    }

    const MtlSection& m_section;
    const std::string& m_file;
    const std::filesystem::path& m_folder;
    const WarningSink& m_warn;
    tinyobj::material_t m_parsed;
    MaterialData m_material;
    float m_opacity{1.0f};
};

}  // namespace

MaterialData defaultMaterial(const std::string& name) {
    MaterialData material;
    material.name = name;
    return material;
}

std::map<std::string, MaterialData> readMaterials(std::string_view mtlText,
                                                  const std::string& fileName,
                                                  const std::filesystem::path& folder,
                                                  const WarningSink& warn,
                                                  const NameFilter& isUsed) {
    std::map<std::string, MaterialData> materials;
    for (const MtlSection& section : readMtlText(mtlText)) {
        if (isUsed && !isUsed(section.name)) continue;
        if (materials.contains(section.name)) {
            warn(Warning::kMaterialValue,
                 fmt::format("{}:{}: material {} is defined twice; the first counts", fileName,
                             section.lines.at("newmtl"), section.name));
            continue;
        }
        materials.emplace(section.name, MaterialReader(section, fileName, folder, warn).read());
    }
    return materials;
}

}  // namespace pm::host
