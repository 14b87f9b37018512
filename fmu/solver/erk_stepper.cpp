// ARKODE's explicit Runge-Kutta pair of Dormand and Prince, 5(4).
#include <new>

#include <arkode/arkode_erkstep.h>

#include "stepper.hpp"

namespace giveway::solver {

namespace {

class ErkStepper final : public Stepper {
public:
    ~ErkStepper() override {
        if (arkode_ != nullptr) {
            ARKodeFree(&arkode_);
        }
    }

    int create(Problem &problem, double time_s, const IntegratorOptions &options) override {
        problem_ = &problem;
        problem.set_accepted_time(time_s);
        arkode_ = ERKStepCreate(Problem::rhs, time_s, problem.state(), problem.context());
        if (arkode_ == nullptr) {
            return ARK_MEM_FAIL;
        }
        int code = ARKodeSetUserData(arkode_, problem_);
        code = code != 0 ? code : ERKStepSetTableNum(arkode_, ARKODE_DORMAND_PRINCE_7_4_5);
        code = code != 0 ? code : ARKodeSVtolerances(arkode_, options.relative_tolerance, problem.tolerance());
        code = code != 0 ? code : ARKodeSetMaxNumSteps(arkode_, max_steps_between_stops);
        // A failed step leaves ARKODE's clock at one of its stages, so the time of the state is stored here.
        code = code != 0 ? code : ARKodeSetPostprocessStepFn(arkode_, Problem::accepted);
        if (options.maximum_step_s > 0.0) {
            code = code != 0 ? code : ARKodeSetMaxStep(arkode_, options.maximum_step_s);
        }
        const int events = problem.system().event_count();
        if (events > 0) {
            code = code != 0 ? code : ARKodeRootInit(arkode_, events, Problem::roots);
            // An indicator that starts at zero (a mode just entered) is monitored from its first change on.
            code = code != 0 ? code : ARKodeSetNoInactiveRootWarn(arkode_);
        }
        return code;
    }

    int restart(double time_s, double first_step_s) override {
        problem_->set_accepted_time(time_s);
        const int code = ARKodeReset(arkode_, time_s, problem_->state());
        return code != 0 ? code : ARKodeSetInitStep(arkode_, first_step_s);
    }

    Outcome evolve(double end_s, double &time_s) override {
        long before = 0;
        long after = 0;
        (void)ARKodeGetNumSteps(arkode_, &before);
        (void)ARKodeSetStopTime(arkode_, end_s);
        code_ = ARKodeEvolve(arkode_, end_s, problem_->state(), &time_s, ARK_NORMAL);
        (void)ARKodeGetNumSteps(arkode_, &after);
        steps_ += after - before;
        if (code_ < 0) {
            time_s = problem_->accepted_time();
            return Outcome::failed;
        }
        if (code_ == ARK_ROOT_RETURN) {
            return Outcome::event;
        }
        time_s = end_s;
        return Outcome::reached;
    }

    void fired(int *direction) const override { (void)ARKodeGetRootInfo(arkode_, direction); }

    // A stop time shortens the last step and hides ARKODE's own proposal: try twice the step; the error test corrects
    // it.
    double first_step() const override { return 2.0 * last_step(); }

    double last_step() const override {
        double last_step_s = 0.0;
        (void)ARKodeGetLastStep(arkode_, &last_step_s);
        return last_step_s;
    }

    std::int64_t steps() const override { return steps_; }
    int code() const override { return code_; }

    char *code_name(int code) const override { return ARKodeGetReturnFlagName(code); }

private:
    Problem *problem_ = nullptr;
    void *arkode_ = nullptr;
    std::int64_t steps_ = 0;
    int code_ = 0;
};

} // namespace

Stepper *new_erk_stepper() { return new (std::nothrow) ErkStepper; }

} // namespace giveway::solver
