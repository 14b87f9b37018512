#include "generator.h"
#include "giveway/gw_admittance.h"
#include "giveway/gw_controller.h"
#include "giveway/gw_math.h"
#include "giveway/gw_servo.h"
#include "modules.h"
#include "random_robot.h"

static const gw_real_t period_s = (gw_real_t)0.001;

digest_t drive_admittance(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(16U);
    static const uint32_t kinds[] = {GW_ADMITTANCE_FROZEN_IMPULSE, GW_ADMITTANCE_LIVE_FORCE, 3U /* refused */};
    for (uint32_t k = 0U; k < 3U; k++) {
        gw_controller_config_t trikey;
        gw_admittance_t admittance;
        gw_controller_config_paper(&trikey);
        trikey.admittance.kind = kinds[k];
        digest_u32(&digest, (uint32_t)gw_admittance_init(&admittance, &trikey.admittance, period_s));
        for (uint32_t hit = 0U; hit < 5U; hit++) {
            const gw_rotation_t towards = gw_sincos(generator_between(&generator, -GW_PI, GW_PI));
            const gw_vector_t direction = {towards.cosine, towards.sine};
            const gw_vector_t velocity_mps = generator_vector(&generator, GW_HALF);
            digest_u32(&digest, (uint32_t)gw_admittance_start(&admittance, velocity_mps, direction));
            for (uint32_t i = 0U; i < 600U; i++) {
                const gw_wrench_t felt = generator_wrench(&generator, (gw_real_t)5.0, GW_ONE);
                const gw_vector_t force_n = {felt.force_x_n, felt.force_y_n};
                gw_admittance_output_t output;
                digest_u32(&digest, (uint32_t)gw_admittance_step(&admittance, force_n, &output));
                digest_vector(&digest, output.velocity_mps);
                digest_vector(&digest, output.displacement_m);
            }
        }
    }
    return digest;
}

#if (GW_WITH_ESCAPE == 1)
/* The escape, with everything on, turned and redirected. */
digest_t drive_escape(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(29U);
    gw_controller_config_t trikey;
    gw_kinematics_t kinematics;
    gw_admittance_t admittance;
    gw_tip_t tip;
    gw_controller_config_paper(&trikey);
    trikey.admittance.kind = GW_ADMITTANCE_ESCAPE;
    trikey.admittance.smoothing_s = (gw_real_t)0.03;
    trikey.admittance.brake_limit_mps2 = (gw_real_t)4.0;
    trikey.admittance.push_share = GW_TWO;
    trikey.admittance.ahead_mps = (gw_real_t)0.05;
    trikey.admittance.tip.height_m = (gw_real_t)0.414;
    digest_u32(&digest, (uint32_t)gw_kinematics_init(&kinematics, &trikey.geometry));
    gw_tip_init(&tip, &trikey.admittance.tip, &kinematics);
    digest_u32(&digest, (uint32_t)gw_admittance_init(&admittance, &trikey.admittance, period_s));
    gw_admittance_set_tip(&admittance, &tip);
    for (uint32_t hit = 0U; hit < 8U; hit++) {
        const gw_rotation_t towards = gw_sincos(generator_between(&generator, -GW_PI, GW_PI));
        const gw_vector_t direction = {towards.cosine, towards.sine};
        const gw_vector_t velocity_mps = generator_vector(&generator, GW_HALF);
        digest_u32(&digest, (uint32_t)gw_admittance_start(&admittance, velocity_mps, direction));
        for (uint32_t i = 0U; i < 600U; i++) {
            static const gw_vector_t no_force = {0};
            gw_admittance_output_t output;
            gw_admittance_face(&admittance, gw_sincos(generator_between(&generator, -GW_PI, GW_PI)));
            if (i < 60U) {
                gw_admittance_redirect(&admittance, direction);
            }
            if (i < 100U) {
                gw_admittance_brake(&admittance);
            } else if (i < 200U) {
                const gw_vector_t force_n = generator_vector(&generator, (gw_real_t)60.0);
                gw_admittance_yield(&admittance, force_n, (gw_real_t)4.0, (gw_real_t)35.0,
                                    generator_vector(&generator, GW_HALF));
            } else {
                /* not touched any more */
            }
            digest_u32(&digest, (uint32_t)gw_admittance_step(&admittance, no_force, &output));
            digest_vector(&digest, output.velocity_mps);
            digest_vector(&digest, output.displacement_m);
        }
    }
    return digest;
}
#endif

static void add_reference(digest_t *digest, const gw_reference_t *reference, const gw_plan_t *plan)
{
    digest_pose(digest, gw_reference_pose(reference));
    digest_twist(digest, reference->twist);
    digest_acceleration(digest, reference->acceleration);
    digest_pose(digest, reference->displacement);
    digest_real(digest, gw_reference_distance(reference, plan));
    digest_real(digest, gw_reference_angle(reference, plan));
}

static gw_plan_t random_plan(generator_t *generator)
{
    gw_plan_t plan;
    plan.pose.x_m = generator_between(generator, -GW_ONE, GW_ONE);
    plan.pose.y_m = generator_between(generator, -GW_ONE, GW_ONE);
    plan.pose.theta_rad = generator_between(generator, (gw_real_t)-100.0, (gw_real_t)100.0);
    plan.twist = generator_twist(generator, GW_HALF, GW_ONE);
    plan.acceleration.ax_mps2 = generator_between(generator, -GW_ONE, GW_ONE);
    plan.acceleration.ay_mps2 = generator_wild(generator, GW_ONE);
    plan.acceleration.alpha_radps2 = generator_between(generator, -GW_ONE, GW_ONE);
    return plan;
}

digest_t drive_reference(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(17U);
    gw_controller_config_t trikey;
    gw_reference_t reference;
    gw_controller_config_paper(&trikey);
    digest_u32(&digest, (uint32_t)gw_reference_init(&reference, &trikey.reference, period_s));
    for (uint32_t phase = 0U; phase < 40U; phase++) {
        gw_plan_t plan = random_plan(&generator);
        const bool valid = gw_plan_is_valid(&plan);
        const uint32_t what = valid ? (phase % 5U) : 4U;
        if (valid && generator_one_in(&generator, 8U)) {
            gw_reference_place(&reference, &plan, generator_one_in(&generator, 2U));
        }
        for (uint32_t i = 0U; i < 100U; i++) {
            if (what <= 1U) {
                plan.pose.x_m += plan.twist.vx_mps * period_s;
                gw_reference_follow(&reference, &plan, what == 1U);
            } else if (what == 2U) {
                const gw_vector_t displacement_m = generator_vector(&generator, period_s);
                gw_reference_escape(&reference, displacement_m, generator_vector(&generator, GW_HALF));
            } else if (what == 3U) {
                gw_reference_brake(&reference);
            } else {
                gw_reference_freeze(&reference);
            }
            add_reference(&digest, &reference, &plan);
        }
    }
    return digest;
}

digest_t drive_joint(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(18U);
    for (uint32_t k = 0U; k < 10U; k++) {
        const gw_kinematics_t kinematics = random_kinematics(&generator);
        const gw_wheels_t start = generator_wheels(&generator, (gw_real_t)100.0);
        gw_joint_t joint;
        gw_joint_init(&joint);
        gw_joint_place(&joint, &start);
        for (uint32_t i = 0U; i < 200U; i++) {
            const gw_twist_t moved = generator_twist(&generator, (gw_real_t)0.01, (gw_real_t)0.1);
            const gw_pose_t displacement = {moved.vx_mps, moved.vy_mps, moved.omega_radps};
            const gw_twist_t twist = generator_twist(&generator, GW_ONE, GW_TWO);
            gw_joint_command_t command;
            if (generator_one_in(&generator, 10U)) {
                gw_joint_hold(&joint, &command);
            } else {
                const gw_real_t theta_rad = generator_between(&generator, -GW_PI, GW_PI);
                gw_joint_step(&joint, &kinematics, displacement, theta_rad, gw_sincos(theta_rad), twist, &command);
            }
            digest_reals(&digest, command.angle_rad, GW_WHEEL_COUNT);
            digest_reals(&digest, command.speed_radps, GW_WHEEL_COUNT);
        }
    }
    return digest;
}

digest_t drive_servo(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(19U);
    gw_servo_config_t config = {
        (gw_real_t)0.0005, (gw_real_t)203.0, (gw_real_t)8.0, (gw_real_t)20.0, GW_ZERO, 8500U, (gw_real_t)60.0, 10U};
    for (uint32_t k = 0U; k < 3U; k++) {
        gw_servo_t servo;
        gw_servo_input_t input = {GW_ZERO, GW_ZERO, false, true, 0};
        uint32_t count = 0x7FFFFF00U; /* wraps soon */
        config.torque_rate_limit_nm_per_s = (gw_real_t)(1000U * k);
        config.encoder_counts = (k == 2U) ? 3U : 8500U; /* refused */
        digest_u32(&digest, (uint32_t)gw_servo_init(&servo, &config));
        for (uint32_t i = 0U; i < 4000U; i++) {
            gw_servo_output_t output;
            count += generator_below(&generator, 6U);
            input.encoder_count = gw_count_difference((int32_t)(count & GW_TICK_MASK), 0);
            input.reference_is_new = generator_one_in(&generator, generator_one_in(&generator, 30U) ? 40U : 2U);
            input.angle_rad = generator_wild(&generator, GW_PI);
            input.speed_radps = generator_wild(&generator, (gw_real_t)5.0);
            input.enable = !generator_one_in(&generator, 50U);
            digest_u32(&digest, (uint32_t)gw_servo_step(&servo, &input, &output));
            digest_real(&digest, output.torque_nm);
            digest_real(&digest, output.angle_error_rad);
            digest_real(&digest, output.speed_radps);
        }
    }
    return digest;
}
