// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>
#include <vector>

namespace pm::plugin {

// What makes two renders the same render: 128-bit checksums (XXH3) as 32 hexadecimal digits. They
// hold for one build on one byte order.

// One of the things that a render's pixels depend on: a name for people, and what it is, as a short
// text or as a checksum.
struct IdentityPart {
    std::string name, value;
    friend bool operator==(const IdentityPart&, const IdentityPart&) = default;
};
using Identity = std::vector<IdentityPart>;

// The very library: of one version there are as many as there are compilers.
Identity buildIdentity();

// One checksum of all parts.
std::string identityHash(const Identity& identity);

// What differs, in words, as "geometry; setting seed (1 there, 2 here)"; empty where nothing does.
std::string differences(const Identity& there, const Identity& here);

}  // namespace pm::plugin
