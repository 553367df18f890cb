// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors

// One Hilbert curve through any rectangle of cells.
//
// [1] Yavuz, Tugrul, Tosun, "Hilbert Curve Based Bucket Ordering for Global Illumination", Journal
//     of Computing 2(9), 2010, section 3: the screen is divided into unit shapes, placed by a
//     recursive procedure that transforms each by a code of its start and its end point (Fig. 3),
//     their number and size adapting to the resolution (Fig. 2).
//
// Here a shape is a rectangle of lengthA x lengthB cells between two axes, a and b, that start in
// one of its corners; its code is that start corner, the two axes (which hold rotation and
// reflection) and the corner where it ends: "across", at the far end of axis a, or "opposite", at
// the far end of both. A shape is cut into two or three smaller ones such that each ends beside the
// cell in which the next one starts.
//
// Parity tells what can be had. Colour the cells like a chess board: a path of edge steps changes
// colour with every step, so over n cells its ends differ in colour exactly where n is even.
//   across:   ends differ by lengthA - 1 steps, so lengthA even, or both lengths odd;
//   opposite: ends differ by lengthA + lengthB - 2 steps, so not both lengths even.
// Only a rectangle with odd lengthA and even lengthB can't be crossed along a, and that one can be
// ended in the opposite corner. As nobody prescribes where the whole curve ends, it never needs a
// diagonal step. Every cut below gives an even length to the part for which parity matters, so that
// each part obeys the two rules again.
#include "scheduler/buckets/hilbert_order.h"

#include <cassert>
#include <utility>

#include "scheduler/buckets/bucket_order.h"

namespace pm {
namespace {

enum class Exit { kAcross, kOpposite };

struct Shape {
    std::int64_t start{};           // cell index of the start corner
    std::int64_t stepA{}, stepB{};  // what one step along an axis adds to a cell index
    std::int32_t lengthA{}, lengthB{};
    Exit exit{};
};

constexpr bool canCross(std::int32_t lengthA, std::int32_t lengthB) {
    return lengthA % 2 == 0 || lengthB % 2 != 0;
}

// The even number nearest to half of length, at least 2: how much of an axis the first part gets.
// Between a third and two thirds of it, so the recursion is O(log) deep.
constexpr std::int32_t evenNearHalf(std::int32_t length) {
    return length < 7 ? 2 : 2 * ((length + 1) / 4);
}

class CurveBuilder {
  public:
    explicit CurveBuilder(std::uint32_t cellCount) { m_order.reserve(cellCount); }

    void place(const Shape& shape) {
        if (shape.lengthB == 1) {
            line(shape.start, shape.stepA, shape.lengthA);
        } else if (shape.lengthA == 1) {
            assert(shape.exit == Exit::kOpposite);
            line(shape.start, shape.stepB, shape.lengthB);
        } else if (shape.exit == Exit::kOpposite) {
            placeOpposite(shape);
        } else {
            placeAcross(shape);
        }
    }

    std::vector<std::uint32_t> take() { return std::move(m_order); }

  private:
    void line(std::int64_t start, std::int64_t step, std::int32_t length) {
        for (std::int32_t i = 0; i < length; ++i, start += step) {
            m_order.push_back(static_cast<std::uint32_t>(start));
        }
    }

    void placeAcross(const Shape& s) {
        assert(canCross(s.lengthA, s.lengthB));
        if (s.lengthA == 2) {
            line(s.start, s.stepB, s.lengthB);
            line(s.start + s.stepA + (s.lengthB - 1) * s.stepB, -s.stepB, s.lengthB);
        } else if (2 * std::int64_t{s.lengthA} > 3 * std::int64_t{s.lengthB}) {
            // Long: two shapes one after the other, so that none gets narrower than it must.
            const std::int32_t first = evenNearHalf(s.lengthA);
            place({s.start, s.stepA, s.stepB, first, s.lengthB, Exit::kAcross});
            place({s.start + first * s.stepA, s.stepA, s.stepB, s.lengthA - first, s.lengthB,
                   Exit::kAcross});
        } else {
            placeAcrossByLegs(s);
        }
    }

    // Hilbert's own figure: away from the start along b, over to the other side, and back along b.
    // The outer legs are even along b, so parity allows them any width, and what is left of
    // lengthB is as odd or even as it was.
    void placeAcrossByLegs(const Shape& s) {
        const std::int32_t leg = evenNearHalf(s.lengthB);
        const std::int32_t left = s.lengthA / 2;
        place({s.start, s.stepB, s.stepA, leg, left, Exit::kAcross});
        place(
            {s.start + leg * s.stepB, s.stepA, s.stepB, s.lengthA, s.lengthB - leg, Exit::kAcross});
        place({s.start + (s.lengthA - 1) * s.stepA + (leg - 1) * s.stepB, -s.stepB, -s.stepA, leg,
               s.lengthA - left, Exit::kAcross});
    }

    // An even part crossed along the longer axis; the rest is not even in both lengths either.
    void placeOpposite(Shape s) {
        if (s.lengthA < s.lengthB) {
            std::swap(s.stepA, s.stepB);
            std::swap(s.lengthA, s.lengthB);
        }
        const std::int32_t first = evenNearHalf(s.lengthA);
        place({s.start, s.stepA, s.stepB, first, s.lengthB, Exit::kAcross});
        place({s.start + first * s.stepA, s.stepA, s.stepB, s.lengthA - first, s.lengthB,
               Exit::kOpposite});
    }

    std::vector<std::uint32_t> m_order;
};

}  // namespace

std::vector<std::uint32_t> hilbertOrder(std::int32_t columns, std::int32_t rows) {
    const std::uint32_t cells = checkedCellCount(columns, rows);
    if (cells == 0) return {};
    // Axis a is the longer side: the curve then runs along the frame rather than out and back.
    Shape frame{0, 1, columns, columns, rows, Exit::kAcross};
    if (rows > columns) frame = {0, columns, 1, rows, columns, Exit::kAcross};
    if (!canCross(frame.lengthA, frame.lengthB)) frame.exit = Exit::kOpposite;
    CurveBuilder builder(cells);
    builder.place(frame);
    return builder.take();
}

}  // namespace pm
