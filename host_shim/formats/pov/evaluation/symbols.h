// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <vector>

#include "host_shim/formats/pov/lexer/words.h"
#include "host_shim/formats/pov/values/value.h"

namespace pm::host::pov {

// What names stand for: a table for the scene's file, and one more for each include file and macro
// that is being read. A name means what the innermost table says that has it.
class Symbols {
  public:
    // Where a value is kept: of a parameter that was handed over by name, the caller's place.
    struct Slot {
        NameId name{};
        std::uint32_t depth{};
    };

    void enter() { m_declared.emplace_back(); }
    void leave();
    std::uint32_t depth() const { return static_cast<std::uint32_t>(m_declared.size()); }

    // nullptr: not declared. Valid until the next declaration.
    Value* find(NameId name);
    // Where a name is, or would be declared for the whole scene.
    Slot slotOf(NameId name) const;
    // #declare: where the name is, else for the whole scene.
    void declare(NameId name, Value value);
    // #local, and a macro's parameters: in the table of that depth.
    void declareLocal(NameId name, Value value, std::uint32_t depth);
    // A macro's parameter that stands for the caller's.
    void refer(NameId name, Slot target);
    // The innermost of that name.
    void remove(NameId name);

  private:
    struct Binding {
        std::uint32_t depth{};
        bool isReference{};
        Slot target;
        Value value;
    };

    std::vector<Binding>& bindingsOf(NameId name);
    Binding* at(Slot slot);
    Binding& local(NameId name, std::uint32_t depth);

    std::vector<std::vector<Binding>> m_bindings;  // of each name, the innermost last
    std::vector<std::vector<NameId>> m_declared;   // in each table but the scene's
};

}  // namespace pm::host::pov
