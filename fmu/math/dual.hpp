// A value with its derivatives in N directions: with this T a function also computes its exact derivative. The value
// goes through the operations of double, so it has the same bits; the derivatives follow the chain rule.
#pragma once

#include <array>

#include "elementary.hpp"

namespace giveway::math {

template <int N> struct Dual {
    double value;
    std::array<double, N> derivative;

    Dual() : value(0.0), derivative{} {}
    explicit Dual(double constant) : value(constant), derivative{} {}
    Dual(double v, const std::array<double, N> &d) : value(v), derivative(d) {}
    // The variable of differentiation direction `index`.
    static Dual variable(double v, int index) {
        Dual a(v);
        a.derivative[static_cast<std::size_t>(index)] = 1.0;
        return a;
    }

    friend Dual operator+(const Dual &a, const Dual &b) {
        Dual c;
        c.value = a.value + b.value;
        for (std::size_t i = 0; i < N; ++i) {
            c.derivative[i] = a.derivative[i] + b.derivative[i];
        }
        return c;
    }
    friend Dual operator-(const Dual &a, const Dual &b) {
        Dual c;
        c.value = a.value - b.value;
        for (std::size_t i = 0; i < N; ++i) {
            c.derivative[i] = a.derivative[i] - b.derivative[i];
        }
        return c;
    }
    friend Dual operator*(const Dual &a, const Dual &b) {
        Dual c;
        c.value = a.value * b.value;
        for (std::size_t i = 0; i < N; ++i) {
            c.derivative[i] = a.derivative[i] * b.value + a.value * b.derivative[i];
        }
        return c;
    }
    friend Dual operator/(const Dual &a, const Dual &b) {
        Dual c;
        c.value = a.value / b.value;
        const double inverse = 1.0 / b.value;
        for (std::size_t i = 0; i < N; ++i) {
            c.derivative[i] = (a.derivative[i] - c.value * b.derivative[i]) * inverse;
        }
        return c;
    }
};

namespace detail {

// f(a), given f and f' at a's value.
template <int N> Dual<N> chain(double value, double slope, const Dual<N> &a) {
    Dual<N> c;
    c.value = value;
    for (std::size_t i = 0; i < N; ++i) {
        c.derivative[i] = slope * a.derivative[i];
    }
    return c;
}

} // namespace detail

template <int N> Mask less(const Dual<N> &a, const Dual<N> &b) { return a.value < b.value; }
template <int N> Dual<N> select(Mask mask, const Dual<N> &if_true, const Dual<N> &if_false) {
    return mask ? if_true : if_false;
}
// At a tie the derivative is that of the second argument, like the value.
template <int N> Dual<N> min(const Dual<N> &a, const Dual<N> &b) { return a.value < b.value ? a : b; }
template <int N> Dual<N> max(const Dual<N> &a, const Dual<N> &b) { return a.value > b.value ? a : b; }
// 0 has the derivative from the right.
template <int N> Dual<N> abs(const Dual<N> &a) { return detail::chain(abs(a.value), a.value < 0.0 ? -1.0 : 1.0, a); }
// At 0 the derivative is infinite. It is set to 0, so that a vanishing distance stays usable: infinity would become NaN
// in the next product.
template <int N> Dual<N> sqrt(const Dual<N> &a) {
    const double root = sqrt(a.value);
    return detail::chain(root, root > 0.0 ? 0.5 / root : 0.0, a);
}
template <int N> Dual<N> round(const Dual<N> &a) { return Dual<N>(round(a.value)); }

// Where exp and expm1 clamp their argument, they are constant.
template <int N> Dual<N> exp(const Dual<N> &a) {
    const double e = exp(a.value);
    return detail::chain(e, detail::exp_minimum < a.value && a.value < detail::exp_maximum ? e : 0.0, a);
}
template <int N> Dual<N> expm1(const Dual<N> &a) {
    const double e = expm1(a.value);
    return detail::chain(e, detail::exp_minimum < a.value && a.value < detail::exp_maximum ? e + 1.0 : 0.0, a);
}
template <int N> Dual<N> log(const Dual<N> &a) { return detail::chain(log(a.value), 1.0 / a.value, a); }
template <int N> Dual<N> tanh(const Dual<N> &a) {
    const double t = tanh(a.value);
    return detail::chain(t, (1.0 - t) * (1.0 + t), a);
}
template <int N> SinCos<Dual<N>> sincos(const Dual<N> &a) {
    const auto [sin, cos] = sincos(a.value);
    return {detail::chain(sin, cos, a), detail::chain(cos, -sin, a)};
}

} // namespace giveway::math
