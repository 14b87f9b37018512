// Plane vectors.
#pragma once

namespace giveway::plant {

template <class T> struct Vector2 {
    T x, y;
    friend Vector2 operator+(Vector2 a, Vector2 b) { return {a.x + b.x, a.y + b.y}; }
    friend Vector2 operator-(Vector2 a, Vector2 b) { return {a.x - b.x, a.y - b.y}; }
    friend Vector2 operator*(T s, Vector2 a) { return {s * a.x, s * a.y}; }
};

template <class T> T dot(Vector2<T> a, Vector2<T> b) { return a.x * b.x + a.y * b.y; }
template <class T> T cross(Vector2<T> a, Vector2<T> b) { return a.x * b.y - a.y * b.x; }
// k x a: a turned by 90 deg, counter-clockwise.
template <class T> Vector2<T> turned(Vector2<T> a) { return {T(-1.0) * a.y, a.x}; }

} // namespace giveway::plant
