// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/mtl/material_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "host_shim/formats/mtl/material_layers.h"
#include "host_shim/formats/mtl/material_maps.h"
#include "host_shim/formats/mtl/mtl_keys.h"
#include "host_shim/formats/mtl/mtl_text.h"

namespace pm::host {
namespace {

// Exponents above are as sharp as float directions can tell.
constexpr double kLargestExponent = 1e7;
constexpr double kLargestIor = 100.0;

bool isBlack(const std::array<float, 3>& colour) {
    return colour[0] == 0 && colour[1] == 0 && colour[2] == 0;
}

float largestOf(const std::array<float, 3>& colour) {
    return std::ranges::max(colour);
}

// Turns one section into a material.
class MaterialReader {
  public:
    MaterialReader(MtlSection section, const MtlSource& source, SceneFiles& files,
                   const WarningSink& warn)
        : m_section(std::move(section)), m_source(source), m_files(files), m_warn(warn) {}

    MaterialData read() {
        m_material.name = m_section.name;
        for (const auto& [key, text] : m_section.notUnderstood)
            note(Warning::kMaterialValue, key,
                 fmt::format("'{}' is not understood and left out", text));
        rememberNumbers();
        const Translation translation = translateToGeneric(m_source.dialect, m_section);
        for (const DialectNote& told : translation.notes)
            note(Warning::kMaterialPart, told.key, told.text);
        const MaterialNote tell = [this](Warning code, const std::string& key,
                                         const std::string& text) { note(code, key, text); };
        noteLeftOut(m_section, tell);
        noteIllum();
        readMaps();
        brighten(m_material.diffuseTexture, translation.diffuseGain);
        limitStrengths(m_material, tell);
        readColours();
        decideKind();
        readKind();
        readLayers(m_section, translation, m_material, tell);
        limitSum();
        return std::move(m_material);
    }

    // A map of the section alone, for what is made of several materials.
    Boxed<TextureUse> readMapAlone(const std::string& key) {
        m_material.name = m_section.name;
        return map(key.c_str(), true);
    }

  private:
    bool given(const char* key) const {
        return m_section.colours.contains(key) || m_section.numbers.contains(key);
    }

    double number(const char* key, double otherwise) const {
        return m_section.number(key).value_or(otherwise);
    }

    int illum() const {
        constexpr double kLargest = 1e6;
        return static_cast<int>(std::clamp(number("illum", -1), -kLargest, kLargest));
    }

    // FILE:LINE of a statement, or where the material begins.
    std::string place(const std::string& key) const {
        const auto found = m_section.lines.find(key);
        return fmt::format(
            "{}:{}", m_source.fileName,
            found != m_section.lines.end() ? found->second : m_section.lines.at("newmtl"));
    }

    void note(Warning code, const std::string& key, const std::string& text) const {
        m_warn(code, fmt::format("{}: material {}: {}", place(key), m_material.name, text));
    }

    void rememberNumbers() {
        const bool standAlone = picturesStandAlone(m_source.dialect);
        for (const char* key : {"Kd", "Ks", "Pr"})
            if (given(key) && !standAlone) m_numbersGiven.insert(key);
        if (m_section.hasMap("map_Kd")) m_diffuseMap = m_section.maps.at("map_Kd");
    }

    // What stands for a picture that can't be read, times the number beside it: no light, and where
    // no number is given what new materials have in the programs that leave it out.
    float missing(const std::string& key) const {
        constexpr float kUsualGrey = 0.8f, kUsual = 0.5f;
        if (key == "map_Ke") return 0;
        // As if nobody had spoken of a picture.
        if (key == "map_Pm" || key == "refl" || key == "map_refl")
            return static_cast<float>(std::clamp(number("Pm", 0), 0.0, 1.0));
        const bool isBase = m_section.maps.at(key) == m_diffuseMap;
        const std::string number = isBase ? "Kd" : key.substr(std::string_view("map_").size());
        if (m_numbersGiven.contains(number)) return 1;
        if (isBase) return kUsualGrey;
        return number == "Ks" || number == "Pr" ? kUsual : 1;
    }

    // The factor that its texels have beside the number, which is at most 1.
    static void brighten(Boxed<TextureUse>& use, double factor) {
        if (!use) return;
        const auto gain = static_cast<float>(factor);
        use->base *= gain;
        use->gain *= gain;
        use->missing *= gain;
    }

    Boxed<TextureUse> map(const char* key, bool isData) {
        const auto found = m_section.maps.find(key);
        if (found == m_section.maps.end()) return std::nullopt;
        MaterialMap map = readMap(found->second, m_source.folder, isData, m_files);
        for (const std::string& option : map.line.leftOut)
            note(Warning::kTexture, key,
                 fmt::format("the option {} of {} is not rendered yet and left out", option, key));
        if (map.line.name.empty()) {
            note(Warning::kTexture, key, fmt::format("{} names no file", key));
            return std::nullopt;
        }
        if (map.isMissing && !m_files.isTrusted()) {
            m_without[key] = missing(key);
            note(Warning::kTexture, key,
                 fmt::format("{}: {}; {}", key, m_files.whyNone(m_source.folder, map.line.name),
                             withoutPicture(m_without[key])));
            return std::nullopt;
        }
        map.use.place = place(key);
        map.use.missing = missing(key);
        return map.use;
    }

    void readMaps() {
        m_material.diffuseTexture = map("map_Kd", false);
        m_material.glossyTexture = map("map_Ks", false);
        m_material.glossyExponentTexture = map("map_Ns", true);
        m_material.roughnessTexture = map("map_Pr", true);
        m_material.opacityTexture = map("map_d", true);
        m_material.emissionTexture = map("map_Ke", false);
        m_material.normalTexture = map("norm", true);
        if (m_material.normalTexture && m_material.normalTexture->channel != '\0') {
            note(Warning::kTexture, "norm",
                 "the option -imfchan of norm is left out: a normal has three channels");
            m_material.normalTexture->channel = '\0';
        }
        m_material.bumpTexture = map("map_bump", true);
        m_material.displacementTexture = map("disp", true);
        m_material.transmissionTexture = map("map_Tf", false);
    }

    // What is left of the number beside a map that was lost.
    float without(const std::string& mapKey) const {
        const auto found = m_without.find(mapKey);
        return found == m_without.end() ? 1 : found->second;
    }

    void noteIllum() const {
        if (given("illum") && (illum() < 0 || illum() > 10)) {
            note(Warning::kMaterialValue, "illum",
                 fmt::format("illum {} is outside [0, 10] and left out", illum()));
        }
    }

    // The number beside a map multiplies it, so one that is not given counts as 1.
    std::array<float, 3> colour(const char* key) const {
        const std::string mapKey = fmt::format("map_{}", key);
        const bool hasMap = m_section.hasMap(mapKey);
        const auto value = m_section.colour(key);
        if (!value && !hasMap) return {};
        if (!value) return std::array{without(mapKey), without(mapKey), without(mapKey)};
        std::array<float, 3> rounded{static_cast<float>((*value)[0]),
                                     static_cast<float>((*value)[1]),
                                     static_cast<float>((*value)[2])};
        if (hasMap && isBlack(rounded)) {
            note(Warning::kMaterialValue, key,
                 fmt::format("{} 0 0 0 multiplies {}, so the map has no effect", key, mapKey));
        }
        for (float& channel : rounded) channel *= without(mapKey);
        return rounded;
    }

    void readColours() {
        m_material.diffuse = reflectance("Kd", colour("Kd"));
        m_material.glossy = reflectance("Ks", colour("Ks"));
        m_material.emission = colour("Ke");
        m_material.emitsFromBothSides = emitsFromBothSides(m_source.dialect);
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
        const bool saysNothing =
            std::ranges::none_of(std::array{"Kd", "Ks", "Ke", "Tf"},
                                 [this](const char* key) { return given(key); }) &&
            !m_material.diffuseTexture && !m_material.glossyTexture && !m_material.emissionTexture;
        if (saysNothing) m_material.diffuse = defaultMaterial("").diffuse;
    }

    std::array<float, 3> reflectance(const char* key, std::array<float, 3> value) const {
        std::array<float, 3> clamped = value;
        for (float& channel : clamped) channel = channel > 0 ? std::min(channel, 1.0f) : 0.0f;
        if (clamped == value) return value;
        constexpr float kOfBytes = 2.0f;
        note(Warning::kMaterialValue, key,
             fmt::format("{} {} {} {} is outside [0,1]; {} {} {} is taken{}", key, value[0],
                         value[1], value[2], clamped[0], clamped[1], clamped[2],
                         largestOf(value) > kOfBytes
                             ? " (numbers from 0 to 255 have to be divided by 255)"
                             : ""));
        return clamped;
    }

    // d wins over Tr, whichever comes first.
    double opacity() const {
        const double value = number("d", 1 - number("Tr", 0));
        const double clamped = std::clamp(value, 0.0, 1.0);
        if (clamped != value) {
            note(Warning::kMaterialValue, opacityKey(),
                 fmt::format("opacity {} is outside [0,1]; {} is taken", value, clamped));
        }
        return clamped;
    }

    const char* opacityKey() const { return given("d") ? "d" : "Tr"; }

    // Of what nothing is said but what it lets through: Tf beside Kd 0, by hand. Programs write
    // illum and d as well, and any Tf.
    bool isClearByTf() const {
        const bool isBare = given("Kd") && isBlack(m_material.diffuse) &&
                            !m_material.diffuseTexture && isBlack(m_material.emission) &&
                            !m_material.emissionTexture;
        if (!isBare || !given("Tf") || !(largestOf(colour("Tf")) > 0)) return false;
        if (!given("illum")) return true;
        return illum() <= 2 && isBlack(m_material.glossy) && number("Ni", 1) != 1 && !given("d") &&
               !given("Tr");
    }

    void decideKind() {
        const bool reflects = !isBlack(m_material.glossy);
        m_opacity = static_cast<float>(opacity());
        const bool hasIor = number("Ni", 1) != 1;
        const int model = illum();
        if (model == 4 || model == 6 || model == 7 || (m_opacity < 1 && hasIor) ||
            (m_opacity == 1 && isClearByTf())) {
            m_material.kind = MaterialKind::kDielectric;
        } else if ((model == 3 || model == 5) && reflects) {
            m_material.kind = MaterialKind::kMirror;
            m_material.fresnel = model == 5;
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
            note(Warning::kMaterialValue, opacityKey(),
                 "fully transparent, so it can't be seen (d 1 or Tr 0 is opaque)");
        }
        if (m_material.kind == MaterialKind::kMirror) {
            readMirror();
        } else {
            readLobe();
        }
    }

    void readRoughness() {
        const double value =
            number("Pr", m_section.hasMap("map_Pr") ? 1 : 0) * double{without("map_Pr")};
        m_material.roughness = static_cast<float>(std::clamp(value, 0.0, 1.0));
        if (static_cast<double>(m_material.roughness) != value && (value < 0 || value > 1))
            note(Warning::kMaterialValue, "Pr",
                 fmt::format("Pr {} is outside [0,1]; {} is taken", value, m_material.roughness));
        if (m_material.roughness > 0) m_material.glossyExponentTexture.reset();
    }

    void readDielectric() {
        readRoughness();
        m_material.transmission = {1, 1, 1};
        if (given("Tf") || m_section.hasMap("map_Tf")) {
            m_material.transmission = reflectance("Tf", colour("Tf"));
            noteDarkGlass();
        }
        const double ior = number("Ni", 1.5);
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

    // Programs that don't let light through glass write any Tf.
    void noteDarkGlass() const {
        constexpr float kDark = 0.3f;
        const float most = largestOf(m_material.transmission);
        if (most == 0) {
            note(Warning::kMaterialValue, "Tf",
                 "this glass lets nothing through, so it is black (Tf 1 1 1 is clear)");
        } else if (most < kDark) {
            note(
                Warning::kMaterialValue, "Tf",
                fmt::format("this glass lets {:.2g} through at each boundary and {:.2g} at two, so "
                            "it looks black (Tf 1 1 1 is clear)",
                            most, most * most));
        }
    }

    void readMirror() {
        dropDiffuse("mirror");
        readRoughness();
        if (m_material.roughness > 0) return;
        if (m_material.fresnel) {
            m_material.glossyExponentTexture.reset();
        } else {
            // 0 would mean a perfect mirror, and Ns 0 means the roughest.
            if (hasExponent()) m_material.glossyExponent = std::max(exponent(), 1e-3f);
        }
    }

    void readLobe() {
        const bool noLobe = illum() == 0 || illum() == 1;
        if (!noLobe && !isBlack(m_material.glossy)) readRoughness();
        if (m_material.roughness > 0) return;
        m_material.roughnessTexture.reset();
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
        const double value = number("Ns", 1);
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
        if (isGiven && largestOf(m_material.diffuse) > kWorthALine) {
            note(Warning::kMaterialPart, "Kd",
                 fmt::format("the diffuse part of a {} is not rendered and left out", kind));
        }
        m_material.diffuse = {};
        m_material.diffuseTexture.reset();
    }

    // No surface may reflect more than it gets; what is below a coat of facets gets what that
    // leaves.
    void limitSum() {
        if (m_material.roughness > 0) return;
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

    MtlSection m_section;
    const MtlSource& m_source;
    SceneFiles& m_files;
    const WarningSink& m_warn;
    MaterialData m_material;
    float m_opacity{1.0f};
    // Beside which a picture was meant to be; and that of the colour, whatever it became.
    std::set<std::string> m_numbersGiven;
    std::string m_diffuseMap;
    std::map<std::string, float> m_without;  // keys of lost pictures -> missing()
};

}  // namespace

MaterialData readSection(MtlSection section, const MtlSource& source, SceneFiles& files,
                         const WarningSink& warn) {
    return MaterialReader(std::move(section), source, files, warn).read();
}

Boxed<TextureUse> readMapOfNumbers(const MtlSection& section, const std::string& key,
                                   const MtlSource& source, SceneFiles& files,
                                   const WarningSink& warn) {
    return MaterialReader(section, source, files, warn).readMapAlone(key);
}

}  // namespace pm::host
