// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/determinism/covering_set.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace pm::test {

namespace {

template <typename Visit>
void visitPairs(const Combination& combination, Visit&& visit) {
    const int factors = static_cast<int>(combination.size());
    for (int a = 0; a < factors; ++a) {
        for (int b = a + 1; b < factors; ++b)
            visit(LevelPair{a, combination[static_cast<std::size_t>(a)], b,
                            combination[static_cast<std::size_t>(b)]});
    }
}

}  // namespace

Combinations fullMatrix(const std::vector<int>& levels,
                        const std::function<bool(const Combination&)>& isAllowed) {
    Combinations all;
    Combination current(levels.size(), 0);
    for (bool isEnd = false; !isEnd;) {
        if (isAllowed(current)) all.push_back(current);
        std::size_t factor = levels.size();
        while (factor > 0 && ++current[factor - 1] == levels[factor - 1]) current[--factor] = 0;
        isEnd = factor == 0;
    }
    return all;
}

std::set<LevelPair> pairsOf(const Combinations& combinations) {
    std::set<LevelPair> pairs;
    for (const Combination& combination : combinations)
        visitPairs(combination, [&](const LevelPair& pair) { pairs.insert(pair); });
    return pairs;
}

Combinations coveringSet(const Combinations& combinations) {
    std::set<LevelPair> missing = pairsOf(combinations);
    Combinations chosen;
    // How many pairs are new, then how few of the chosen have the same levels.
    const auto worth = [&](const Combination& combination) {
        std::pair<int, int> worth = {0, 0};
        visitPairs(combination,
                   [&](const LevelPair& pair) { worth.first += missing.contains(pair); });
        for (const Combination& other : chosen) {
            for (std::size_t i = 0; i < other.size(); ++i)
                worth.second -= combination[i] == other[i];
        }
        return worth;
    };
    while (!missing.empty()) {
        const auto best = std::ranges::max_element(combinations, {}, worth);
        visitPairs(*best, [&](const LevelPair& pair) { missing.erase(pair); });
        chosen.push_back(*best);
    }
    return chosen;
}

}  // namespace pm::test
