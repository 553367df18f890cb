// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The reusable objects that a host makes from a context: geometry, textures, materials. All are
// immutable once a scene uses them, so any number of scenes and threads share them.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>

#include "integrator/geometry/limit_shape.h"
#include "integrator/scene/scene_description.h"
#include "integrator/values/kept.h"
#include "plugin/api/context.h"
#include "plugin/api/handle_table.h"
#include "plugin/api/parameter_reader.h"
#include "plugin/include/pm_plugin.h"
#include "plugin/textures/texture.h"

namespace pm::plugin {

// A cage as a host gave it. Threads: any.
class CageSource {
  public:
    CageSource(SubdivisionCage cage, int rate) : m_cage(std::move(cage)), m_rate(rate) {}
    // To be cut on demand; made once. Errors: those of LimitShape.
    std::shared_ptr<const LimitShape> limit() const {
        return m_limit.get<LimitShape>(
            [](const LimitShape&) { return true; },
            [&] { return std::make_shared<const LimitShape>(m_cage, m_rate); });
    }

  private:
    SubdivisionCage m_cage;
    int m_rate;
    Kept m_limit;
};

class MeshObject {
  public:
    static constexpr ObjectKind kKind = ObjectKind::kMesh;

    // cage: null of what is none.
    MeshObject(std::shared_ptr<Context> context, Shape shape, std::uint64_t slotCount,
               std::shared_ptr<const CageSource> cage = nullptr)
        : m_context(std::move(context)),
          m_shape(std::move(shape)),
          m_slotCount(slotCount),
          m_cage(std::move(cage)) {}

    const std::shared_ptr<Context>& context() const { return m_context; }
    // Of a cage: cut whole, or to be cut on demand where it is very large.
    const Shape& shape() const { return m_shape; }
    const std::shared_ptr<const CageSource>& cage() const { return m_cage; }
    std::uint64_t slotCount() const { return m_slotCount; }

  private:
    std::shared_ptr<Context> m_context;
    Shape m_shape;
    std::uint64_t m_slotCount;
    std::shared_ptr<const CageSource> m_cage;
};

// Copy, check and triangulate; a cage is tessellated on the context's threads. Warnings go to the
// context's message function. Errors: CallError(ARGUMENT) for pointers, counts and enumerations,
// Error(kInvalidScene) for bad indices and coordinates, MEMORY for a tessellation that can't fit.
std::shared_ptr<MeshObject> makeMesh(std::shared_ptr<Context> context, const PmrMeshDesc& desc);
std::shared_ptr<MeshObject> makeCage(std::shared_ptr<Context> context, const PmrCageDesc& desc);
std::shared_ptr<MeshObject> makeSphere(std::shared_ptr<Context> context, const PmrSphereDesc& desc);
// object: PMR_OBJECT_SPHERE and those that follow. Errors: those of setByName.
std::shared_ptr<MeshObject> makeShape(std::shared_ptr<Context> context, std::int32_t object,
                                      std::span<const PmrParameterDesc> parameters);

class TextureObject {
  public:
    static constexpr ObjectKind kKind = ObjectKind::kTexture;

    TextureObject(std::shared_ptr<Context> context, TexturePicture picture)
        : m_context(std::move(context)),
          m_texture(std::make_shared<const Texture>(
              Texture{m_context->textures(), std::move(picture), {}})) {}
    // Of tiles, at least one.
    TextureObject(std::shared_ptr<Context> context, Texture texture)
        : m_context(std::move(context)),
          m_texture(std::make_shared<const Texture>(std::move(texture))) {}

    const std::shared_ptr<Context>& context() const { return m_context; }
    const std::shared_ptr<const Texture>& texture() const { return m_texture; }

  private:
    std::shared_ptr<Context> m_context;
    std::shared_ptr<const Texture> m_texture;
};

std::shared_ptr<TextureObject> makeTexture(std::shared_ptr<Context> context,
                                           const PmrTextureDesc& desc);

// Threads: any. It may be changed until a scene uses it.
class MaterialObject {
  public:
    static constexpr ObjectKind kKind = ObjectKind::kMaterial;

    MaterialObject(std::shared_ptr<Context> context, MaterialSet values)
        : m_context(std::move(context)), m_values(std::move(values)) {}

    const std::shared_ptr<Context>& context() const { return m_context; }
    // Errors: those of setByName; CallError(STATE) once a scene uses it.
    void setParameter(const PmrParameterDesc& desc);
    // For a scene; it doesn't change from then on.
    const MaterialSet& use();
    // Of a mixture, as its parameters name them; null where they don't.
    using Parts = std::array<std::shared_ptr<MaterialObject>, 2>;
    Parts parts() const;

  private:
    std::string owner() const;  // for errors
    // Whether it is this one, or a part of it.
    bool holds(const MaterialObject& other) const;
    // The part that a parameter names, null of another. Errors: CallError(NAME) without one of that
    // name, CallError(ARGUMENT) where this would be a part of itself.
    std::shared_ptr<MaterialObject> namedPart(const PmrParameterDesc& desc,
                                              const std::string& owner) const;

    const std::shared_ptr<Context> m_context;
    mutable std::mutex m_mutex;  // of what follows
    MaterialSet m_values;
    Parts m_parts;
    bool m_isUsed = false;
};

// Errors: CallError ARGUMENT naming member, value and range; HANDLE for a texture that is not live.
std::shared_ptr<MaterialObject> makeMaterial(std::shared_ptr<Context> context,
                                             const PmrMaterialDesc& desc);

}  // namespace pm::plugin
