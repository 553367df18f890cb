// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/materials/material_tables.h"

#include <algorithm>
#include <map>
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

}  // namespace

MaterialTables makeMaterialTables(std::span<const MaterialDescription> materials,
                                  const CancelCheck& cancel) {
    MaterialTables tables;
    if (std::ranges::none_of(materials, needsOne)) return tables;
    Made<float, GlassAlbedo> glass(tables);
    Made<std::tuple<float, float, float, float, float>, LayerPass> passes(tables);
    Made<float, StretchedAlbedo> stretched(tables);
    for (const MaterialDescription& m : materials) {
        cancel.throwIfSet("building the scene");
        TablesOf& of = tables.all.emplace_back();
        if (isRoughGlass(m)) of.glass = glass.of(m.ior, [&] { return GlassAlbedo(m.ior); });
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
