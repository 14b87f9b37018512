// Measured force over travel and speed, linear in both between the points of a table.
#pragma once

#include "law.hpp"

namespace giveway::plant {

struct ForceTable : PlainLaw {
    static constexpr bool has_drag = true;
    static constexpr std::size_t columns = std::tuple_size_v<decltype(Parameters<double>::bumper_table_speed)>;

    template <class P> static auto force(const P &p, std::size_t row, std::size_t column) {
        return p.bumper_table_force[columns * row + column];
    }
    template <class P> static std::size_t rows_of(const P &p) { return static_cast<std::size_t>(p.bumper_table_rows); }
    template <class P> static std::size_t columns_of(const P &p) {
        return static_cast<std::size_t>(p.bumper_table_columns);
    }
    template <class T> static T share(T from, T to, T at) {
        return math::clamp((at - from) / (to - from), T(0.0), T(1.0));
    }
    // 1 in the column of speed 0.
    template <class T, int Wheels> static T at_rest(const Parameters<T, Wheels> &p, std::size_t column) {
        return math::select(math::less(T(0.0), math::abs(p.bumper_table_speed[column])), T(0.0), T(1.0));
    }
    template <class T, int Wheels> static T static_force(const Parameters<T, Wheels> &p, std::size_t row) {
        T sum = T(0.0);
        for (std::size_t column = 0; column < columns_of(p); ++column) {
            sum = sum + at_rest(p, column) * force(p, row, column);
        }
        return sum;
    }

    // The forces of each speed at this travel; constant beyond the table's ends.
    template <class T, int Wheels> static std::array<T, columns> forces_at(const Parameters<T, Wheels> &p, T c) {
        std::array<T, columns> at{};
        for (std::size_t column = 0; column < columns_of(p); ++column) {
            at[column] = force(p, 0, column);
        }
        for (std::size_t row = 0; row + 1 < rows_of(p); ++row) {
            const T t = share(p.bumper_table_travel[row], p.bumper_table_travel[row + 1], c);
            for (std::size_t column = 0; column < columns_of(p); ++column) {
                at[column] = at[column] + (force(p, row + 1, column) - force(p, row, column)) * t;
            }
        }
        return at;
    }

    template <class T, int Wheels> [[gnu::noinline]] static LawForce<T> spring(const Parameters<T, Wheels> &p, T c) {
        LawForce<T> sum{static_force(p, 0), static_force(p, 0) * c};
        for (std::size_t row = 0; row + 1 < rows_of(p); ++row) {
            const T from = p.bumper_table_travel[row];
            const T to = p.bumper_table_travel[row + 1];
            const T t = share(from, to, c);
            const T rise = static_force(p, row + 1) - static_force(p, row);
            sum.force = sum.force + rise * t;
            sum.stored = sum.stored + rise * (T(0.5) * (to - from) * t * t + math::max(c - to, T(0.0)));
        }
        return sum;
    }
    // Beyond the greatest speeds the last slopes go on; the table never pulls.
    template <class T, int Wheels> [[gnu::noinline]] static T drag(const Parameters<T, Wheels> &p, T c, T rate) {
        const std::array<T, columns> at = forces_at(p, c);
        const T zero(0.0);
        const T one(1.0);
        T sum = zero;
        T rest = zero; // static force
        for (std::size_t column = 0; column < columns_of(p); ++column) {
            rest = rest + at_rest(p, column) * at[column];
        }
        for (std::size_t column = 0; column + 1 < columns_of(p); ++column) {
            const T from = p.bumper_table_speed[column];
            const T to = p.bumper_table_speed[column + 1];
            T up = math::max((rate - from) / (to - from), zero);
            T down = math::max((to - rate) / (to - from), zero);
            up = column + 2 < columns_of(p) ? math::min(up, one) : up;
            down = column > 0 ? math::min(down, one) : down;
            const T moved = math::select(math::less(from, zero), zero - down, up);
            sum = sum + (at[column + 1] - at[column]) * moved;
        }
        return math::max(sum, zero - rest);
    }
    template <class T, int Wheels> static T rest_force(const Parameters<T, Wheels> &p) { return static_force(p, 0); }
    template <class T, int Wheels> static T rest_stiffness(const Parameters<T, Wheels> &) { return T(0.0); }

    static double greatest_stiffness(const Parameters<double> &p) {
        double greatest = 0.0;
        for (std::size_t row = 0; row + 1 < rows_of(p); ++row) {
            const double length = p.bumper_table_travel[row + 1] - p.bumper_table_travel[row];
            for (std::size_t column = 0; column < columns_of(p); ++column) {
                greatest = std::max(greatest, math::abs(force(p, row + 1, column) - force(p, row, column)) / length);
            }
        }
        return greatest;
    }
    static double greatest_damping(const Parameters<double> &p, double) {
        double greatest = 0.0;
        for (std::size_t row = 0; row < rows_of(p); ++row) {
            for (std::size_t column = 0; column + 1 < columns_of(p); ++column) {
                const double step = p.bumper_table_speed[column + 1] - p.bumper_table_speed[column];
                greatest = std::max(greatest, (force(p, row, column + 1) - force(p, row, column)) / step);
            }
        }
        return greatest;
    }
};

} // namespace giveway::plant
