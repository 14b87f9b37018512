// Closest point of the robot's convex outline.
#pragma once

#include "state.hpp"
#include "vector2.hpp"

namespace giveway::plant {

template <class T> struct ClosestPoint {
    T distance;         // signed: negative inside
    Vector2<T> normal;  // outward
    Vector2<T> point;   // on the outline
};

template <class T> ClosestPoint<T> closest_point(const Parameters<T>& p, const Derived<T>& d, Vector2<T> q) {
    // Inside, the nearest edge line decides; outside, the nearest point of any edge.
    T line_distance = T(-1e300);
    Vector2<T> line_normal{T(0.0), T(0.0)};
    T square_distance = T(1e300);
    Vector2<T> nearest{T(0.0), T(0.0)};
    for (int i = 0; i < p.outline_count; ++i) {
        const Vector2<T> from_vertex = q - Vector2<T>{p.outline_x[i], p.outline_y[i]};
        const Vector2<T> along{d.edge_x[i], d.edge_y[i]};
        const Vector2<T> outward{along.y, T(-1.0) * along.x};
        const T height = dot(from_vertex, outward);
        const auto higher = math::less(line_distance, height);
        line_distance = math::select(higher, height, line_distance);
        line_normal = {math::select(higher, outward.x, line_normal.x), math::select(higher, outward.y, line_normal.y)};
        const T travel = math::clamp(dot(from_vertex, along), T(0.0), d.edge_length[i]);
        const Vector2<T> offset = from_vertex - travel * along;
        const T square = dot(offset, offset);
        const auto closer = math::less(square, square_distance);
        square_distance = math::select(closer, square, square_distance);
        nearest = {math::select(closer, offset.x, nearest.x), math::select(closer, offset.y, nearest.y)};
    }
    const auto outside = math::less(T(0.0), line_distance);
    const T distance = math::select(outside, math::sqrt(square_distance), line_distance);
    const T divisor = math::max(distance, T(1e-12));
    const Vector2<T> normal{math::select(outside, nearest.x / divisor, line_normal.x),
                            math::select(outside, nearest.y / divisor, line_normal.y)};
    return {distance, normal, q - distance * normal};
}

} // namespace giveway::plant
