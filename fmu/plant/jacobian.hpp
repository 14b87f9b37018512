// df/dx of the plant, exact, by dual numbers: a chunk of columns per evaluation of the right-hand side.
#pragma once

#include "convert.hpp"
#include "plant.hpp"

namespace giveway::plant {

// Nothing depends on the accounts at the end of the state (work, dissipation, impulses): their columns are zero.
inline constexpr int differentiated_states = work_in;
// Directions per evaluation.
inline constexpr int jacobian_chunk = 8;
static_assert(differentiated_states % jacobian_chunk == 0);

class Jacobian {
public:
    using Scalar = math::Dual<jacobian_chunk>;

    // Constant during a run; what changes between calls is handed to evaluate().
    void set_parameters(const Parameters<double>& p, const Derived<double>& d) {
        parameters_ = convert<Scalar>(p);
        derived_ = convert<Scalar>(d);
    }

    // matrix[column * state_count + row] = d rate[row] / d x[column].
    void evaluate(const StateVector<double>& x, const Inputs<double>& u, const Modes<double>& m, double* matrix) const {
        const auto inputs = convert<Scalar>(u);
        const auto modes = convert<Scalar>(m);
        auto state = detail::converted<Scalar>(x);
        double* column = matrix;
        for (int first = 0; first < differentiated_states; first += jacobian_chunk) {
            for (int i = 0; i < jacobian_chunk; ++i) {
                state[first + i] = Scalar::variable(x[first + i], i);
            }
            const auto rate = rhs(state, inputs, modes, parameters_, derived_);
            for (int i = 0; i < jacobian_chunk; ++i) {
                for (const Scalar& r : rate) {
                    *column++ = r.derivative[i];
                }
                state[first + i] = Scalar(x[first + i]);
            }
        }
        for (int entry = differentiated_states * state_count; entry < state_count * state_count; ++entry) {
            *column++ = 0.0;
        }
    }

private:
    Parameters<Scalar> parameters_{};
    Derived<Scalar> derived_{};
};

} // namespace giveway::plant
