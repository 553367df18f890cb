// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Scene::Media: which bodies there are, and whether they matter.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <iterator>
#include <map>

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

    void addBodies(Media& media) {
        media.m_ofShape.resize(m_scene.m_shapes.size());
        std::map<std::uint32_t, std::vector<const Part*>> byMaterial;
        for (const Part& part : m_parts) byMaterial[part.material].push_back(&part);
        for (const auto& [material, parts] : byMaterial) addBody(material, parts, media);
    }

  private:
    void addParts(std::uint32_t shape) {
        const ShapeRecord& record = m_scene.m_shapes[shape];
        m_cancel.throwIfSet("looking for media");
        std::vector<Part> here;
        const std::size_t count = record.mesh ? record.mesh->triangles.size() : 1;
        for (std::uint32_t i = 0; i < count; ++i) {
            Box3d box;
            record.bounds(i, box.lo, box.hi);
            m_boxes[shape].grow(box);
            const std::uint32_t material = record.materialOf(i);
            if (!fillsItsInside(m_scene.material(material))) continue;
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
        if (!absorbs(m_scene.material(part.material))) return false;
        for (std::uint32_t shape = 0; shape < m_boxes.size(); ++shape)
            if (shape != part.shape && overlap(part.box, m_boxes[shape])) return true;
        if (m_scene.m_shapes[part.shape].materials.size() > 1) return true;
        const Part* const alone = &part;
        return m_scene.m_shapes[part.shape].mesh && look({&alone, 1}).openEdges > 0;
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
        for (std::uint32_t i = 0; i < record.mesh->triangles.size(); ++i) {
            if (record.materialOf(i) != part.material) continue;
            const Corner c = record.corner(i);
            const Vec3d second = c.vertex + c.e1, third = c.vertex + c.e2;
            visit(record.mirrored ? std::array{c.vertex, third, second}
                                  : std::array{c.vertex, second, third});
        }
    }

    // Parts that are closed, and those that are closed together.
    void addBody(std::uint32_t material, const std::vector<const Part*>& parts, Media& media) {
        std::vector<const Part*> closed, open;
        double volume = 0;
        for (const Part* const part : parts) {
            if (!m_scene.m_shapes[part->shape].mesh) {
                closed.push_back(part);
                const Vec3d size = part->box.size();
                volume += size.x * size.y * size.z;
                continue;
            }
            const BodyShape shape = look({&part, 1});
            (shape.openEdges == 0 ? closed : open).push_back(part);
            if (shape.openEdges == 0) volume += shape.volume;
        }
        if (!open.empty()) {
            const BodyShape together = look(open);
            if (together.openEdges == 0) {
                closed.insert(closed.end(), open.begin(), open.end());
                volume += together.volume;
            } else {
                tell(open, fmt::format("is open ({} edges)", together.openEdges));
            }
        }
        if (closed.empty()) return;
        if (!(volume > 0)) return tell(closed, "is turned inside out");
        const auto body = static_cast<std::uint32_t>(media.m_bodies.size());
        Box3d box;
        for (const Part* const part : closed) {
            media.m_ofShape[part->shape].push_back(body);
            box.grow(part->box);
        }
        media.m_bodies.push_back({material, m_scene.material(material).priority, box});
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
    const bool hasAny = std::ranges::any_of(scene.m_description.materials, fillsItsInside);
    Search search(scene, notices, cancel);
    if (!hasAny || !search.findParts()) return nullptr;
    auto media = std::unique_ptr<Media>(new Media(scene));
    search.addBodies(*media);
    if (media->m_bodies.empty()) return nullptr;
    return media;
}

}  // namespace pm
