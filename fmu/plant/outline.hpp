// Closest point of the robot's outline in plan view: a convex polygon, the wheels, or both.
#pragma once

#include "state.hpp"
#include "vector2.hpp"

namespace giveway::plant {

template <class T> struct ClosestPoint {
    T distance;        // signed: negative inside
    Vector2<T> normal; // outward
    Vector2<T> point;  // on the outline
};

template <class T, int Wheels>
ClosestPoint<T> closest_on_body(const Parameters<T, Wheels> &p, const Derived<T> &d, Vector2<T> q) {
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

// A wheel's section at the contact's height: a rectangle, its width along the axle.
template <class T, int Wheels>
ClosestPoint<T> closest_on_wheel(const Parameters<T, Wheels> &p, const Derived<T> &d, int wheel, Vector2<T> q) {
    const Vector2<T> radial{T(Azimuths<Wheels>::cos[wheel]), T(Azimuths<Wheels>::sin[wheel])};
    const T axial = dot(q, radial) - p.wheel_distance;
    const T rolling = dot(q, turned(radial));
    const Vector2<T> outward_axial = math::select(math::less(axial, T(0.0)), T(-1.0), T(1.0)) * radial;
    const Vector2<T> outward_rolling = math::select(math::less(rolling, T(0.0)), T(-1.0), T(1.0)) * turned(radial);
    const T beyond_side = math::abs(axial) - T(0.5) * p.wheel_width;
    const T beyond_end = math::abs(rolling) - d.wheel_half_length;
    const T outer_side = math::max(beyond_side, T(0.0));
    const T outer_end = math::max(beyond_end, T(0.0));
    const T outer = math::sqrt(outer_side * outer_side + outer_end * outer_end);
    const T divisor = math::max(outer, T(1e-12));
    // Inside, the nearest face; outside, the nearest point of a face or a corner.
    const auto outside = math::less(T(0.0), outer);
    const auto side = math::less(beyond_end, beyond_side);
    const T share_side = math::select(outside, outer_side / divisor, math::select(side, T(1.0), T(0.0)));
    const T share_end = math::select(outside, outer_end / divisor, math::select(side, T(0.0), T(1.0)));
    const T distance = math::select(outside, outer, math::max(beyond_side, beyond_end));
    const Vector2<T> normal = share_side * outward_axial + share_end * outward_rolling;
    return {distance, normal, q - distance * normal};
}

// The nearest of several parts: unique except where two are equally near.
template <class T, int Wheels>
ClosestPoint<T> closest_point(const Parameters<T, Wheels> &p, const Derived<T> &d, Vector2<T> q) {
    if (p.outline_wheels == 0) {
        return closest_on_body(p, d, q);
    }
    ClosestPoint<T> nearest = p.outline_body != 0 ? closest_on_body(p, d, q) : closest_on_wheel(p, d, 0, q);
    for (int wheel = p.outline_body != 0 ? 0 : 1; wheel < Wheels; ++wheel) {
        const ClosestPoint<T> other = closest_on_wheel(p, d, wheel, q);
        const auto nearer = math::less(other.distance, nearest.distance);
        const auto pick = [nearer](Vector2<T> a, Vector2<T> b) {
            return Vector2<T>{math::select(nearer, a.x, b.x), math::select(nearer, a.y, b.y)};
        };
        nearest = {math::select(nearer, other.distance, nearest.distance), pick(other.normal, nearest.normal),
                   pick(other.point, nearest.point)};
    }
    return nearest;
}

// Calls visit(corner) for every corner of every part.
template <class T, int Wheels, class Visit>
void for_each_corner(const Parameters<T, Wheels> &p, const Derived<T> &d, Visit visit) {
    for (int i = 0; p.outline_body != 0 && i < p.outline_count; ++i) {
        visit(Vector2<T>{p.outline_x[i], p.outline_y[i]});
    }
    for (int wheel = 0; p.outline_wheels != 0 && wheel < Wheels; ++wheel) {
        const Vector2<T> radial{T(Azimuths<Wheels>::cos[wheel]), T(Azimuths<Wheels>::sin[wheel])};
        for (const double side : {-0.5, 0.5}) {
            for (const double end : {-1.0, 1.0}) {
                visit((p.wheel_distance + T(side) * p.wheel_width) * radial +
                      (T(end) * d.wheel_half_length) * turned(radial));
            }
        }
    }
}

} // namespace giveway::plant
