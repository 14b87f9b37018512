#include "giveway/gw_estimator.h"

#include "giveway/gw_math.h"
#include "giveway/gw_trikey.h"

/* Before the first tick: no source is another one. */
#define NO_SOURCE UINT32_MAX

static const gw_wheels_t no_torque = {0};

#if (GW_WITH_CHANNELS == 1)
static void know_no_motor(gw_estimator_config_t *config)
{
    gw_motor_config_none(&config->motor);
}

static void check_motor(const gw_estimator_config_t *config, gw_config_error_t *error)
{
    gw_motor_config_check(&config->motor, error);
}
#else
static void know_no_motor(const gw_estimator_config_t *config)
{
    (void)config;
}

static void check_motor(const gw_estimator_config_t *config, const gw_config_error_t *error)
{
    (void)config;
    (void)error;
}
#endif

void gw_estimator_config_trikey(gw_estimator_config_t *config)
{
    config->velocity_source = GW_SOURCE_PLANNED;
    config->acceleration_source = GW_SOURCE_PLANNED;
    config->torque_noise_nm = GW_TRIKEY_DRIVETRAIN_TORQUE_NOISE_NM;
    config->rate_cutoff_radps = (gw_real_t)200.0;
    config->drivetrain_stiffness_nm_per_rad = GW_TRIKEY_DRIVETRAIN_STIFFNESS_NM_PER_RAD;
    config->encoder_counts = GW_TRIKEY_DRIVETRAIN_ENCODER_COUNTS;
    config->average_window = 20U;
    config->rest_speed_mps = (gw_real_t)0.002;
    config->creep_speed_mps = (gw_real_t)0.03; /* rollers slide steadily above */
    config->rest_ticks = 300U;
    config->tare_ticks = 100U;
    config->retare_ticks = 100U;
    config->tare_variation_nm = (gw_real_t)0.5;
    config->friction_model = GW_FRICTION_TANH;
    config->aligned = 0U;
    gw_presliding_config_trikey(&config->presliding);
    gw_gear_config_none(&config->gear);
    know_no_motor(config);
}

void gw_estimator_config_check(const gw_estimator_config_t *config, gw_config_error_t *error)
{
    gw_config_check_count(error, GW_FIELD_ESTIMATOR_VELOCITY_SOURCE, config->velocity_source);
    gw_config_check_count(error, GW_FIELD_ESTIMATOR_ACCELERATION_SOURCE, config->acceleration_source);
    gw_config_check_real(error, GW_FIELD_ESTIMATOR_TORQUE_NOISE, config->torque_noise_nm);
    gw_config_check_real(error, GW_FIELD_ESTIMATOR_RATE_CUTOFF, config->rate_cutoff_radps);
    gw_config_check_real(error, GW_FIELD_ESTIMATOR_DRIVETRAIN_STIFFNESS, config->drivetrain_stiffness_nm_per_rad);
    gw_config_check_count(error, GW_FIELD_ESTIMATOR_ENCODER_COUNTS, config->encoder_counts);
    gw_config_check_count(error, GW_FIELD_ESTIMATOR_AVERAGE_WINDOW, config->average_window);
    gw_config_check_real(error, GW_FIELD_ESTIMATOR_REST_SPEED, config->rest_speed_mps);
    gw_config_check_real(error, GW_FIELD_ESTIMATOR_CREEP_SPEED, config->creep_speed_mps);
    gw_config_check_count(error, GW_FIELD_ESTIMATOR_REST_TICKS, config->rest_ticks);
    gw_config_check_count(error, GW_FIELD_ESTIMATOR_TARE_TICKS, config->tare_ticks);
    gw_config_check_count(error, GW_FIELD_ESTIMATOR_RETARE_TICKS, config->retare_ticks);
    gw_config_check_real(error, GW_FIELD_ESTIMATOR_TARE_VARIATION, config->tare_variation_nm);
    gw_config_check_count(error, GW_FIELD_ESTIMATOR_FRICTION_MODEL, config->friction_model);
    gw_config_check_count(error, GW_FIELD_ESTIMATOR_ALIGNED, config->aligned);
#if (GW_WITH_CHANNELS == 1)
    if ((config->acceleration_source != GW_SOURCE_MEASURED) && (config->acceleration_source != GW_SOURCE_IMU)) {
        gw_config_check_relation(error, GW_FIELD_ESTIMATOR_ALIGNED, 0U, (gw_real_t)config->aligned, GW_ZERO, GW_ZERO);
    }
#endif
    gw_presliding_config_check(&config->presliding, error);
    gw_gear_config_check(&config->gear, error);
    check_motor(config, error);
}

static const gw_wheels_t *present_zero(const gw_estimator_t *estimator)
{
    return estimator->rest ? &estimator->rest_zero_nm : &estimator->run_zero_nm;
}

/* No robot plans to move or accelerate beyond these; a reference that does is a fault. */
#define PLANNED_SPEED_MAX ((gw_real_t)1.0e4)
#define PLANNED_ACCELERATION_MAX ((gw_real_t)1.0e8)
#define STEP_MAX ((gw_real_t)1.0e20) /* N, of a change of zeros: beyond any that a valid wrench has */
#define GEAR_MAX_N2 ((gw_real_t)1.0e12)

/* The same acceleration for a valid one, as provers need to be told. */
static gw_acceleration_t known_acceleration(gw_acceleration_t acceleration)
{
    const gw_acceleration_t known = {gw_known_within(acceleration.ax_mps2, PLANNED_ACCELERATION_MAX),
                                     gw_known_within(acceleration.ay_mps2, PLANNED_ACCELERATION_MAX),
                                     gw_known_within(acceleration.alpha_radps2, PLANNED_ACCELERATION_MAX)};
    return known;
}

#if (GW_WITH_CHANNELS == 1)
static gw_acceleration_t limited_acceleration(gw_acceleration_t acceleration)
{
    const gw_acceleration_t limited = {gw_limited(acceleration.ax_mps2, PLANNED_ACCELERATION_MAX),
                                       gw_limited(acceleration.ay_mps2, PLANNED_ACCELERATION_MAX),
                                       gw_limited(acceleration.alpha_radps2, PLANNED_ACCELERATION_MAX)};
    return limited;
}

/* Where the acceleration comes from in this tick. */
static uint32_t source_of(const gw_estimator_t *estimator, const gw_estimator_input_t *input)
{
    uint32_t source = estimator->config.acceleration_source;
    if (source == GW_SOURCE_IMU) {
        const gw_acceleration_t felt = input->imu.acceleration;
        const bool usable = input->imu.trusted && gw_within(felt.ax_mps2, PLANNED_ACCELERATION_MAX) &&
                            gw_within(felt.ay_mps2, PLANNED_ACCELERATION_MAX) &&
                            gw_within(felt.alpha_radps2, PLANNED_ACCELERATION_MAX);
        source = usable ? GW_SOURCE_IMU : GW_SOURCE_MEASURED;
    }
    return source;
}

static bool has_other_source(const gw_estimator_t *estimator, uint32_t source)
{
    return (estimator->last_source != NO_SOURCE) && (source != estimator->last_source);
}

GW_SMALL static bool has_other_bias(const gw_estimator_input_t *input, uint32_t source)
{
    return (source == GW_SOURCE_IMU) &&
           (gw_max(gw_magnitude(input->imu.zero_step.ax_mps2), gw_magnitude(input->imu.zero_step.ay_mps2)) > GW_ZERO);
}

/* Adds what another source of the acceleration, or another zero of the IMU, has changed in the wrench, which is valid.
 */
static void tell_source_step(gw_estimator_t *estimator, const gw_estimator_input_t *input,
                             gw_estimator_output_t *output)
{
    const gw_wrench_t wrench = gw_wrench_known_valid(output->wrench);
    gw_wrench_t *const step = &output->zero_step;
    if (has_other_source(estimator, output->acceleration_source)) {
        step->force_x_n = wrench.force_x_n - estimator->last_wrench.force_x_n;
        step->force_y_n = wrench.force_y_n - estimator->last_wrench.force_y_n;
        step->torque_nm = wrench.torque_nm - estimator->last_wrench.torque_nm;
    } else if (has_other_bias(input, output->acceleration_source)) {
        const gw_acceleration_t change = limited_acceleration(input->imu.zero_step);
        step->force_x_n = gw_limited(step->force_x_n + (estimator->nominal.total_mass_kg * change.ax_mps2), STEP_MAX);
        step->force_y_n = gw_limited(step->force_y_n + (estimator->nominal.total_mass_kg * change.ay_mps2), STEP_MAX);
    } else {
        /* as it was */
    }
    estimator->last_wrench = wrench;
    estimator->last_source = output->acceleration_source;
}

static void forget_source(gw_estimator_t *estimator)
{
    estimator->last_source = NO_SOURCE;
}

void gw_estimator_set_imu_cutoff(gw_estimator_t *estimator, gw_real_t cutoff_radps)
{
    /* The period was checked; a cutoff that is refused changes nothing. */
    (void)gw_rate_filter_constants(&estimator->imu_constants, estimator->rate_constants.period_s, cutoff_radps,
                                   estimator->config.encoder_counts, GW_ZERO);
}

/* Passes three values through the low-pass of the measured acceleration, if the balance is to be aligned. */
static void align(const gw_estimator_t *estimator, uint32_t source, gw_lowpass_t filter[GW_WHEEL_COUNT],
                  gw_wheels_t *values)
{
    if (estimator->config.aligned != 0U) {
        const gw_rate_filter_constants_t constants =
            (source == GW_SOURCE_IMU) ? estimator->imu_constants : estimator->rate_constants;
        for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
            values->wheel[i] = gw_lowpass_step(&filter[i], &constants, values->wheel[i], GW_TORQUE_MAX);
        }
    }
}

static void align_friction(gw_estimator_t *estimator, uint32_t source, gw_wheels_t *friction_nm)
{
    align(estimator, source, estimator->aligned_friction, friction_nm);
}

static void align_torque(gw_estimator_t *estimator, uint32_t source, gw_wheels_t *torque_nm)
{
    align(estimator, source, estimator->aligned_torque, torque_nm);
}

/* The model's forces, for whoever wants to know how uncertain they are. */
static void tell_forces(const gw_estimator_t *estimator, const gw_wheels_t *friction_nm, gw_acceleration_t acceleration,
                        gw_estimator_output_t *output)
{
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        output->forces.friction_n.wheel[i] = friction_nm->wheel[i] * estimator->kinematics.per_roller_radius;
    }
    output->forces.inertia_n.x = estimator->nominal.total_mass_kg * acceleration.ax_mps2;
    output->forces.inertia_n.y = estimator->nominal.total_mass_kg * acceleration.ay_mps2;
    output->forces.inertia_moment_nm = estimator->nominal.total_yaw_inertia_kgm2 * acceleration.alpha_radps2;
}

static void tell_torque(const gw_wheels_t *torque_nm, gw_estimator_output_t *output)
{
    output->torque_nm = *torque_nm;
}

/* Whether an encoder has moved since the last sample. */
static void tell_turns(const gw_estimator_t *estimator, const gw_estimator_input_t *input,
                       gw_estimator_output_t *output)
{
    uint32_t changed = 0U;
    GW_UNROLLED
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        changed |= (uint32_t)input->encoder_count[i] ^ (uint32_t)estimator->rate[i].last_count;
    }
    output->turned = estimator->rate[0].started && (changed != 0U); /* all of them start together */
}

/* By how much another zero has changed the wrench. */
GW_SMALL static void tell_zero_step(const gw_estimator_t *estimator, const gw_wheels_t *zero_before_nm,
                                    gw_estimator_output_t *output)
{
    output->zero_step = gw_wrench_external(&estimator->kinematics, present_zero(estimator), zero_before_nm);
}

static void init_alignment(gw_estimator_t *estimator)
{
    estimator->imu_constants = estimator->rate_constants;
    if (estimator->config.aligned != 0U) {
        gw_presliding_take_turns(&estimator->presliding);
    }
}

static void init_motor(gw_estimator_t *estimator)
{
    gw_motor_init(&estimator->motor, &estimator->config.motor, &estimator->rate_constants,
                  estimator->config.encoder_counts);
}

static bool motor_holds(const gw_estimator_t *estimator)
{
    return gw_motor_invariant_holds(&estimator->motor);
}

static void restart_motor(gw_estimator_t *estimator)
{
    gw_motor_restart(&estimator->motor);
}

/* The torque whose twist leads from the counts to the wheels; in `place`, unless it is the sensed one. */
static const gw_wheels_t *twist_torques(gw_estimator_t *estimator, const gw_estimator_input_t *input,
                                        const gw_wheels_t *torque_nm, gw_wheels_t *place, gw_estimator_output_t *output)
{
    *place = gw_motor_step(&estimator->motor, input->encoder_count, torque_nm, &output->counted);
    return place;
}

void gw_estimator_tell_command(gw_estimator_t *estimator, const gw_joint_command_t *command, bool enabled)
{
    gw_motor_command(&estimator->motor, command, enabled);
}

static bool alignment_holds(const gw_estimator_t *estimator)
{
    bool holds = motor_holds(estimator);
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        holds = holds && gw_lowpass_invariant_holds(&estimator->aligned_torque[i], GW_TORQUE_MAX) &&
                gw_lowpass_invariant_holds(&estimator->aligned_friction[i], GW_TORQUE_MAX);
    }
    return holds;
}

/* The acceleration that the IMU shows, if that is the source. */
static bool take_felt(const gw_estimator_input_t *input, uint32_t source, gw_acceleration_t *acceleration)
{
    const bool takes = (source == GW_SOURCE_IMU);
    if (takes) {
        *acceleration = known_acceleration(input->imu.acceleration);
    }
    return takes;
}

static void restart_alignment(gw_estimator_t *estimator)
{
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        gw_lowpass_restart(&estimator->aligned_torque[i]);
        gw_lowpass_restart(&estimator->aligned_friction[i]);
    }
}
#else
static uint32_t source_of(const gw_estimator_t *estimator, const gw_estimator_input_t *input)
{
    (void)input;
    return estimator->config.acceleration_source;
}

static bool has_other_source(const gw_estimator_t *estimator, uint32_t source)
{
    (void)estimator;
    (void)source;
    return false;
}

GW_SMALL static bool has_other_bias(const gw_estimator_input_t *input, uint32_t source)
{
    (void)input;
    (void)source;
    return false;
}

static void tell_source_step(const gw_estimator_t *estimator, const gw_estimator_input_t *input,
                             const gw_estimator_output_t *output)
{
    (void)estimator;
    (void)input;
    (void)output;
}

static void forget_source(const gw_estimator_t *estimator)
{
    (void)estimator;
}

static void align_friction(const gw_estimator_t *estimator, uint32_t source, const gw_wheels_t *friction_nm)
{
    (void)estimator;
    (void)source;
    (void)friction_nm;
}

static void align_torque(const gw_estimator_t *estimator, uint32_t source, const gw_wheels_t *torque_nm)
{
    (void)estimator;
    (void)source;
    (void)torque_nm;
}

static void tell_forces(const gw_estimator_t *estimator, const gw_wheels_t *friction_nm, gw_acceleration_t acceleration,
                        const gw_estimator_output_t *output)
{
    (void)estimator;
    (void)friction_nm;
    (void)acceleration;
    (void)output;
}

static void tell_torque(const gw_wheels_t *torque_nm, const gw_estimator_output_t *output)
{
    (void)torque_nm;
    (void)output;
}

static void tell_turns(const gw_estimator_t *estimator, const gw_estimator_input_t *input,
                       const gw_estimator_output_t *output)
{
    (void)estimator;
    (void)input;
    (void)output;
}

GW_SMALL static void tell_zero_step(const gw_estimator_t *estimator, const gw_wheels_t *zero_before_nm,
                                    const gw_estimator_output_t *output)
{
    (void)estimator;
    (void)zero_before_nm;
    (void)output;
}

static void init_alignment(const gw_estimator_t *estimator)
{
    (void)estimator;
}

static void init_motor(const gw_estimator_t *estimator)
{
    (void)estimator;
}

static void restart_motor(const gw_estimator_t *estimator)
{
    (void)estimator;
}

static const gw_wheels_t *twist_torques(const gw_estimator_t *estimator, const gw_estimator_input_t *input,
                                        const gw_wheels_t *torque_nm, const gw_wheels_t *place,
                                        const gw_estimator_output_t *output)
{
    (void)estimator;
    (void)input;
    (void)place;
    (void)output;
    return torque_nm;
}

static bool alignment_holds(const gw_estimator_t *estimator)
{
    (void)estimator;
    return true;
}

static bool take_felt(const gw_estimator_input_t *input, uint32_t source, const gw_acceleration_t *acceleration)
{
    (void)input;
    (void)source;
    (void)acceleration;
    return false;
}

static void restart_alignment(const gw_estimator_t *estimator)
{
    (void)estimator;
}
#endif

gw_status_t gw_estimator_init(gw_estimator_t *estimator, const gw_estimator_config_t *config,
                              const gw_geometry_config_t *geometry, const gw_inertia_config_t *inertia,
                              const gw_friction_config_t *friction, gw_real_t period_s)
{
    gw_status_t status = GW_STATUS_OK;
    if ((estimator == NULL) || (config == NULL)) {
        status = GW_STATUS_NULL_POINTER;
    } else {
        gw_config_error_t error;
        estimator->initialised = false;
        gw_config_check_begin(&error);
        gw_estimator_config_check(config, &error);
        if (error.field != GW_FIELD_NONE) {
            status = GW_STATUS_CONFIG_INVALID;
        } else {
            status = gw_kinematics_init(&estimator->kinematics, geometry);
        }
        if (status == GW_STATUS_OK) {
            status = gw_nominal_init(&estimator->nominal, inertia, friction, &estimator->kinematics);
        }
        if (status == GW_STATUS_OK) {
            status = gw_rate_filter_constants(&estimator->rate_constants, period_s, config->rate_cutoff_radps,
                                              config->encoder_counts, config->drivetrain_stiffness_nm_per_rad);
        }
        if (status == GW_STATUS_OK) {
            status = gw_presliding_init(&estimator->presliding, &config->presliding, friction, &estimator->kinematics);
        }
        if (status == GW_STATUS_OK) {
            estimator->initialised = true;
            estimator->config = *config;
            (void)gw_moving_average_init(&estimator->average, config->average_window); /* window was checked */
            estimator->run_zero_nm = no_torque;
            estimator->rest_zero_nm = no_torque;
            estimator->sigma = gw_wrench_noise(&estimator->kinematics, config->torque_noise_nm);
            init_alignment(estimator);
            init_motor(estimator);
            estimator->slow_ticks = 0U;
            estimator->rest = true;
            gw_tare_start(&estimator->run_tare);
            gw_tare_start(&estimator->stop_tare);
            gw_estimator_restart(estimator);
        }
    }
    return status;
}

bool gw_estimator_invariant_holds(const gw_estimator_t *estimator)
{
    bool holds = (estimator != NULL);
    if (holds) {
        holds = estimator->initialised;
    }
    if (holds) {
        gw_config_error_t error;
        gw_config_check_begin(&error);
        gw_estimator_config_check(&estimator->config, &error);
        holds = (error.field == GW_FIELD_NONE) && alignment_holds(estimator) &&
                gw_kinematics_invariant_holds(&estimator->kinematics) &&
                gw_nominal_invariant_holds(&estimator->nominal) && gw_tare_invariant_holds(&estimator->run_tare) &&
                gw_tare_invariant_holds(&estimator->stop_tare) &&
                gw_presliding_invariant_holds(&estimator->presliding) &&
                gw_moving_average_invariant_holds(&estimator->average) &&
                (estimator->average.window == estimator->config.average_window);
        for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
            holds = holds && gw_rate_filter_invariant_holds(&estimator->rate[i]) &&
                    gw_is_finite(estimator->run_zero_nm.wheel[i]) && gw_is_finite(estimator->rest_zero_nm.wheel[i]);
        }
    }
    return holds;
}

static void restart_filters(gw_estimator_t *estimator)
{
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        gw_rate_filter_restart(&estimator->rate[i]);
    }
    restart_alignment(estimator);
    restart_motor(estimator);
    gw_moving_average_reset(&estimator->average);
    forget_source(estimator);
}

void gw_estimator_restart(gw_estimator_t *estimator)
{
    restart_filters(estimator);
    gw_presliding_gap(&estimator->presliding);
}

void gw_estimator_start_tare(gw_estimator_t *estimator)
{
    gw_tare_start(&estimator->run_tare);
}

/* Zero of a tare: its mean torque minus the share of the deflected bristles. */
GW_SMALL static void take_zero(gw_estimator_t *estimator, const gw_wheels_t *mean_nm, gw_wheels_t *zero_nm)
{
    *zero_nm = *mean_nm;
    if (estimator->config.friction_model == GW_FRICTION_BRISTLE) {
        /* cppcheck-suppress misra-c2012-9.3 ; DEV-01 a whole struct from a call */
        const gw_wheels_t elastic_nm = gw_presliding_elastic_torques(&estimator->presliding, &estimator->kinematics);
        const gw_wrench_t held = gw_kinematics_wrench_of_rollers(&estimator->kinematics, &elastic_nm);
        /* cppcheck-suppress misra-c2012-9.3 ; DEV-01 a whole struct from a call */
        const gw_wheels_t held_nm = gw_kinematics_torques_of_wrench(&estimator->kinematics, held);
        for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
            zero_nm->wheel[i] = mean_nm->wheel[i] - held_nm.wheel[i];
        }
        gw_presliding_settle(&estimator->presliding, mean_nm);
    }
}

gw_tare_progress_t gw_estimator_tare(gw_estimator_t *estimator, const gw_wheels_t *torque_nm)
{
    gw_tare_progress_t progress = GW_TARE_DONE;
    gw_wheels_t mean_nm = no_torque;
    if (estimator->config.tare_ticks > 0U) {
        progress = gw_tare_add(&estimator->run_tare, torque_nm, estimator->config.tare_ticks,
                               estimator->config.tare_variation_nm, &mean_nm);
    }
    if (progress == GW_TARE_DONE) {
        if (estimator->config.tare_ticks > 0U) { /* otherwise it is zero */
            take_zero(estimator, &mean_nm, &estimator->run_zero_nm);
        }
        estimator->rest_zero_nm = estimator->run_zero_nm;
        estimator->rest = true;
        estimator->slow_ticks = estimator->config.rest_ticks;
        restart_filters(estimator);
    }
    return progress;
}

gw_real_t gw_estimator_encoder_angle(const gw_estimator_t *estimator, int32_t count)
{
    const int32_t within_turn = count % (int32_t)estimator->config.encoder_counts;
    return gw_wrap_angle((gw_real_t)within_turn * estimator->rate_constants.rad_per_count);
}

static bool input_is_valid(const gw_estimator_input_t *input)
{
    return gw_within(input->planned_twist.vx_mps, PLANNED_SPEED_MAX) &&
           gw_within(input->planned_twist.vy_mps, PLANNED_SPEED_MAX) &&
           gw_within(input->planned_twist.omega_radps, PLANNED_SPEED_MAX) &&
           gw_within(input->planned_acceleration.ax_mps2, PLANNED_ACCELERATION_MAX) &&
           gw_within(input->planned_acceleration.ay_mps2, PLANNED_ACCELERATION_MAX) &&
           gw_within(input->planned_acceleration.alpha_radps2, PLANNED_ACCELERATION_MAX) &&
           gw_torques_are_valid(&input->torque_nm);
}

/* The same twist for a valid input. It gives the provers the bounds of all that follows. */
static gw_twist_t known_twist(gw_twist_t twist)
{
    const gw_twist_t known = {gw_known_within(twist.vx_mps, PLANNED_SPEED_MAX),
                              gw_known_within(twist.vy_mps, PLANNED_SPEED_MAX),
                              gw_known_within(twist.omega_radps, PLANNED_SPEED_MAX)};
    return known;
}

/* The faster of the base and of the wheels' circle. */
static gw_real_t faster_of(const gw_estimator_t *estimator, gw_twist_t twist)
{
    const gw_vector_t velocity = {twist.vx_mps, twist.vy_mps};
    const gw_real_t rim = gw_magnitude(twist.omega_radps) * estimator->kinematics.wheel_distance_m;
    return gw_max(gw_length(velocity), rim);
}

/* Decides whether the robot is at rest, and takes the tare after a stop. Returns true if the decision changed. */
static bool judge_rest(gw_estimator_t *estimator, const gw_wheels_t *torque_nm, gw_real_t speed_mps)
{
    const bool was_at_rest = estimator->rest;
    if (speed_mps > estimator->config.rest_speed_mps) {
        estimator->slow_ticks = 0U;
        estimator->rest = false;
        gw_tare_start(&estimator->stop_tare);
    } else {
        if (estimator->slow_ticks < GW_TICK_MASK) {
            estimator->slow_ticks++;
        }
        /* The tare is taken in the last retare_ticks of the wait, or for as long as it takes to become quiet. */
        if ((!estimator->rest) &&
            ((estimator->slow_ticks + estimator->config.retare_ticks) > estimator->config.rest_ticks)) {
            gw_wheels_t mean_nm = no_torque;
            const gw_tare_progress_t progress =
                gw_tare_add(&estimator->stop_tare, torque_nm, estimator->config.retare_ticks,
                            estimator->config.tare_variation_nm, &mean_nm);
            if (progress == GW_TARE_DONE) {
                take_zero(estimator, &mean_nm, &estimator->rest_zero_nm);
                estimator->rest = true;
            }
        }
    }
    return estimator->rest != was_at_rest;
}

/* The acceleration that the model is given. At rest no acceleration is planned: the tare says all. */
static gw_acceleration_t chosen_acceleration(const gw_estimator_t *estimator, const gw_estimator_input_t *input,
                                             uint32_t source, gw_acceleration_t planned, const gw_wheels_t *rates,
                                             const gw_wheels_t *derivatives)
{
    gw_acceleration_t acceleration = {GW_ZERO, GW_ZERO, GW_ZERO};
    if (source == GW_SOURCE_MEASURED) {
        acceleration = gw_kinematics_acceleration(&estimator->kinematics, rates, derivatives);
    } else if (take_felt(input, source, &acceleration)) {
        /* as the IMU shows it */
    } else if ((source == GW_SOURCE_PLANNED) && (!estimator->rest)) {
        acceleration = planned;
    } else {
        /* none */
    }
    return acceleration;
}

/* T|0 from the present zero and the model. */
static gw_wheels_t nominal_with_zero(gw_estimator_t *estimator, const gw_estimator_input_t *input,
                                     const gw_wheels_t *torque_nm, gw_twist_t planned_twist, gw_twist_t measured_twist,
                                     gw_acceleration_t acceleration, gw_estimator_output_t *output)
{
    const gw_wheels_t *const zero = present_zero(estimator);
    gw_twist_t twist = {GW_ZERO, GW_ZERO, GW_ZERO};
    if (estimator->config.velocity_source == GW_SOURCE_MEASURED) {
        twist = measured_twist;
    } else if (!estimator->rest) {
        twist = planned_twist;
    } else {
        /* planned rest */
    }
    gw_wheels_t friction_nm;
    if (estimator->config.friction_model == GW_FRICTION_BRISTLE) {
        friction_nm = gw_presliding_step(&estimator->presliding, &estimator->kinematics, &estimator->rate_constants,
                                         input->encoder_count, torque_nm, measured_twist);
    } else {
        /* cppcheck-suppress misra-c2012-9.3 ; DEV-01 a whole struct from a call */
        const gw_wheels_t roller_rates = gw_kinematics_roller_rates(&estimator->kinematics, twist);
        friction_nm = gw_friction_torques(&estimator->nominal.friction, &roller_rates);
    }
    align_friction(estimator, output->acceleration_source, &friction_nm);
    tell_forces(estimator, &friction_nm, acceleration, output);
    /* cppcheck-suppress misra-c2012-9.3 ; DEV-01 a whole struct from a call */
    gw_wheels_t nominal =
        gw_nominal_torques(&estimator->nominal, &estimator->kinematics, twist, acceleration, &friction_nm);
    GW_UNROLLED
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        nominal.wheel[i] += zero->wheel[i];
    }
    return nominal;
}

/* Adds what gears take, if the torque signals show it. At rest the tare has what they hold. */
static void add_gears(const gw_estimator_t *estimator, const gw_wheels_t *rates, gw_estimator_output_t *output)
{
    output->gear_n2 = GW_ZERO;
    if (gw_gear_is_sensed(&estimator->config.gear)) {
        const gw_real_t per_m = estimator->kinematics.per_wheel_radius;
        const gw_real_t doubt_nm2 = gw_gear_add(&estimator->config.gear, rates, &output->nominal_nm);
        if (!estimator->rest) {
            /* Half of it along each axis, as the wheels point all around. */
            output->gear_n2 = gw_min((GW_HALF * doubt_nm2) * (per_m * per_m), GEAR_MAX_N2);
        }
    }
}

/* Rates of the wheels and their derivatives, after this sample. */
static void filter_rates(gw_estimator_t *estimator, const gw_estimator_input_t *input, const gw_wheels_t *torque_nm,
                         gw_twist_t planned_twist, gw_wheels_t *rates, gw_wheels_t *derivatives)
{
    if (!estimator->rate[0].started) { /* all of them start together */
        /* cppcheck-suppress misra-c2012-9.3 ; DEV-01 a whole struct from a call */
        const gw_wheels_t planned_rates = gw_kinematics_wheel_rates(&estimator->kinematics, planned_twist);
        for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
            /* Without this a robot that already moves would seem to accelerate from rest. */
            gw_rate_filter_presume(&estimator->rate[i], planned_rates.wheel[i]);
        }
    }
    GW_UNROLLED
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        gw_rate_filter_t *const filter = &estimator->rate[i];
        gw_rate_filter_step(filter, &estimator->rate_constants, input->encoder_count[i], torque_nm->wheel[i]);
        rates->wheel[i] = filter->rate_radps;
        derivatives->wheel[i] = filter->derivative_radps2;
    }
}

static gw_regime_t regime_of(const gw_estimator_t *estimator, gw_real_t speed_mps)
{
    gw_regime_t regime = GW_REGIME_MOTION;
    if (estimator->rest) {
        regime = GW_REGIME_REST;
    } else if (speed_mps <= estimator->config.creep_speed_mps) {
        regime = GW_REGIME_CREEPING;
    } else {
        /* in motion */
    }
    return regime;
}

/* The acceleration comes from another source, or that one has another bias. */
static bool has_other_zero(const gw_estimator_t *estimator, const gw_estimator_input_t *input, uint32_t source)
{
    return has_other_source(estimator, source) || has_other_bias(input, source);
}

static void tell_mean(const gw_moving_average_t *average, gw_estimator_output_t *output)
{
    output->mean = gw_moving_average_mean(average);
    output->window_mean = gw_moving_average_window_mean(average);
    output->mean_samples = gw_moving_average_count(average);
}

/* The output of a tick that gives no estimate. */
static void nothing_known(gw_estimator_output_t *output)
{
    static const gw_estimator_output_t nothing = {.regime = GW_REGIME_CREEPING};
    *output = nothing;
}

gw_status_t gw_estimator_step(gw_estimator_t *estimator, const gw_estimator_input_t *input,
                              gw_estimator_output_t *output)
{
    gw_status_t status = GW_STATUS_OK;
    if (!estimator->initialised) {
        status = GW_STATUS_NOT_INITIALISED;
        nothing_known(output);
    } else if (!input_is_valid(input)) {
        status = GW_STATUS_INPUT_INVALID;
        nothing_known(output);
        gw_estimator_restart(estimator);
    } else {
        /* cppcheck-suppress misra-c2012-9.3 ; DEV-01 a whole struct from a call */
        const gw_wheels_t torque_nm = gw_torques_limited(&input->torque_nm);
        const gw_twist_t planned_twist = known_twist(input->planned_twist);
        const gw_acceleration_t planned_acceleration = known_acceleration(input->planned_acceleration);
        const gw_real_t speed_mps = faster_of(estimator, planned_twist);
        /* cppcheck-suppress misra-c2012-9.3 ; DEV-01 a whole struct behind a pointer */
        const gw_wheels_t zero_before = *present_zero(estimator);
        tell_torque(&torque_nm, output);
        output->acceleration_source = source_of(estimator, input);
        output->zero_changed = judge_rest(estimator, &torque_nm, speed_mps);
        tell_turns(estimator, input, output);
        if (has_other_zero(estimator, input, output->acceleration_source)) {
            output->zero_changed = true;
        }
        if (output->zero_changed) {
            tell_zero_step(estimator, &zero_before, output);
            gw_moving_average_reset(&estimator->average);
        }
        output->regime = regime_of(estimator, speed_mps);
        gw_wheels_t rates;
        gw_wheels_t derivatives;
        gw_wheels_t twist_place;
        const gw_wheels_t *const twist_nm = twist_torques(estimator, input, &torque_nm, &twist_place, output);
        filter_rates(estimator, input, twist_nm, planned_twist, &rates, &derivatives);
        const gw_twist_t measured_twist = gw_kinematics_twist(&estimator->kinematics, &rates);
        const gw_acceleration_t acceleration = chosen_acceleration(estimator, input, output->acceleration_source,
                                                                   planned_acceleration, &rates, &derivatives);
        output->measured_twist = measured_twist;
        output->nominal_nm =
            nominal_with_zero(estimator, input, twist_nm, planned_twist, measured_twist, acceleration, output);
        add_gears(estimator, &rates, output);
        gw_wheels_t sensed_nm = torque_nm;
        align_torque(estimator, output->acceleration_source, &sensed_nm);
        output->wrench = gw_wrench_external(&estimator->kinematics, &output->nominal_nm, &sensed_nm);
        output->sigma = estimator->sigma;
        status = gw_moving_average_add(&estimator->average, output->wrench);
        if (status == GW_STATUS_OK) {
            tell_source_step(estimator, input, output);
            tell_mean(&estimator->average, output);
        } else {
            /* Torques or a measured motion that no robot has. */
            nothing_known(output);
            gw_estimator_restart(estimator);
        }
    }
    return status;
}
