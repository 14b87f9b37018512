#include <arkode/arkode.h>
#include <cvode/cvode.h>

#include "stepper.hpp"

namespace giveway::solver {

// ARKODE and CVODE number their failures alike.
static_assert(ARK_TOO_MUCH_WORK == CV_TOO_MUCH_WORK && ARK_TOO_MUCH_ACC == CV_TOO_MUCH_ACC &&
              ARK_ERR_FAILURE == CV_ERR_FAILURE && ARK_CONV_FAILURE == CV_CONV_FAILURE && ARK_MEM_FAIL == CV_MEM_FAIL);

const char *reason(int code) {
    switch (code) {
    case CV_TOO_MUCH_WORK:
        return "too many steps between two stops";
    case CV_TOO_MUCH_ACC:
        return "the tolerances ask for more than the precision of the arithmetic";
    case CV_ERR_FAILURE:
        return "the error stays above its tolerance, however short the step";
    case CV_CONV_FAILURE:
        return "the corrector does not converge, however short the step";
    case CV_LSETUP_FAIL:
        return "the system offers no Jacobian";
    case CV_MEM_FAIL:
        return "memory is short";
    default:
        return "SUNDIALS gave up";
    }
}

} // namespace giveway::solver
