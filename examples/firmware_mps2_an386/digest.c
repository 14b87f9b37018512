#include "digest.h"

#include <string.h>

static void add_byte(digest_t *digest, uint32_t byte)
{
    digest->value = (digest->value ^ (byte & 0xFFU)) * 0x100000001B3U;
}

digest_t digest_begin(void)
{
    const digest_t digest = {0xCBF29CE484222325U};
    return digest;
}

void digest_u32(digest_t *digest, uint32_t word)
{
    for (uint32_t shift = 0U; shift < 32U; shift += 8U) {
        add_byte(digest, word >> shift);
    }
}

void digest_i32(digest_t *digest, int32_t word)
{
    digest_u32(digest, (uint32_t)word);
}

void digest_bool(digest_t *digest, bool truth)
{
    add_byte(digest, truth ? 1U : 0U);
}

/* The sign and payload of a NaN differ between processors and do not matter. */
#if (GW_REAL_DOUBLE == 1)
void digest_real(digest_t *digest, gw_real_t x)
{
    uint64_t bits = 0x7FF8000000000000U;
    if (x == x) {
        memcpy(&bits, &x, sizeof bits);
    }
    digest_u32(digest, (uint32_t)bits);
    digest_u32(digest, (uint32_t)(bits >> 32U));
}
#else
void digest_real(digest_t *digest, gw_real_t x)
{
    uint32_t bits = 0x7FC00000U;
    if (x == x) {
        memcpy(&bits, &x, sizeof bits);
    }
    digest_u32(digest, bits);
}
#endif

void digest_reals(digest_t *digest, const gw_real_t *x, uint32_t count)
{
    for (uint32_t i = 0U; i < count; i++) {
        digest_real(digest, x[i]);
    }
}

void digest_vector(digest_t *digest, gw_vector_t vector)
{
    digest_real(digest, vector.x);
    digest_real(digest, vector.y);
}

void digest_twist(digest_t *digest, gw_twist_t twist)
{
    digest_real(digest, twist.vx_mps);
    digest_real(digest, twist.vy_mps);
    digest_real(digest, twist.omega_radps);
}

void digest_wrench(digest_t *digest, gw_wrench_t wrench)
{
    digest_real(digest, wrench.force_x_n);
    digest_real(digest, wrench.force_y_n);
    digest_real(digest, wrench.torque_nm);
}

void digest_pose(digest_t *digest, gw_pose_t pose)
{
    digest_real(digest, pose.x_m);
    digest_real(digest, pose.y_m);
    digest_real(digest, pose.theta_rad);
}

void digest_contact(digest_t *digest, const gw_contact_estimate_t *contact)
{
    digest_real(digest, contact->force_n);
    digest_real(digest, contact->direction_rad);
    digest_vector(digest, contact->point_m);
    digest_bool(digest, contact->on_outline);
    digest_real(digest, contact->lever_arm_m);
    digest_real(digest, contact->lever_arm_sigma_m);
    digest_bool(digest, contact->valid);
}

void digest_controller(digest_t *digest, gw_status_t status, const gw_controller_output_t *output)
{
    digest_reals(digest, output->command.angle_rad, GW_WHEEL_COUNT);
    digest_reals(digest, output->command.speed_radps, GW_WHEEL_COUNT);
    digest_bool(digest, output->enable);
    digest_wrench(digest, output->estimate);
    digest_contact(digest, &output->contact);
    digest_bool(digest, output->detection_active);
    digest_u32(digest, output->detection_count);
    digest_i32(digest, output->detection_tick);
    digest_real(digest, output->detection_statistic);
    digest_real(digest, output->detection_wrench.force_x_n);
    digest_real(digest, output->detection_wrench.force_y_n);
    digest_real(digest, output->detection_contact.direction_rad);
    digest_vector(digest, output->detection_contact.point_m);
    digest_real(digest, output->detection_contact.lever_arm_sigma_m);
    digest_bool(digest, output->detection_contact.on_outline);
    digest_real(digest, output->detection_wrench.torque_nm);
    digest_pose(digest, output->reference_pose);
    digest_twist(digest, output->reference_twist);
    digest_u32(digest, output->path_ticks);
    digest_u32(digest, (uint32_t)output->mode);
    digest_u32(digest, (uint32_t)status);
    digest_u32(digest, output->tick);
}
