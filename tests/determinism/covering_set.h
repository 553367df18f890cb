// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Pairwise covering sets: few combinations of many factors in which every two levels of every two
// factors come together at least once.
#pragma once

#include <array>
#include <functional>
#include <set>
#include <vector>

namespace pm::test {

// For each factor the index of its level, from 0.
using Combination = std::vector<int>;
using Combinations = std::vector<Combination>;
// Two factors and the level of each: first factor, its level, second factor, its level.
using LevelPair = std::array<int, 4>;

// All combinations that are allowed, in lexicographic order. levels: how many levels each factor
// has, all above 0.
Combinations fullMatrix(const std::vector<int>& levels,
                        const std::function<bool(const Combination&)>& isAllowed);

// The pairs that occur in the combinations.
std::set<LevelPair> pairsOf(const Combinations& combinations);

// A subset of the combinations in which every pair of theirs occurs, found greedily: always one
// that brings the most new pairs, and of these one whose levels are rare so far. A pair that never
// occurs in them (it is not allowed) needs no place.
Combinations coveringSet(const Combinations& combinations);

}  // namespace pm::test
