// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "integrator/values/cancel_check.h"
#include "integrator/values/notice.h"
#include "plugin/api/handle_table.h"
#include "plugin/include/pm_plugin.h"
#include "plugin/textures/texture_system.h"

namespace pm::plugin {

class MaterialObject;

// What everything that a host makes hangs on: its message function and the textures. Lives until
// the last object made from it ends.
class Context {
  public:
    static constexpr ObjectKind kKind = ObjectKind::kContext;

    // Throws CallError(ARGUMENT) for a name or number that is not allowed.
    explicit Context(const PmrContextDesc& desc);

    const std::string& isa() const { return m_isa; }
    int threads() const { return m_threads; }
    const std::shared_ptr<TextureSystem>& textures() const { return m_textures; }

    // Whether meshes and scenes that are being built are to be given up. Threads: any.
    void cancelBuilds(bool on) { m_cancelBuilds = on; }
    CancelCheck buildCheck() const { return CancelCheck(m_cancelBuilds); }
    // What buildCheck() looks at.
    const std::atomic<bool>& buildsAreCancelled() const { return m_cancelBuilds; }

    // Materials by their names, the one made last of each, while they live. Threads: any.
    void nameMaterial(const std::string& name, std::weak_ptr<MaterialObject> material);
    // Null: none has that name.
    std::shared_ptr<MaterialObject> materialOfName(const std::string& name) const;

    // Passes a message to the host, on the calling thread. Threads: any.
    void sendMessage(std::int32_t level, std::int32_t code, const std::string& text) const;
    void sendNotice(const Notice& notice) const;

  private:
    PmrMessageFunction m_message;
    void* m_user;
    std::string m_isa;
    int m_threads;
    std::shared_ptr<TextureSystem> m_textures = std::make_shared<TextureSystem>();

    std::atomic<bool> m_cancelBuilds{false};
    mutable std::mutex m_namesMutex;
    std::map<std::string, std::weak_ptr<MaterialObject>> m_materials;
};

}  // namespace pm::plugin
