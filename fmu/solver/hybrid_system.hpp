// The solver's view of a model: a smooth right-hand side between events, indicators that cross zero at events, and
// transitions there.
#pragma once

namespace giveway::solver {

class HybridSystem {
public:
    virtual ~HybridSystem() = default;
    [[nodiscard]] virtual int state_count() const = 0;
    [[nodiscard]] virtual int event_count() const = 0;
    virtual void rhs(double time_s, const double *state, double *rate) = 0;
    // matrix[column * state_count + row] = d rate[row] / d state[column]. False: the system has none, so an implicit
    // method cannot be used.
    virtual bool jacobian(double /*time_s*/, const double * /*state*/, double * /*matrix*/) { return false; }
    virtual void indicators(double time_s, const double *state, double *value) = 0;
    // fired[i]: +1 the indicator rose through zero, -1 it fell, 0 nothing.
    virtual void transition(double time_s, double *state, const int *fired) = 0;
    // Absolute tolerance of each state at the default relative tolerance.
    [[nodiscard]] virtual double absolute_tolerance(int state) const = 0;
};

} // namespace giveway::solver
