#include "problem.hpp"

#include <bit>

#include <sunmatrix/sunmatrix_dense.h>

namespace giveway::solver {

namespace {

// SUNDIALS prints to stderr unless told otherwise; failures are reported through HybridIntegrator::error() instead.
void silent(int, const char *, const char *, const char *, SUNErrCode, void *, SUNContext) {}

bool is_finite(double value) {
    constexpr std::uint64_t exponent = 0x7ffULL << 52U;
    return (std::bit_cast<std::uint64_t>(value) & exponent) != exponent;
}

} // namespace

Problem::~Problem() {
    if (tolerance_ != nullptr) {
        N_VDestroy(tolerance_);
    }
    if (state_ != nullptr) {
        N_VDestroy(state_);
    }
    if (context_ != nullptr) {
        SUNContext_Free(&context_);
    }
}

bool Problem::create(HybridSystem &system, const double *state, const IntegratorOptions &options) {
    system_ = &system;
    if (SUNContext_Create(SUN_COMM_NULL, &context_) != 0) {
        return false;
    }
    SUNContext_ClearErrHandlers(context_);
    SUNContext_PushErrHandler(context_, silent, nullptr);
    const int count = system.state_count();
    state_ = N_VNew_Serial(count, context_);
    tolerance_ = N_VNew_Serial(count, context_);
    if (state_ == nullptr || tolerance_ == nullptr) {
        return false;
    }
    for (int i = 0; i < count; ++i) {
        NV_Ith_S(state_, i) = state[i];
        NV_Ith_S(tolerance_, i) = system.absolute_tolerance(i) * options.absolute_tolerance_scale;
    }
    return true;
}

int Problem::bad_rate() const {
    const int count = latest_rate_ == nullptr ? 0 : system_->state_count();
    for (int i = 0; i < count; ++i) {
        if (!is_finite(NV_Ith_S(latest_rate_, i))) {
            return i;
        }
    }
    return -1;
}

int Problem::rhs(sunrealtype time, N_Vector y, N_Vector rate, void *user) {
    auto *self = static_cast<Problem *>(user);
    ++self->rhs_calls_;
    self->latest_rate_ = rate;
    self->system_->rhs(time, NV_DATA_S(y), NV_DATA_S(rate));
    return 0;
}

int Problem::checked_rhs(sunrealtype time, N_Vector y, N_Vector rate, void *user) {
    (void)rhs(time, y, rate, user);
    return static_cast<Problem *>(user)->bad_rate() < 0 ? 0 : 1;
}

int Problem::roots(sunrealtype time, N_Vector y, sunrealtype *value, void *user) {
    auto *self = static_cast<Problem *>(user);
    self->system_->indicators(time, NV_DATA_S(y), value);
    return 0;
}

int Problem::accepted(sunrealtype time, N_Vector, void *user) {
    static_cast<Problem *>(user)->accepted_time_s_ = time;
    return 0;
}

int Problem::jacobian(sunrealtype time, N_Vector y, N_Vector, SUNMatrix matrix, void *user, N_Vector, N_Vector,
                      N_Vector) {
    auto *self = static_cast<Problem *>(user);
    ++self->jacobian_calls_;
    return self->system_->jacobian(time, NV_DATA_S(y), SUNDenseMatrix_Data(matrix)) ? 0 : -1;
}

} // namespace giveway::solver
