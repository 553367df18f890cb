// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/values/identity.h"

#include <fmt/format.h>

#include <string_view>

#include "plugin/values/hasher.h"
#include "plugin/values/version.h"

namespace pm::plugin {

namespace {

const std::string* findPart(const Identity& identity, const std::string& name) {
    for (const IdentityPart& part : identity)
        if (part.name == name) return &part.value;
    return nullptr;
}

// Checksums would tell nobody anything.
bool isChecksum(const std::string& value) {
    return value.size() == 32 && value.find_first_not_of("0123456789abcdef") == std::string::npos;
}

std::string difference(const std::string& name, const std::string* there, const std::string* here) {
    if ((there != nullptr && isChecksum(*there)) || (here != nullptr && isChecksum(*here)))
        return name;
    const auto shown = [](const std::string* value) {
        return value == nullptr ? std::string("none") : value->empty() ? "''" : *value;
    };
    return fmt::format("{} ({} there, {} here)", name, shown(there), shown(here));
}

}  // namespace

Identity buildIdentity() {
    return {{"build", buildId()}};
}

std::string identityHash(const Identity& identity) {
    return checksumOf([&](Hasher& hasher) {
        for (const IdentityPart& part : identity) {
            hasher.add(std::string_view(part.name));
            hasher.add(std::string_view(part.value));
        }
    });
}

std::string differences(const Identity& there, const Identity& here) {
    std::string text;
    const auto add = [&text](const std::string& what) {
        if (!text.empty()) text += "; ";
        text += what;
    };
    for (const IdentityPart& part : here) {
        const std::string* other = findPart(there, part.name);
        if (other == nullptr || *other != part.value)
            add(difference(part.name, other, &part.value));
    }
    for (const IdentityPart& part : there)
        if (findPart(here, part.name) == nullptr) add(difference(part.name, &part.value, nullptr));
    return text;
}

}  // namespace pm::plugin
