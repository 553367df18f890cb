// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/pov/evaluation/symbols.h"

#include <algorithm>
#include <utility>

namespace pm::host::pov {

std::vector<Symbols::Binding>& Symbols::bindingsOf(NameId name) {
    if (name >= m_bindings.size()) m_bindings.resize(name + 64);
    return m_bindings[name];
}

void Symbols::leave() {
    for (const NameId name : m_declared.back()) {
        auto& bindings = m_bindings[name];
        if (!bindings.empty() && bindings.back().depth == depth()) bindings.pop_back();
    }
    m_declared.pop_back();
}

Symbols::Binding* Symbols::at(Slot slot) {
    for (Binding& binding : bindingsOf(slot.name))
        if (binding.depth == slot.depth) return &binding;
    return nullptr;
}

Value* Symbols::find(NameId name) {
    auto& bindings = bindingsOf(name);
    if (bindings.empty()) return nullptr;
    Binding* binding = &bindings.back();
    if (binding->isReference) binding = at(binding->target);
    return binding == nullptr ? nullptr : &binding->value;
}

Symbols::Slot Symbols::slotOf(NameId name) const {
    if (name >= m_bindings.size() || m_bindings[name].empty()) return {name, 0};
    const Binding& binding = m_bindings[name].back();
    return binding.isReference ? binding.target : Slot{name, binding.depth};
}

Symbols::Binding& Symbols::local(NameId name, std::uint32_t depth) {
    auto& bindings = bindingsOf(name);
    const auto found = std::ranges::lower_bound(bindings, depth, {}, &Binding::depth);
    if (found != bindings.end() && found->depth == depth) return *found;
    if (depth > 0) m_declared[depth - 1].push_back(name);
    return *bindings.insert(found, Binding{depth, false, {}, {}});
}

void Symbols::declare(NameId name, Value value) {
    const Slot slot = slotOf(name);
    local(slot.name, slot.depth).value = std::move(value);
}

void Symbols::declareLocal(NameId name, Value value, std::uint32_t depth) {
    Binding& binding = local(name, std::min(depth, this->depth()));
    if (binding.isReference)
        local(binding.target.name, binding.target.depth).value = std::move(value);
    else
        binding.value = std::move(value);
}

void Symbols::refer(NameId name, Slot target) {
    Binding& binding = local(name, depth());
    binding.isReference = true;
    binding.target = target;
}

void Symbols::remove(NameId name) {
    auto& bindings = bindingsOf(name);
    if (bindings.empty()) return;
    Binding& binding = bindings.back();
    if (!binding.isReference) {
        bindings.pop_back();
        return;
    }
    auto& targets = bindingsOf(binding.target.name);
    std::erase_if(targets, [&](const Binding& other) {
        return other.depth == binding.target.depth && !other.isReference;
    });
}

}  // namespace pm::host::pov
