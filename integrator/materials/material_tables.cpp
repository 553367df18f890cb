// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/materials/material_tables.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "integrator/materials/layers.h"

namespace pm {

namespace {

// One kind of table, each made once a key.
template <typename Key, typename Table>
class Made {
  public:
    explicit Made(MaterialTables& tables) : m_tables(tables) {}

    template <typename Make>
    const Table* of(const Key& key, const Make& make) {
        const Table*& known = m_known[key];
        if (known) return known;
        const auto table = std::make_shared<const Table>(make());
        m_tables.made.push_back(table);
        return known = table.get();
    }

  private:
    MaterialTables& m_tables;
    std::map<Key, const Table*> m_known;
};

bool needsOne(const MaterialDescription& material) {
    return isRoughGlass(material) || isLayered(material) || isStretched(material);
}

// The indices by which glass stands against what is on the other side of rough glass.
std::set<float> indicesOfGlass(std::span<const MaterialDescription> materials, bool mayTouch) {
    std::set<float> indices;
    for (const MaterialDescription& rough : materials) {
        if (!isRoughGlass(rough)) continue;
        indices.insert(rough.ior);
        for (const MaterialDescription& other : materials)
            if (mayTouch && other.kind == MaterialKind::kDielectric) {
                indices.insert(rough.ior / other.ior);
                indices.insert(other.ior / rough.ior);
            }
    }
    return indices;
}

}  // namespace

const GlassAlbedo* MaterialTables::glassOf(float ior) const {
    if (glass.empty()) return nullptr;
    const auto off = [&](const auto& table) { return std::abs(table->ior() - ior); };
    return std::ranges::min_element(glass, {}, off)->get();
}

MaterialTables makeMaterialTables(std::span<const MaterialDescription> materials, bool mayTouch,
                                  const CancelCheck& cancel) {
    MaterialTables tables;
    if (std::ranges::none_of(materials, needsOne)) return tables;
    for (const float ior : indicesOfGlass(materials, mayTouch)) {
        cancel.throwIfSet("building the scene");
        tables.glass.push_back(std::make_shared<const GlassAlbedo>(ior));
    }
    Made<std::tuple<float, float, float, float, float>, LayerPass> passes(tables);
    Made<float, StretchedAlbedo> stretched(tables);
    for (const MaterialDescription& m : materials) {
        cancel.throwIfSet("building the scene");
        TablesOf& of = tables.all.emplace_back();
        if (isRoughGlass(m)) of.glass = tables.glassOf(m.ior);
        if (isLayered(m))
            of.pass = passes.of(
                {m.coat, m.coatRoughness, m.coatIor, maxChannel(m.sheen), m.sheenRoughness},
                [&] { return LayerPass([&](float cosine) { return passesTop(m, cosine); }); });
        if (isStretched(m))
            of.stretched =
                stretched.of(stretchOf(m), [&] { return StretchedAlbedo(stretchOf(m)); });
    }
    return tables;
}

}  // namespace pm
