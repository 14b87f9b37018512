#include "giveway/gw_balance.h"

void gw_balance_approach(gw_balance_t *balance, const gw_balance_t *target, gw_real_t share)
{
    gw_wrench_approach(&balance->residual, &target->residual, share, GW_BALANCE_MAX);
    gw_model_forces_approach(&balance->model, &target->model, share, GW_BALANCE_MAX);
}

gw_balance_t gw_balance_difference(const gw_balance_t *from, const gw_balance_t *what)
{
    gw_balance_t difference;
    difference.residual.force_x_n = from->residual.force_x_n - what->residual.force_x_n;
    difference.residual.force_y_n = from->residual.force_y_n - what->residual.force_y_n;
    difference.residual.torque_nm = from->residual.torque_nm - what->residual.torque_nm;
    GW_UNROLLED
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        difference.model.friction_n.wheel[i] = from->model.friction_n.wheel[i] - what->model.friction_n.wheel[i];
    }
    difference.model.inertia_n.x = from->model.inertia_n.x - what->model.inertia_n.x;
    difference.model.inertia_n.y = from->model.inertia_n.y - what->model.inertia_n.y;
    difference.model.inertia_moment_nm = from->model.inertia_moment_nm - what->model.inertia_moment_nm;
    return difference;
}

gw_balance_t gw_balance_limited(const gw_wrench_t *residual, const gw_model_forces_t *model)
{
    gw_balance_t balance;
    balance.residual.force_x_n = gw_limited(residual->force_x_n, GW_BALANCE_MAX);
    balance.residual.force_y_n = gw_limited(residual->force_y_n, GW_BALANCE_MAX);
    balance.residual.torque_nm = gw_limited(residual->torque_nm, GW_BALANCE_MAX);
    GW_UNROLLED
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        balance.model.friction_n.wheel[i] = gw_limited(model->friction_n.wheel[i], GW_BALANCE_MAX);
    }
    balance.model.inertia_n.x = gw_limited(model->inertia_n.x, GW_BALANCE_MAX);
    balance.model.inertia_n.y = gw_limited(model->inertia_n.y, GW_BALANCE_MAX);
    balance.model.inertia_moment_nm = gw_limited(model->inertia_moment_nm, GW_BALANCE_MAX);
    return balance;
}

gw_wrench_t gw_balance_sum(gw_wrench_t a, gw_wrench_t b)
{
    const gw_wrench_t sum = {gw_limited(a.force_x_n + b.force_x_n, GW_BALANCE_MAX),
                             gw_limited(a.force_y_n + b.force_y_n, GW_BALANCE_MAX),
                             gw_limited(a.torque_nm + b.torque_nm, GW_BALANCE_MAX)};
    return sum;
}
