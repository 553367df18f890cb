// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host_shim/formats/mtl/coat_albedo.h"
#include "host_shim/formats/mtl/mtl_dialect.h"

namespace pm::host {
namespace {

using Colour = std::array<double, 3>;

Colour operator*(const Colour& colour, double factor) {
    return {colour[0] * factor, colour[1] * factor, colour[2] * factor};
}

double mean(const Colour& colour) {
    return (colour[0] + colour[1] + colour[2]) / 3;
}

// Never written by Blender: somebody made glass or a mirror of it, and means what it says.
bool isByHand(double illum) {
    return illum == 4 || illum == 5 || illum == 7;
}

// How much of a surface is glass; from this share on all of it is taken as glass.
constexpr double kLeastGlass = 0.5;
double glassShare(const MtlSection& section) {
    return mean(section.colour("Tf").value_or(Colour{}));
}

// Blender's Principled BSDF as its exporters write it.
class PrincipledSection {
    // What is smoother is a mirror's; 0 would mean that an exponent says it.
    static constexpr double kLeastRoughness = 0.01;
    static constexpr double kUsualRoughness = 0.5;  // Blender's own default

  public:
    // isBlenders: by its own exporter.
    PrincipledSection(MtlDialect dialect, MtlSection& section, bool isBlenders = true)
        : m_dialect(dialect), m_section(section), m_isBlenders(isBlenders) {}

    Translation translate() {
        // What its exporters call a bump map is the picture of a normal map.
        if (m_isBlenders && m_section.hasMap("map_bump") && !m_section.hasMap("norm"))
            moveMap("map_bump", "norm");
        const double illum = m_section.number("illum").value_or(2);
        if (isByHand(illum)) return {};
        if (picturesStandAlone(m_dialect)) dropReplacedNumbers();
        m_isMetalOn = illum == 3 || illum == 6 || illum == 8;
        if (illum != 0) m_section.numbers["illum"] = 2;
        setLayers();
        if (isGlass())
            makeGlass();
        else
            makeSurface();
        return std::move(m_translation);
    }

  private:
    void note(const char* key, std::string text) {
        m_translation.notes.push_back({key, std::move(text)});
    }

    double number(const char* key, double otherwise) const {
        return m_section.number(key).value_or(otherwise);
    }

    void drop(const char* key) {
        m_section.colours.erase(key);
        m_section.numbers.erase(key);
        m_section.maps.erase(key);
    }

    // Which is there under its name, with its line, goes under another.
    void moveMap(const std::string& from, const std::string& to) {
        m_section.maps[to] = m_section.maps[from];
        if (m_section.lines.contains(from)) m_section.lines[to] = m_section.lines[from];
        m_section.maps.erase(from);
    }

    // What MTL does not say of them is as Blender has it where nobody changes it.
    void setLayers() {
        if (m_dialect == MtlDialect::kBlender4) {
            m_translation.sheenRoughness = 0.5;
            return;
        }
        // A clear coat covers a quarter at most, and sheen is half tinted by the colour below.
        if (const auto coat = m_section.number("Pc")) m_section.numbers["Pc"] = 0.25 * *coat;
        const Colour base = m_section.colour("Kd").value_or(Colour{1, 1, 1});
        const double luminance = 0.2126 * base[0] + 0.7152 * base[1] + 0.0722 * base[2];
        for (std::size_t i = 0; luminance > 0 && i < 3; ++i)
            m_translation.sheenTint[i] = std::min(1.0, 0.5 + 0.5 * base[i] / luminance);
    }

    // What is linked to a picture has a number all the same, which is written and means nothing.
    void dropReplacedNumbers() {
        for (const char* key : {"Kd", "Ks", "Ke"}) {
            const std::string map = fmt::format("map_{}", key);
            const auto given = m_section.colour(key);
            if (!given || !m_section.hasMap(map)) continue;
            if (*given == Colour{})
                note(key, fmt::format("{} 0 0 0 beside {} says nothing in a file of Blender's: the "
                                      "picture is taken alone (--mtl-dialect generic multiplies)",
                                      key, map));
            m_section.colours.erase(key);
        }
    }

    // A picture of it, by either key: what Blender calls one of exponents is its own of roughness.
    bool keepsRoughnessMap() {
        if (m_isBlenders && m_section.hasMap("map_Ns") && !m_section.hasMap("map_Pr"))
            moveMap("map_Ns", "map_Pr");
        m_section.maps.erase("map_Ns");
        return m_section.hasMap("map_Pr");
    }

    double roughness() const {
        if (const auto given = m_section.number("Pr")) return std::clamp(*given, 0.0, 1.0);
        const auto exponent = m_section.number("Ns");
        if (!exponent) return kUsualRoughness;
        const double largest = m_dialect == MtlDialect::kBlender28 ? 900 : 1000;
        return 1 - std::sqrt(std::clamp(*exponent / largest, 0.0, 1.0));
    }

    // What the picture of roughness is multiplied by.
    double ofRoughnessMap() const {
        return picturesStandAlone(m_dialect) ? 1 : std::clamp(number("Pr", 1), 0.0, 1.0);
    }

    double metallic() {
        if (const auto given = m_section.number("Pm")) return std::clamp(*given, 0.0, 1.0);
        if (!m_isMetalOn) return 0;
        return std::clamp(mean(m_section.colour("Ka").value_or(Colour{1, 1, 1})), 0.0, 1.0);
    }

    // What a surface that is no metal reflects at normal incidence.
    Colour specular() const {
        const double usual = m_section.hasMap("map_Ks") ? 1 : 0.5;
        const Colour level = m_section.colour("Ks").value_or(Colour{usual, usual, usual});
        if (m_dialect != MtlDialect::kBlender4) return level * 0.08;
        const double ior = number("Ni", 1.5);
        const double root = ior > 0 ? (ior - 1) / (ior + 1) : 0;
        return level * (2 * root * root);
    }

    // Tf is how much of it lets light through as glass does.
    bool isGlass() {
        const double share = glassShare(m_section);
        if (share > 0 && share < kLeastGlass)
            note("Tf", fmt::format("{:g} of it would be glass, which is not rendered together with "
                                   "what is none; all is taken as none",
                                   share));
        return share >= kLeastGlass;
    }

    void makeGlass() {
        const bool hasRoughnessMap = keepsRoughnessMap();
        const double rough = hasRoughnessMap ? ofRoughnessMap() : roughness();
        Colour tint = m_section.colour("Kd").value_or(Colour{1, 1, 1});
        // Who writes by hand says by Tf what it lets through, and by Kd 0 that nothing else is
        // there.
        const bool isTintedByTf = !m_isBlenders && mean(tint) == 0 && !m_section.hasMap("map_Kd");
        if (isTintedByTf) tint = *m_section.colour("Tf");
        // Since Blender 4 it is the colour of a way through two boundaries.
        if (m_dialect == MtlDialect::kBlender4 && !isTintedByTf)
            for (double& channel : tint) channel = std::sqrt(std::max(channel, 0.0));
        if (m_section.hasMap("map_Kd")) m_section.maps["map_Tf"] = m_section.maps["map_Kd"];
        for (const char* key : {"Kd", "map_Kd", "Ks", "map_Ks", "Pm", "Ns"}) drop(key);
        if (!hasRoughnessMap) drop("Pr");
        if (rough > 0) m_section.numbers["Pr"] = rough;
        m_section.colours["Tf"] = tint;
        m_section.numbers["illum"] = 7;
        if (!m_section.number("Ni")) m_section.numbers["Ni"] = 1.45;
    }

    // What reflects at the surface is a coat of facets over the diffuse part.
    void makeSurface() {
        const double metal = metallic();
        constexpr double kWholly = 0.999;
        const bool hasRoughnessMap = keepsRoughnessMap();
        const double factor = hasRoughnessMap ? ofRoughnessMap() : roughness();
        // The picture's own mean isn't known here.
        const double rough = hasRoughnessMap ? factor * kUsualRoughness : factor;
        const Colour base = m_section.colour("Kd").value_or(Colour{1, 1, 1});
        const Colour specular = this->specular();
        for (const char* key : {"Pm", "Ns", "Tf"}) drop(key);
        if (!hasRoughnessMap) drop("Pr");
        // Of what is cut away light goes straight on, whatever the index.
        drop("Ni");
        if (metal >= kWholly) return makeMetal(base, factor);
        Colour coat{};
        for (std::size_t i = 0; i < 3; ++i)
            coat[i] = std::min(1.0, metal * base[i] + (1 - metal) * specular[i]);
        const double below =
            m_dialect == MtlDialect::kBlender4 ? passedBy(specular, rough) : meanOfDiffuse(rough);
        // Of a picture the mean isn't known here.
        constexpr double kUsualTexel = 0.5;
        const bool hasPicture = m_section.hasMap("map_Kd");
        Colour usualCoat = coat;
        if (hasPicture)
            for (std::size_t i = 0; i < 3; ++i)
                usualCoat[i] = metal * kUsualTexel * base[i] + (1 - metal) * specular[i];
        const double passes = below / passedBy(usualCoat, rough);
        Colour diffuse{};
        // Texels may be as bright as the factor leaves room for.
        if (hasPicture) m_translation.diffuseGain = passes;
        for (std::size_t i = 0; i < 3; ++i)
            diffuse[i] = std::min(1.0, (1 - metal) * base[i] * (hasPicture ? 1 : passes));
        m_section.colours["Kd"] = diffuse;
        m_section.colours["Ks"] = coat;
        m_section.numbers["Pr"] = std::max(factor, kLeastRoughness);
        if (metal >= 0.5 && m_section.hasMap("map_Kd"))
            m_section.maps["map_Ks"] = m_section.maps["map_Kd"];
    }

    // What a coat leaves of even light. Before Blender 4 what is below gets all, whatever the coat
    // reflects; the renderer's gets what that leaves, so its colour is the brighter.
    static double passedBy(const Colour& coat, double rough) {
        const double largest = std::max({coat[0], coat[1], coat[2]});
        return largest > 0 ? std::max(0.01, 1 - meanOfCoat(largest, rough)) : 1;
    }

    // Before Blender 4 the diffuse part is Burley's, which shines at grazing angles where it is
    // rough and darkens there where it is smooth; that is what it reflects of even light, within
    // .001.
    static double meanOfDiffuse(double rough) { return 0.953 + 0.1122 * rough; }

    // Blender's metals reflect their colour at normal incidence and all at grazing angles.
    void makeMetal(const Colour& base, double rough) {
        if (m_section.hasMap("map_Kd")) m_section.maps["map_Ks"] = m_section.maps["map_Kd"];
        drop("Kd");
        drop("map_Kd");
        m_section.colours["Ks"] = base;
        m_section.numbers["illum"] = 5;
        if (rough > 0) m_section.numbers["Pr"] = rough;
    }

    MtlDialect m_dialect;
    MtlSection& m_section;
    bool m_isBlenders;
    Translation m_translation;
    bool m_isMetalOn{};
};

// Programs whose Ks is the colour of a highlight that comes on top: colours keep what they are,
// and the lobe gets no more than is left.
void keepDiffuse(MtlSection& section) {
    auto glossy = section.colour("Ks");
    const auto diffuse = section.colour("Kd");
    if (!glossy || !diffuse) return;
    double factor = 1;
    for (std::size_t i = 0; i < 3; ++i) {
        const double left = std::max(0.0, 1 - (*diffuse)[i]);
        if ((*glossy)[i] > left) factor = std::min(factor, left / (*glossy)[i]);
    }
    section.colours["Ks"] = *glossy * factor;
}

void dropHighlight(MtlSection& section) {
    section.colours.erase("Ks");
    section.maps.erase("map_Ks");
}

// Every material has Ni 1.5, glass or not: so of what is transparent light goes straight on,
// unless somebody chose a kind of glass or another index.
void translate3dsMax(MtlSection& section) {
    keepDiffuse(section);
    const double illum = section.number("illum").value_or(2);
    if (illum <= 2 && section.number("Ni") == 1.5) section.numbers.erase("Ni");
}

// illum 4 stands on everything, and Tf is what is left of 1 by the transparency.
void translateMaya(MtlSection& section) {
    keepDiffuse(section);
    if (section.number("illum") == 4) section.numbers["illum"] = 2;
    const auto opacity = section.colour("Tf");
    section.colours.erase("Tf");
    if (!opacity || section.number("d") || section.number("Tr")) return;
    const double mostly = std::clamp(mean(*opacity), 0.0, 1.0);
    section.numbers["d"] = mostly;
    if (section.lines.contains("Tf")) section.lines["d"] = section.lines["Tf"];
    if (mostly < 1)
        section.colours["Tf"] = {1 - std::clamp((*opacity)[0], 0.0, 1.0),
                                 1 - std::clamp((*opacity)[1], 0.0, 1.0),
                                 1 - std::clamp((*opacity)[2], 0.0, 1.0)};
}

// Tf 0 0 0 stands on everything, and Ns 0 on what has no gloss.
void translateRhino(MtlSection& section) {
    keepDiffuse(section);
    section.colours.erase("Tf");
    if (section.number("Ns").value_or(0) <= 0) dropHighlight(section);
}

}  // namespace

std::optional<MetalMap> metalMapOf(MtlDialect dialect, const MtlSection& section) {
    const bool isBlenders = emitsFromBothSides(dialect);
    if (!isBlenders && dialect != MtlDialect::kGeneric) return std::nullopt;
    if (isByHand(section.number("illum").value_or(2)) || glassShare(section) >= kLeastGlass)
        return std::nullopt;
    for (const char* key : {"map_Pm", "refl", "map_refl"}) {
        if (!section.hasMap(key) || (!isBlenders && key != std::string_view("map_Pm"))) continue;
        const double factor = std::clamp(section.number("Pm").value_or(1), 0.0, 1.0);
        return MetalMap{key, picturesStandAlone(dialect) ? 1 : factor};
    }
    return std::nullopt;
}

bool emitsFromBothSides(MtlDialect dialect) {
    return dialect == MtlDialect::kBlender28 || dialect == MtlDialect::kBlender3 ||
           dialect == MtlDialect::kBlender4;
}

bool picturesStandAlone(MtlDialect dialect) {
    return dialect == MtlDialect::kBlender28 || dialect == MtlDialect::kBlender3;
}

Translation translateToGeneric(MtlDialect dialect, MtlSection& section) {
    switch (dialect) {
        case MtlDialect::kBlender28:
        case MtlDialect::kBlender3:
        case MtlDialect::kBlender4:
            return PrincipledSection(dialect, section).translate();
        case MtlDialect::k3dsMax:
            translate3dsMax(section);
            break;
        case MtlDialect::kMaya:
            translateMaya(section);
            break;
        case MtlDialect::kRhino:
            translateRhino(section);
            break;
        case MtlDialect::kSketchUp:
            dropHighlight(section);  // Ks .33 on everything
            break;
        case MtlDialect::kBlender27:
        case MtlDialect::kZBrush:
            keepDiffuse(section);
            break;
        case MtlDialect::kGeneric:
            // The keys for physically based materials mean what Blender's do; who says how a mirror
            // or glass is rough needs no more than that.
            if (section.number("Pm") || section.hasMap("map_Pm") ||
                ((section.number("Pr") || section.hasMap("map_Pr")) &&
                 section.number("illum").value_or(2) <= 2))
                return PrincipledSection(MtlDialect::kBlender4, section, false).translate();
            break;
        case MtlDialect::kMcGuire:
            break;
    }
    return {};
}

}  // namespace pm::host
