// CVODE's variable-order multistep methods: Adams for smooth and mild systems, BDF for stiff ones.
#include <new>

#include <cvode/cvode.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "stepper.hpp"

namespace giveway::solver {

namespace {

class CvodeStepper final : public Stepper {
public:
    explicit CvodeStepper(Method method) : method_(method) {}
    ~CvodeStepper() override {
        if (cvode_ != nullptr) {
            CVodeFree(&cvode_);
        }
        if (corrector_ != nullptr) {
            SUNNonlinSolFree(corrector_);
        }
        if (linear_ != nullptr) {
            SUNLinSolFree(linear_);
        }
        if (matrix_ != nullptr) {
            SUNMatDestroy(matrix_);
        }
    }

    int create(Problem &problem, double time_s, const IntegratorOptions &options) override {
        problem_ = &problem;
        cvode_ = CVodeCreate(method_ == Method::adams ? CV_ADAMS : CV_BDF, problem.context());
        if (cvode_ == nullptr) {
            return CV_MEM_FAIL;
        }
        int code = CVodeInit(cvode_, Problem::checked_rhs, time_s, problem.state());
        code = code != 0 ? code : CVodeSetUserData(cvode_, problem_);
        code = code != 0 ? code : CVodeSVtolerances(cvode_, options.relative_tolerance, problem.tolerance());
        if (options.maximum_step_s > 0.0) {
            code = code != 0 ? code : CVodeSetMaxStep(cvode_, options.maximum_step_s);
        }
        const int events = problem.system().event_count();
        if (events > 0) {
            code = code != 0 ? code : CVodeRootInit(cvode_, events, Problem::roots);
            // An indicator that starts at zero (a mode just entered) is monitored from its first change on.
            code = code != 0 ? code : CVodeSetNoInactiveRootWarn(cvode_);
        }
        if (code != 0) {
            return code;
        }
        return method_ == Method::adams ? attach_fixed_point() : attach_newton();
    }

    int restart(double time_s, double first_step_s) override {
        const int code = CVodeReInit(cvode_, time_s, problem_->state());
        return code != 0 ? code : CVodeSetInitStep(cvode_, first_step_s);
    }

    Outcome evolve(double end_s, double &time_s) override {
        (void)CVodeSetStopTime(cvode_, end_s);
        long before = 0;
        long after = 0;
        (void)CVodeGetNumSteps(cvode_, &before);
        // Step by step, to learn CVODE's step size after the first one.
        do {
            code_ = CVode(cvode_, end_s, problem_->state(), &time_s, CV_ONE_STEP);
            (void)CVodeGetNumSteps(cvode_, &after);
            if (before == 0 && after == 1) {
                (void)CVodeGetCurrentStep(cvode_, &step_after_first_s_);
            }
            if (code_ == CV_SUCCESS && after - before >= max_steps_between_stops) {
                code_ = CV_TOO_MUCH_WORK;
            }
        } while (code_ == CV_SUCCESS);
        steps_ += after - before;
        if (code_ < 0) {
            return Outcome::failed;
        }
        if (code_ == CV_ROOT_RETURN) {
            return Outcome::event;
        }
        time_s = end_s;
        return Outcome::reached;
    }

    void fired(int *direction) const override { (void)CVodeGetRootInfo(cvode_, direction); }
    // A fresh start is of first order, so the guess is the proposal after the previous first step, minus a margin: a
    // first step that fails its error test costs more than a longer step gains. CVODE's own estimate would cost two
    // evaluations at every start.
    double first_step() const override { return 0.7 * step_after_first_s_; }

    double last_step() const override {
        double last_step_s = 0.0;
        (void)CVodeGetLastStep(cvode_, &last_step_s);
        return last_step_s;
    }
    std::int64_t steps() const override { return steps_; }
    int code() const override { return code_; }

    char *code_name(int code) const override { return CVodeGetReturnFlagName(code); }

private:
    // Contact is not stiff enough for a Newton iteration to pay off in an Adams method: it made the testbed three to
    // four times slower.
    int attach_fixed_point() {
        corrector_ = SUNNonlinSol_FixedPoint(problem_->state(), 0, problem_->context());
        return corrector_ == nullptr ? CV_MEM_FAIL : CVodeSetNonlinearSolver(cvode_, corrector_);
    }

    // CVODE's own Newton iteration over a dense matrix.
    int attach_newton() {
        const int count = problem_->system().state_count();
        matrix_ = SUNDenseMatrix(count, count, problem_->context());
        linear_ = matrix_ == nullptr ? nullptr : SUNLinSol_Dense(problem_->state(), matrix_, problem_->context());
        if (linear_ == nullptr) {
            return CV_MEM_FAIL;
        }
        const int code = CVodeSetLinearSolver(cvode_, linear_, matrix_);
        return code != 0 ? code : CVodeSetJacFn(cvode_, Problem::jacobian);
    }

    Method method_;
    Problem *problem_ = nullptr;
    void *cvode_ = nullptr;
    SUNNonlinearSolver corrector_ = nullptr;
    SUNLinearSolver linear_ = nullptr;
    SUNMatrix matrix_ = nullptr;
    std::int64_t steps_ = 0;
    double step_after_first_s_ = 0.0;
    int code_ = 0;
};

} // namespace

Stepper *new_cvode_stepper(Method method) { return new (std::nothrow) CvodeStepper(method); }

} // namespace giveway::solver
