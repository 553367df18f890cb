// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cmath>

namespace pm {

// Neumaier's sum: keeps what plain addition rounds away, so that millions of pixels add up to the
// last bits of a double.
class CompensatedSum {
  public:
    void add(double value) {
        const double sum = m_sum + value;
        m_lost +=
            std::abs(m_sum) >= std::abs(value) ? (m_sum - sum) + value : (value - sum) + m_sum;
        m_sum = sum;
    }
    double value() const { return m_sum + m_lost; }

  private:
    double m_sum{}, m_lost{};
};

}  // namespace pm
