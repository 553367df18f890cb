// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/pov/values/transform_of.h"

#include <cmath>
#include <numbers>

namespace pm::host::pov {
namespace {

Matrix aboutAxis(std::size_t axis, double degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    const std::size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
    Matrix matrix = kIdentityMatrix;
    matrix[a * 4 + a] = matrix[b * 4 + b] = std::cos(angle);
    matrix[b * 4 + a] = std::sin(angle);
    matrix[a * 4 + b] = -matrix[b * 4 + a];
    return matrix;
}

// The language has it as rows for p' = p M.
Matrix ofMatrixItem(const Node& item) {
    Matrix matrix = kIdentityMatrix;
    for (std::size_t row = 0; row < 4; ++row)
        for (std::size_t column = 0; column < 3; ++column)
            if (const Numbers* const value = item.numbers(row * 3 + column))
                matrix[column * 4 + row] = value->at[0];
    return matrix;
}

}  // namespace

Matrix after(const Matrix& a, const Matrix& b) {
    Matrix result{};
    for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t column = 0; column < 4; ++column)
            for (std::size_t k = 0; k < 3; ++k)
                result[row * 4 + column] += a[row * 4 + k] * b[k * 4 + column];
        result[row * 4 + 3] += a[row * 4 + 3];
    }
    return result;
}

std::array<double, 3> transformed(const Matrix& by, const std::array<double, 3>& point) {
    std::array<double, 3> to{};
    for (std::size_t row = 0; row < 3; ++row)
        to[row] = by[row * 4] * point[0] + by[row * 4 + 1] * point[1] + by[row * 4 + 2] * point[2] +
                  by[row * 4 + 3];
    return to;
}

std::optional<Matrix> inverse(const Matrix& of) {
    const auto m = [&of](std::size_t row, std::size_t column) { return of[row * 4 + column]; };
    Matrix result{};
    for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t column = 0; column < 3; ++column) {
            const std::size_t r1 = (column + 1) % 3, r2 = (column + 2) % 3;
            const std::size_t c1 = (row + 1) % 3, c2 = (row + 2) % 3;
            result[row * 4 + column] = m(r1, c1) * m(r2, c2) - m(r1, c2) * m(r2, c1);
        }
    const double determinant = m(0, 0) * result[0] + m(0, 1) * result[4] + m(0, 2) * result[8];
    if (determinant == 0 || !std::isfinite(determinant)) return std::nullopt;
    for (double& value : result) value /= determinant;
    for (std::size_t row = 0; row < 3; ++row)
        result[row * 4 + 3] = -(result[row * 4] * m(0, 3) + result[row * 4 + 1] * m(1, 3) +
                                result[row * 4 + 2] * m(2, 3));
    return result;
}

Matrix rotation(const std::array<double, 3>& degrees) {
    return after(aboutAxis(2, degrees[2]),
                 after(aboutAxis(1, degrees[1]), aboutAxis(0, degrees[0])));
}

std::optional<Matrix> transformOf(const Node& item) {
    if (item.kind == "matrix") return ofMatrixItem(item);
    if (item.kind == "transform") return transformOfItems(item);
    const Numbers* const given = item.numbers(0);
    if (given == nullptr) return std::nullopt;
    const Numbers v = given->promoted(3);
    Matrix matrix = kIdentityMatrix;
    if (item.kind == "rotate") return rotation({v.at[0], v.at[1], v.at[2]});
    if (item.kind == "translate") {
        for (std::size_t axis = 0; axis < 3; ++axis) matrix[axis * 4 + 3] = v.at[axis];
        return matrix;
    }
    if (item.kind != "scale") return std::nullopt;
    for (std::size_t axis = 0; axis < 3; ++axis)
        matrix[axis * 5] = v.at[axis] == 0 ? 1 : v.at[axis];
    return matrix;
}

Matrix transformOfItems(const Node& node) {
    Matrix matrix = kIdentityMatrix;
    const auto add = [&matrix](const Node& item) {
        if (item.kind == "inverse")
            matrix = inverse(matrix).value_or(kIdentityMatrix);
        else if (const auto next = transformOf(item))
            matrix = after(*next, matrix);
    };
    for (const Value& argument : node.arguments)
        if (const auto* const item = std::get_if<std::shared_ptr<const Node>>(&argument))
            add(**item);
    for (const auto& item : node.items) add(*item);
    return matrix;
}

}  // namespace pm::host::pov
