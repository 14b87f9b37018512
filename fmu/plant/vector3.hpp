// Space vectors.
#pragma once

#include "vector2.hpp"

namespace giveway::plant {

template <class T> struct Vector3 {
    T x, y, z;
    friend Vector3 operator+(Vector3 a, Vector3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend Vector3 operator-(Vector3 a, Vector3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend Vector3 operator*(T s, Vector3 a) { return {s * a.x, s * a.y, s * a.z}; }
    [[nodiscard]] Vector2<T> plan() const { return {x, y}; }
};

template <class T> T dot(Vector3<T> a, Vector3<T> b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
template <class T> Vector3<T> cross(Vector3<T> a, Vector3<T> b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

} // namespace giveway::plant
