// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cmath>

namespace pm {

// Three components of a point, vector or normal. Plain value; no unit of its own: the variable's
// name or the function's docstring says whether it is a position in scene units or a direction.
template <typename T>
struct Vec3 {
    T x{}, y{}, z{};

    constexpr Vec3() = default;
    constexpr Vec3(T x_, T y_, T z_) : x(x_), y(y_), z(z_) {}
    constexpr explicit Vec3(T s) : x(s), y(s), z(s) {}
    template <typename U>
    constexpr explicit Vec3(const Vec3<U>& v)
        : x(static_cast<T>(v.x)), y(static_cast<T>(v.y)), z(static_cast<T>(v.z)) {}

    constexpr T operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
    constexpr T& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }

    constexpr Vec3 operator-() const { return {-x, -y, -z}; }
    constexpr Vec3& operator+=(const Vec3& v) { return *this = *this + v; }
    constexpr Vec3& operator-=(const Vec3& v) { return *this = *this - v; }
    constexpr Vec3& operator*=(T s) { return *this = *this * s; }

    friend constexpr Vec3 operator+(const Vec3& a, const Vec3& b) {
        return {a.x + b.x, a.y + b.y, a.z + b.z};
    }
    friend constexpr Vec3 operator-(const Vec3& a, const Vec3& b) {
        return {a.x - b.x, a.y - b.y, a.z - b.z};
    }
    friend constexpr Vec3 operator*(const Vec3& a, T s) { return {a.x * s, a.y * s, a.z * s}; }
    friend constexpr Vec3 operator*(T s, const Vec3& a) { return a * s; }
    friend constexpr Vec3 operator*(const Vec3& a, const Vec3& b) {
        return {a.x * b.x, a.y * b.y, a.z * b.z};
    }
    friend constexpr Vec3 operator/(const Vec3& a, T s) { return {a.x / s, a.y / s, a.z / s}; }
    friend constexpr bool operator==(const Vec3& a, const Vec3& b) = default;
};

using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;

// Two components: texture coordinates, sample points in [0,1)^2.
struct Vec2f {
    float x{}, y{};
    friend constexpr bool operator==(const Vec2f& a, const Vec2f& b) = default;
    friend constexpr Vec2f operator+(const Vec2f& a, const Vec2f& b) {
        return {a.x + b.x, a.y + b.y};
    }
    friend constexpr Vec2f operator-(const Vec2f& a, const Vec2f& b) {
        return {a.x - b.x, a.y - b.y};
    }
    friend constexpr Vec2f operator*(const Vec2f& v, float s) { return {v.x * s, v.y * s}; }
};

template <typename T>
constexpr T dot(const Vec3<T>& a, const Vec3<T>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <typename T>
constexpr Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <typename T>
constexpr T lengthSquared(const Vec3<T>& v) {
    return dot(v, v);
}

template <typename T>
T length(const Vec3<T>& v) {
    return std::sqrt(dot(v, v));
}

// The unit vector along v. v must not be zero: the caller knows whether that can happen.
template <typename T>
Vec3<T> normalize(const Vec3<T>& v) {
    return v / length(v);
}

template <typename T>
bool isFinite(const Vec3<T>& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

template <typename T>
constexpr T maxAbsComponent(const Vec3<T>& v) {
    const T ax = v.x < 0 ? -v.x : v.x, ay = v.y < 0 ? -v.y : v.y, az = v.z < 0 ? -v.z : v.z;
    const T m = ax > ay ? ax : ay;
    return m > az ? m : az;
}

}  // namespace pm
