// df/dx of the plant, exact, by dual numbers: a chunk of columns per evaluation of the right-hand side.
#pragma once

#include <algorithm>

#include "convert.hpp"
#include "tipping.hpp"

namespace giveway::plant {

// Directions per evaluation.
inline constexpr int jacobian_chunk = 8;

template <int Wheels = table_wheels> class Jacobian {
    using At = Layout<Wheels>;

public:
    using Scalar = math::Dual<jacobian_chunk>;

    // Constant during a run; the arguments of evaluate() change between calls.
    void set_parameters(const Parameters<double, Wheels> &p, const Derived<double> &d) {
        parameters_ = convert<Scalar>(p);
        derived_ = convert<Scalar>(d);
    }

    // matrix[column * N + row] = d rate[row] / d x[column], N the number of states.
    template <std::size_t N>
    void evaluate(const std::array<double, N> &x, const Inputs<double, Wheels> &u, const Modes<double, Wheels> &m,
                  double *matrix) const {
        const auto inputs = convert<Scalar>(u);
        const auto modes = convert<Scalar>(m);
        auto state = detail::converted<Scalar>(x);
        std::fill_n(matrix, N * N, 0.0);
        for (std::size_t first = 0; first < N; first += jacobian_chunk) {
            // Nothing depends on the accounts (work, dissipation, impulses): their columns are zero.
            std::array<std::size_t, jacobian_chunk> columns{};
            std::size_t count = 0;
            for (std::size_t column = first; column < std::min<std::size_t>(first + jacobian_chunk, N); ++column) {
                if (column < At::work_in || column >= At::state_count) {
                    state[column] = Scalar::variable(x[column], static_cast<int>(count));
                    columns[count++] = column;
                }
            }
            if (count == 0) {
                continue;
            }
            const auto rate = rhs(state, inputs, modes, parameters_, derived_);
            for (std::size_t i = 0; i < count; ++i) {
                for (std::size_t row = 0; row < N; ++row) {
                    matrix[columns[i] * N + row] = rate[row].derivative[i];
                }
                state[columns[i]] = Scalar(x[columns[i]]);
            }
        }
    }

private:
    Parameters<Scalar, Wheels> parameters_{};
    Derived<Scalar> derived_{};
};

} // namespace giveway::plant
