// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Scene::Media: which bodies there are, and whether they matter.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <span>

#include "integrator/scene/closed_body.h"
#include "integrator/scene/media.h"
#include "integrator/scene/shape_record.h"

namespace pm {

namespace {

bool overlap(const Box3d& a, const Box3d& b) {
    for (int axis = 0; axis < 3; ++axis)
        if (!(a.lo[axis] <= b.hi[axis] && b.lo[axis] <= a.hi[axis])) return false;
    return true;
}

// The faces of one material on one shape.
struct Part {
    std::uint32_t shape, material;
    Box3d box;
    bool matters = false;
};

}  // namespace

class Scene::Media::Search {
  public:
    Search(const Scene& scene, std::vector<Notice>& notices, const CancelCheck& cancel)
        : m_scene(scene), m_notices(notices), m_cancel(cancel), m_boxes(scene.m_shapes.size()) {}

    // False: faces alone say all.
    bool findParts() {
        for (std::uint32_t shape = 0; shape < m_scene.m_shapes.size(); ++shape) addParts(shape);
        for (Part& part : m_parts) part.matters = matters(part);
        return std::ranges::any_of(m_parts, &Part::matters);
    }

    void addAllBodies(Media& media) {
        media.m_ofShape.resize(m_scene.m_shapes.size());
        std::map<std::uint32_t, std::vector<const Part*>> byMaterial;
        for (const Part& part : m_parts) byMaterial[part.material].push_back(&part);
        for (const auto& [material, parts] : byMaterial) addBodies(material, parts, media);
    }

  private:
    void addParts(std::uint32_t shape) {
        const ShapeRecord& record = m_scene.m_shapes[shape];
        m_cancel.throwIfSet("looking for media");
        std::vector<Part> here;
        const std::size_t count = record.mesh     ? record.mesh->triangles.size()
                                  : record.groups ? record.groups->groupCount()
                                                  : 1;
        for (std::uint32_t at = 0; at < count; ++at) {
            const std::uint32_t i = record.groups ? record.groups->firstTriangle(at) : at;
            Box3d box;
            record.bounds(i, box.lo, box.hi);
            m_boxes[shape].grow(box);
            const std::uint32_t material = record.materialOf(i);
            if (!m_scene.traits(material).fillsItsInside) continue;
            auto found = std::ranges::find(here, material, &Part::material);
            if (found == here.end()) found = here.insert(found, {shape, material, {}});
            found->box.grow(box);
        }
        std::ranges::copy(here, std::back_inserter(m_parts));
    }

    bool matters(const Part& part) const {
        const auto isOther = [&](const Part& other) {
            return (other.shape != part.shape || other.material != part.material) &&
                   overlap(part.box, other.box);
        };
        if (std::ranges::any_of(m_parts, isOther)) return true;
        if (!m_scene.traits(part.material).absorbs) return false;
        for (std::uint32_t shape = 0; shape < m_boxes.size(); ++shape)
            if (shape != part.shape && overlap(part.box, m_boxes[shape])) return true;
        if (m_scene.m_shapes[part.shape].materials.size() > 1) return true;
        const Part* const alone = &part;
        return !m_scene.m_shapes[part.shape].curved && look({&alone, 1}).openEdges > 0;
    }

    BodyShape look(std::span<const Part* const> parts) const {
        return lookAtBody(
            [&](const std::function<void(const std::array<Vec3d, 3>&)>& visit) {
                for (const Part* const part : parts) visitFaces(*part, visit);
            },
            m_cancel);
    }

    void visitFaces(const Part& part,
                    const std::function<void(const std::array<Vec3d, 3>&)>& visit) const {
        const ShapeRecord& record = m_scene.m_shapes[part.shape];
        // The cage is closed where its limit is.
        if (record.groups) {
            const auto turned = [&](const std::array<Vec3d, 3>& t) {
                visit(record.mirrored ? std::array{t[0], t[2], t[1]} : t);
            };
            for (std::uint32_t slot = 0; slot < record.materials.size(); ++slot)
                if (record.materials[slot] == part.material)
                    record.groups->forEachCageTriangle(slot, turned);
            return;
        }
        for (std::uint32_t i = 0; i < record.mesh->triangles.size(); ++i) {
            if (record.materialOf(i) != part.material) continue;
            const Corner c = record.corner(i);
            const Vec3d second = c.vertex + c.e1, third = c.vertex + c.e2;
            visit(record.mirrored ? std::array{c.vertex, third, second}
                                  : std::array{c.vertex, second, third});
        }
    }

    // Parts that are closed are a body each; those that are open may be one together. What is
    // turned inside out is the wall of a cavity in another.
    void addBodies(std::uint32_t material, const std::vector<const Part*>& parts, Media& media) {
        std::vector<const Part*> open, walls;
        for (const Part* const part : parts) {
            const bool isCurved = m_scene.m_shapes[part->shape].curved.has_value();
            const BodyShape shape = isCurved ? BodyShape{0, 1.0} : look({&part, 1});
            if (shape.openEdges > 0)
                open.push_back(part);
            else if (shape.volume > 0)
                addBody(material, {&part, 1}, media);
            else
                walls.push_back(part);
        }
        if (!open.empty()) {
            const BodyShape together = look(open);
            if (together.openEdges > 0)
                tell(open, fmt::format("is open ({} edges)", together.openEdges));
            else if (together.volume > 0)
                addBody(material, open, media);
            else
                walls.insert(walls.end(), open.begin(), open.end());
        }
        std::erase_if(walls, [&](const Part* wall) { return addWall(material, *wall, media); });
        tell(walls, "is turned inside out");
    }

    void addBody(std::uint32_t material, std::span<const Part* const> parts, Media& media) {
        Box3d box;
        for (const Part* const part : parts) {
            media.m_ofShape[part->shape].push_back(
                static_cast<std::uint32_t>(media.m_bodies.size()));
            box.grow(part->box);
        }
        Body body{material, m_scene.material(material).priority, box,
                  parts.size() == 1 && isConvex(*parts[0])};
        // Places come within roundings of faces, and as far aside as rays start.
        const double reach = static_cast<double>(body.gap()) + 64 * 0x1p-24 * m_scene.m_radius;
        body.lo = Vec3f(box.lo - Vec3d(reach));
        body.hi = Vec3f(box.hi + Vec3d(reach));
        media.m_bodies.push_back(body);
    }

    // No corner is before a face. Of many it isn't asked.
    bool isConvex(const Part& part) const {
        constexpr std::size_t kMostFaces = 256;
        constexpr double kFlat = 1e-6;  // of a face's own size
        const ShapeRecord& record = m_scene.m_shapes[part.shape];
        if (record.curved) return true;
        if (record.groups || record.materials.size() > 1 ||
            record.mesh->triangles.size() > kMostFaces)
            return false;
        std::vector<std::array<Vec3d, 3>> faces;
        visitFaces(part, [&](const std::array<Vec3d, 3>& face) { faces.push_back(face); });
        return std::ranges::all_of(faces, [&](const std::array<Vec3d, 3>& face) {
            const Vec3d normal = cross(face[1] - face[0], face[2] - face[0]);
            const double most = kFlat * length(normal) * length(face[1] - face[0]);
            return std::ranges::all_of(faces, [&](const std::array<Vec3d, 3>& other) {
                return std::ranges::all_of(other, [&](const Vec3d& corner) {
                    return dot(normal, corner - face[0]) <= most;
                });
            });
        });
    }

    // To the smallest body of the material that it is in. False: there is none.
    bool addWall(std::uint32_t material, const Part& wall, Media& media) const {
        const Body own{material, 0, wall.box};
        std::optional<std::uint32_t> best;
        for (std::uint32_t i = 0; i < media.m_bodies.size(); ++i) {
            const Body& body = media.m_bodies[i];
            if (body.material == material && body.holds(own) &&
                (!best || body.size() < media.m_bodies[*best].size()))
                best = i;
        }
        if (best) media.m_ofShape[wall.shape].push_back(*best);
        return best.has_value();
    }

    void tell(const std::vector<const Part*>& parts, const std::string& what) {
        const auto first = std::ranges::find_if(parts, &Part::matters);
        if (first == parts.end()) return;
        m_notices.push_back(
            {NoticeCode::kDegenerateGeometry,
             fmt::format("glass '{}' of instance '{}'{} {}: its faces alone say what is behind "
                         "them, and what is inside doesn't know of it",
                         m_scene.material((*first)->material).name,
                         m_scene.m_description.instances[(*first)->shape].name,
                         parts.size() > 1 ? fmt::format(" and {} more", parts.size() - 1) : "",
                         what)});
    }

    const Scene& m_scene;
    std::vector<Notice>& m_notices;
    const CancelCheck& m_cancel;
    std::vector<Part> m_parts;
    std::vector<Box3d> m_boxes;  // of the shapes
};

std::unique_ptr<const Scene::Media> Scene::Media::find(const Scene& scene,
                                                       std::vector<Notice>& notices,
                                                       const CancelCheck& cancel) {
    const bool hasAny = std::ranges::any_of(scene.m_traits, &MaterialTraits::fillsItsInside);
    Search search(scene, notices, cancel);
    if (!hasAny || !search.findParts()) return nullptr;
    auto media = std::unique_ptr<Media>(new Media(scene));
    search.addAllBodies(*media);
    if (media->m_bodies.empty()) return nullptr;
    return media;
}

}  // namespace pm
