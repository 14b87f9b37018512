#include "giveway/gw_controller.h"

#include "giveway/gw_math.h"
#include "giveway/gw_trikey.h"

void gw_controller_config_paper(gw_controller_config_t *config)
{
    config->period_s = (gw_real_t)0.001;
    gw_geometry_config_trikey(&config->geometry);
    gw_inertia_config_trikey(&config->base);
    gw_friction_config_trikey(&config->friction);
    gw_sensor_check_config_trikey(&config->sensor_check);
    gw_estimator_config_trikey(&config->estimator);
    gw_contact_config_trikey(&config->contact);
    gw_detector_config_trikey(&config->detector);
#if (GW_WITH_CHANNELS == 1)
    gw_channels_config_trikey(&config->channels);
#endif
    gw_admittance_config_trikey(&config->admittance);
    gw_reference_config_trikey(&config->reference);
    gw_supervisor_config_trikey(&config->supervisor);
#if (GW_WITH_CHANNELS == 1)
    gw_imu_config_trikey(&config->imu);
#endif
    config->drives_enabled = true;
}

#if (GW_WITH_CHANNELS == 1)
static void choose_channels(gw_controller_config_t *config)
{
    config->estimator.velocity_source = GW_SOURCE_MEASURED;
    config->estimator.acceleration_source = GW_SOURCE_MEASURED;
    config->estimator.friction_model = GW_FRICTION_BRISTLE;
    config->estimator.aligned = 1U;
    config->estimator.creep_speed_mps = (gw_real_t)0.04;
    gw_motor_config_trikey(&config->estimator.motor);
    config->detector.kind = GW_DETECTOR_CHANNELS;
    config->channels.lever_m = (gw_real_t)0.02;
    config->channels.rocking = (gw_real_t)0.3;
}
#else
static void choose_channels(const gw_controller_config_t *config)
{
    (void)config;
}
#endif

#if (GW_WITH_ESCAPE == 1)
static void choose_escape(gw_controller_config_t *config)
{
    config->admittance.kind = GW_ADMITTANCE_ESCAPE;
    config->admittance.tip.height_m = GW_TRIKEY_BASE_COM_HEIGHT_M;
    config->admittance.tip.share = (gw_real_t)0.25;
    config->admittance.smoothing_s = (gw_real_t)0.025;
    config->admittance.lead_s = (gw_real_t)0.04;
    config->admittance.brake_limit_mps2 = (gw_real_t)4.5;
    config->admittance.push_share = GW_TWO;
    config->admittance.ahead_mps = (gw_real_t)0.04;
}
#else
static void choose_escape(const gw_controller_config_t *config)
{
    (void)config;
}
#endif

void gw_controller_config_trikey(gw_controller_config_t *config)
{
    gw_controller_config_paper(config);
    choose_channels(config);
    choose_escape(config);
}

gw_status_t gw_controller_config_check(const gw_controller_config_t *config, gw_config_error_t *error)
{
    gw_config_check_begin(error);
    gw_config_check_real(error, GW_FIELD_CONTROLLER_PERIOD, config->period_s);
    gw_geometry_config_check(&config->geometry, error);
    gw_inertia_config_check(&config->base, error);
    gw_friction_config_check(&config->friction, error);
    gw_sensor_check_config_check(&config->sensor_check, error);
    gw_estimator_config_check(&config->estimator, error);
    gw_contact_config_check(&config->contact, error);
    gw_detector_config_check(&config->detector, error);
#if (GW_WITH_CHANNELS == 1)
    gw_channels_config_check(&config->channels, error);
    if (config->estimator.aligned == 0U) {
        /* The channels' noise is predicted for an aligned balance. */
        gw_config_check_relation(error, GW_FIELD_DETECTOR_KIND, 0U, (gw_real_t)config->detector.kind, GW_ZERO,
                                 (gw_real_t)GW_DETECTOR_IMPULSE);
    }
#endif
    gw_admittance_config_check(&config->admittance, error);
    gw_reference_config_check(&config->reference, config->period_s, error);
    gw_supervisor_config_check(&config->supervisor, error);
#if (GW_WITH_CHANNELS == 1)
    gw_imu_config_check(&config->imu, error);
#endif
    return (error->field == GW_FIELD_NONE) ? GW_STATUS_OK : GW_STATUS_CONFIG_INVALID;
}

static void forget_detection(gw_controller_t *controller)
{
    static const gw_wrench_t no_wrench = {0};
    static const gw_contact_estimate_t no_contact = {0};
    controller->detection_wrench = no_wrench;
    controller->detection_contact = no_contact;
    controller->detection_count = 0U;
    controller->detection_tick = -1;
}

static gw_vector_t mean_force(const gw_controller_t *controller)
{
    const gw_vector_t force = {controller->detection.mean_wrench.force_x_n,
                               controller->detection.mean_wrench.force_y_n};
    return force;
}

static bool looks_for_hits(gw_mode_t mode)
{
    return (mode == GW_MODE_TRACKING) || (mode == GW_MODE_REACTING) || (mode == GW_MODE_SETTLED) ||
           (mode == GW_MODE_REJOINING);
}

#if (GW_WITH_CHANNELS == 1)
static bool uses_channels(const gw_controller_t *controller)
{
    return controller->detector.config.kind == GW_DETECTOR_CHANNELS;
}

/* What the sensors add to the balance of forces. */
static gw_channels_noise_t sensor_noise(const gw_controller_config_t *config, const gw_estimator_t *estimator,
                                        const gw_imu_t *imu)
{
    gw_channels_noise_t noise;
    const gw_real_t twist_rad = config->estimator.torque_noise_nm * estimator->rate_constants.compliance_rad_per_nm;
    noise.period_s = config->period_s;
    noise.cutoff_radps = config->estimator.rate_cutoff_radps;
    noise.encoder_step_m = estimator->rate_constants.rad_per_count * config->geometry.wheel_radius_m;
    noise.observed_step_m =
        gw_motor_is_known(&estimator->motor) ? (noise.encoder_step_m / GW_MOTOR_FINER) : noise.encoder_step_m;
    noise.twist_noise_m = twist_rad * config->geometry.wheel_radius_m;
    noise.force_noise_n = estimator->sigma.force_n;
    noise.sliding_n = config->friction.coulomb_torque_nm * estimator->kinematics.per_roller_radius;
    noise.mass_kg = estimator->nominal.total_mass_kg;
    noise.yaw_inertia_kgm2 = estimator->nominal.total_yaw_inertia_kgm2;
    noise.wheel_distance_m = config->geometry.wheel_distance_m;
    noise.imu = gw_imu_noise(imu);
    return noise;
}

#if (GW_WITH_ESCAPE == 1)
static bool may_lean(const gw_controller_config_t *config)
{
    return config->admittance.tip.height_m > GW_ZERO;
}
#else
static bool may_lean(const gw_controller_config_t *config)
{
    (void)config;
    return false;
}
#endif

static void init_channels(gw_controller_t *controller, const gw_controller_config_t *config)
{
    static const gw_imu_output_t nothing_felt = {0};
    static const gw_contact_estimate_t nowhere = {0};
    (void)gw_imu_init(&controller->imu, &config->imu, config->period_s);
    gw_estimator_set_imu_cutoff(&controller->estimator, config->imu.cutoff_radps);
    controller->felt = nothing_felt;
    controller->contact_now = nowhere;
    const gw_channels_noise_t noise = sensor_noise(config, &controller->estimator, &controller->imu);
    gw_channels_init(&controller->channels, &config->channels, &noise);
    if (!may_lean(config)) {
        gw_channels_stand_firm(&controller->channels);
    }
}

/* What the channels knew before this mode, in which they did not look for hits. */
static void restart_channels(gw_controller_t *controller, gw_mode_t before)
{
    if (before == GW_MODE_FAULT) {
        gw_channels_resume(&controller->channels);
    } else {
        gw_channels_restart(&controller->channels);
    }
}

/* The force below which a push is not felt. While a contact lasts it is that of motion: what started the reaction is
 * real, and must be able to bring the robot out of creeping. */
static gw_real_t channels_leak(const gw_controller_t *controller)
{
    const gw_regime_t regime = controller->estimate.regime;
    const bool pushed = controller->channels.active && (regime == GW_REGIME_CREEPING);
    return gw_force_floor(controller->channels.config.slow, pushed ? GW_REGIME_MOTION : regime);
}

static bool channels_hold(const gw_controller_t *controller)
{
    return gw_channels_invariant_holds(&controller->channels) && gw_imu_invariant_holds(&controller->imu);
}

static void forget_contact(gw_controller_t *controller)
{
    static const gw_channels_output_t nothing_found = {0};
    controller->contact_found = nothing_found;
}

/* Something touches the robot. */
static bool is_felt(const gw_controller_t *controller)
{
    return controller->contact_found.active;
}

static uint32_t deciding_channel(const gw_controller_t *controller)
{
    return controller->contact_found.channel;
}

/* The mean wrench of the contact has become better in this tick. */
static bool is_refined(const gw_controller_t *controller)
{
    return controller->contact_found.refined;
}

/* The acceleration that the IMU shows; its bias is taken where the robot stands, as the last tick saw it. */
static void feel_imu(gw_controller_t *controller, const gw_controller_input_t *input)
{
    if (controller->estimator.config.acceleration_source == GW_SOURCE_IMU) {
        /* Without it, or with a bad one, the encoders take its place: its status changes nothing else. */
        (void)gw_imu_step(&controller->imu, &input->imu, controller->estimate.regime == GW_REGIME_REST,
                          &controller->felt);
    }
}

static void tell_what_is_felt(const gw_controller_t *controller, gw_estimator_input_t *input)
{
    input->imu = controller->felt;
}

static bool is_imu_trusted(const gw_controller_t *controller)
{
    return controller->felt.trusted;
}

/* What to give way to, base frame. */
static gw_vector_t felt_push(const gw_controller_t *controller)
{
    return uses_channels(controller) ? controller->contact_found.push_n : mean_force(controller);
}

/* The two channels; their answer in the form of a detector's. */
static void detect_by_channels(gw_controller_t *controller)
{
    gw_channels_input_t input;
    input.wrench = &controller->estimate.wrench;
    input.zero_step = &controller->estimate.zero_step;
    input.forces = &controller->estimate.forces;
    input.zero_changed = controller->estimate.zero_changed;
    input.regime = controller->estimate.regime;
    input.turned = controller->estimate.turned;
    input.counted = controller->estimate.counted;
    input.enabled = true; /* otherwise they are not asked */
    input.felt = controller->estimate.acceleration_source == GW_SOURCE_IMU;
    input.shaking_mps2_2 = controller->felt.shaking_mps2_2;
    input.gear_n2 = controller->estimate.gear_n2;
    input.twist = &controller->estimate.measured_twist;
    input.torque_nm = &controller->estimate.torque_nm;
    input.reacting = controller->supervisor.mode == GW_MODE_REACTING;
    gw_channels_step(&controller->channels, &controller->estimator.kinematics, &input, &controller->contact_found);
    controller->detection.tripped = controller->contact_found.tripped;
    controller->detection.active = controller->contact_found.active;
    controller->detection.statistic = controller->contact_found.statistic;
    controller->detection.mean_wrench = controller->contact_found.mean_wrench;
    controller->detection.samples = 1U;
}

/* Where the motors are depends on what is sent to them. */
static void tell_command(gw_controller_t *controller, const gw_controller_output_t *output)
{
    gw_estimator_tell_command(&controller->estimator, &output->command, output->enable);
}
#else
static bool uses_channels(const gw_controller_t *controller)
{
    (void)controller;
    return false;
}

static void init_channels(const gw_controller_t *controller, const gw_controller_config_t *config)
{
    (void)controller;
    (void)config;
}

static void restart_channels(const gw_controller_t *controller, gw_mode_t before)
{
    (void)controller;
    (void)before;
}

static gw_real_t channels_leak(const gw_controller_t *controller)
{
    (void)controller;
    return GW_ZERO;
}

static bool channels_hold(const gw_controller_t *controller)
{
    (void)controller;
    return true;
}

static void forget_contact(const gw_controller_t *controller)
{
    (void)controller;
}

static bool is_felt(const gw_controller_t *controller)
{
    (void)controller;
    return false;
}

static uint32_t deciding_channel(const gw_controller_t *controller)
{
    (void)controller;
    return GW_CHANNEL_NONE;
}

static bool is_refined(const gw_controller_t *controller)
{
    (void)controller;
    return false;
}

static void feel_imu(const gw_controller_t *controller, const gw_controller_input_t *input)
{
    (void)controller;
    (void)input;
}

static void tell_what_is_felt(const gw_controller_t *controller, const gw_estimator_input_t *input)
{
    (void)controller;
    (void)input;
}

static bool is_imu_trusted(const gw_controller_t *controller)
{
    (void)controller;
    return false;
}

static gw_vector_t felt_push(const gw_controller_t *controller)
{
    return mean_force(controller);
}

static void detect_by_channels(const gw_controller_t *controller)
{
    (void)controller;
}

static void tell_command(const gw_controller_t *controller, const gw_controller_output_t *output)
{
    (void)controller;
    (void)output;
}
#endif

#if (GW_WITH_ESCAPE == 1)
static void set_up_escape(gw_controller_t *controller, const gw_controller_config_t *config)
{
    gw_tip_t tip;
    gw_tip_init(&tip, &config->admittance.tip, &controller->estimator.kinematics);
    gw_admittance_set_tip(&controller->admittance, &tip);
    gw_reference_set_tip(&controller->reference, &tip);
    controller->begins = false;
    controller->waits = false;
    controller->may_press = false;
    controller->may_be_pushed = false;
}

#if (GW_WITH_CHANNELS == 1)
/* The force of this tick, base frame; the paper's detectors do not tell it from what was before. */
static gw_vector_t felt_force(const gw_controller_t *controller)
{
    return controller->contact_found.force_n;
}
#else
static gw_vector_t felt_force(const gw_controller_t *controller)
{
    static const gw_vector_t nothing_felt = {0};
    (void)controller;
    return nothing_felt;
}
#endif

#if (GW_WITH_CHANNELS == 1)
/* Is it too early to tell whether a hit pushes the robot or throws its wheels back? An IMU tells at once. */
static bool is_unsure(const gw_controller_t *controller)
{
    return uses_channels(controller) && gw_channels_are_unsure(&controller->channels);
}
#else
static bool is_unsure(const gw_controller_t *controller)
{
    (void)controller;
    return false;
}
#endif

/* The escape begins: does the robot move towards what it hit, or may the push accelerate it? Neither within a reaction:
 * there the robot rocks, and what it feels of that would make it rock more. Until the direction is sure it brakes. */
static void begin_escape(gw_controller_t *controller, gw_vector_t velocity, gw_vector_t direction)
{
    static const gw_vector_t nowhere = {0};
    const gw_real_t towards_mps = -gw_along(velocity, direction);
    const bool goes = controller->begins && (!controller->waits);
    const bool presses = (towards_mps > controller->supervisor.config.settled_speed_mps);
    controller->may_press = goes && presses;
    controller->may_be_pushed = goes && (!presses);
    controller->turns = !controller->waits;
    (void)gw_admittance_start(&controller->admittance, velocity, controller->waits ? nowhere : direction);
}

/* Something hits the robot. */
GW_APART static void begin_reaction(gw_controller_t *controller, gw_mode_t before, gw_vector_t velocity,
                                    gw_vector_t direction)
{
    controller->begins = (before != GW_MODE_REACTING);
    controller->waits = is_unsure(controller);
    begin_escape(controller, velocity, direction);
}

/* Asked once in every tick. An interrupted reaction does not wait any more: it only comes to rest. */
static bool stops_waiting(gw_controller_t *controller)
{
    const bool waited = controller->waits && (controller->supervisor.mode == GW_MODE_REACTING);
    controller->waits = waited && is_unsure(controller);
    return waited && (!controller->waits);
}

/* A push that is felt accelerates the escape; then that waits for the robot. */
static void yield(gw_controller_t *controller)
{
    static const gw_vector_t nothing_felt = {0};
    const gw_twist_t *const robot = &controller->estimate.measured_twist;
    const gw_vector_t robot_mps = {robot->vx_mps, robot->vy_mps};
    gw_admittance_yield(&controller->admittance, controller->detection.active ? felt_force(controller) : nothing_felt,
                        channels_leak(controller), controller->estimator.nominal.total_mass_kg, robot_mps);
}

/* Before a step of the admittance. */
GW_APART static void prepare_escape(gw_controller_t *controller)
{
    gw_admittance_face(&controller->admittance, controller->reference.yaw);
    if (controller->supervisor.mode == GW_MODE_REACTING) {
        if (controller->may_be_pushed) {
            yield(controller);
        } else if (controller->may_press && controller->detection.active) {
            gw_admittance_brake(&controller->admittance);
        } else {
            /* a reaction within a reaction */
        }
    }
}

/* The reference's twist; in a reaction ahead of it, as the servo needs an error of the speed to accelerate the robot.
 */
static gw_twist_t commanded_twist(const gw_controller_t *controller)
{
    gw_twist_t twist = controller->reference.twist;
    const gw_admittance_config_t *const config = &controller->admittance.config;
    if ((controller->supervisor.mode == GW_MODE_REACTING) && (config->lead_s > GW_ZERO)) {
        const gw_acceleration_t *const acceleration = &controller->reference.acceleration;
        twist.vx_mps += gw_limited(config->lead_s * acceleration->ax_mps2, config->speed_limit_mps);
        twist.vy_mps += gw_limited(config->lead_s * acceleration->ay_mps2, config->speed_limit_mps);
    }
    return twist;
}
#else
static void set_up_escape(const gw_controller_t *controller, const gw_controller_config_t *config)
{
    (void)controller;
    (void)config;
}

static void begin_reaction(gw_controller_t *controller, gw_mode_t before, gw_vector_t velocity, gw_vector_t direction)
{
    (void)before;
    controller->turns = true;
    (void)gw_admittance_start(&controller->admittance, velocity, direction);
}

static void begin_escape(const gw_controller_t *controller, gw_vector_t velocity, gw_vector_t direction)
{
    (void)controller;
    (void)velocity;
    (void)direction;
}

static bool stops_waiting(const gw_controller_t *controller)
{
    (void)controller;
    return false;
}

static void prepare_escape(const gw_controller_t *controller)
{
    (void)controller;
}

static gw_twist_t commanded_twist(const gw_controller_t *controller)
{
    return controller->reference.twist;
}
#endif

static void find_nothing(gw_controller_t *controller)
{
    static const gw_detector_output_t no_detection = {0};
    controller->detection = no_detection;
    forget_contact(controller);
}

/* A tick without an estimate: no push is known, and the model is not reliable. */
GW_SMALL static void blank_tick(gw_controller_t *controller)
{
    static const gw_estimator_output_t no_estimate = {.regime = GW_REGIME_CREEPING};
    controller->estimate = no_estimate;
    find_nothing(controller);
}

gw_status_t gw_controller_init(gw_controller_t *controller, const gw_controller_config_t *config,
                               gw_config_error_t *error)
{
    gw_status_t status = GW_STATUS_OK;
    gw_config_error_t found;
    gw_config_check_begin(&found);
    if ((controller == NULL) || (config == NULL)) {
        status = GW_STATUS_NULL_POINTER;
    } else {
        status = gw_controller_config_check(config, &found);
    }
    if (controller != NULL) {
        controller->initialised = (status == GW_STATUS_OK);
        if (controller->initialised) {
            controller->drives_enabled = config->drives_enabled;
            /* The configuration was checked as a whole, so none of these can refuse it. */
            (void)gw_sensor_check_init(&controller->sensor_check, &config->sensor_check);
            (void)gw_estimator_init(&controller->estimator, &config->estimator, &config->geometry, &config->base,
                                    &config->friction, config->period_s);
            (void)gw_contact_init(&controller->contact, &config->contact);
            (void)gw_detector_init(&controller->detector, &config->detector, config->period_s);
            init_channels(controller, config);
            (void)gw_admittance_init(&controller->admittance, &config->admittance, config->period_s);
            (void)gw_reference_init(&controller->reference, &config->reference, config->period_s);
            (void)gw_supervisor_init(&controller->supervisor, &config->supervisor);
            set_up_escape(controller, config);
            gw_joint_init(&controller->joint);
            forget_detection(controller);
            blank_tick(controller);
            controller->tick = 0U;
            controller->tare_request_before = false;
            controller->on_plan = false;
            controller->turns = false;
        }
    }
    if (error != NULL) {
        *error = found;
    }
    return status;
}

void gw_controller_safe_output(gw_controller_output_t *output)
{
    static const gw_controller_output_t safe = {.detection_tick = -1, .mode = GW_MODE_FAULT};
    *output = safe;
}

/* Is the reference about to stand still? As it was at the end of the last tick. */
static bool is_slow(const gw_controller_t *controller)
{
    const gw_vector_t velocity = {controller->reference.twist.vx_mps, controller->reference.twist.vy_mps};
    const gw_real_t rim =
        gw_magnitude(controller->reference.twist.omega_radps) * controller->estimator.kinematics.wheel_distance_m;
    return gw_max(gw_length(velocity), rim) < controller->supervisor.config.settled_speed_mps;
}

/* Standard deviation of a mean of so many samples. */
static gw_wrench_sigma_t sigma_of_mean(gw_wrench_sigma_t sigma, uint32_t samples)
{
    gw_wrench_sigma_t result = sigma;
    if (samples > 1U) {
        const gw_real_t root = gw_sqrt_of_square((gw_real_t)samples);
        result.force_n = sigma.force_n / root;
        result.torque_nm = sigma.torque_nm / root;
    }
    return result;
}

/* The external wrench of this tick. */
static gw_status_t estimate(gw_controller_t *controller, const gw_controller_input_t *input)
{
    gw_estimator_input_t estimator_input;
    const gw_rotation_t yaw = controller->reference.yaw;
    const gw_twist_t twist = controller->reference.twist;
    const gw_acceleration_t acceleration = controller->reference.acceleration;
    const gw_vector_t world_velocity = {twist.vx_mps, twist.vy_mps};
    const gw_vector_t world_acceleration = {acceleration.ax_mps2, acceleration.ay_mps2};
    const gw_vector_t velocity = gw_rotate_back(yaw, world_velocity);
    const gw_vector_t change = gw_rotate_back(yaw, world_acceleration);
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        estimator_input.torque_nm.wheel[i] = input->sensor.torque_nm[i];
        estimator_input.encoder_count[i] = input->sensor.encoder_count[i];
    }
    estimator_input.planned_twist.vx_mps = velocity.x;
    estimator_input.planned_twist.vy_mps = velocity.y;
    estimator_input.planned_twist.omega_radps = twist.omega_radps;
    estimator_input.planned_acceleration.ax_mps2 = change.x;
    estimator_input.planned_acceleration.ay_mps2 = change.y;
    estimator_input.planned_acceleration.alpha_radps2 = acceleration.alpha_radps2;
    tell_what_is_felt(controller, &estimator_input);
    return gw_estimator_step(&controller->estimator, &estimator_input, &controller->estimate);
}

/* The paper's detectors. */
static void detect_by_threshold(gw_controller_t *controller, bool slow)
{
    gw_detector_input_t detector_input;
    if (controller->estimate.zero_changed) {
        gw_detector_clear(&controller->detector);
    }
    detector_input.wrench = controller->estimate.wrench;
    detector_input.window_mean = controller->estimate.window_mean;
    detector_input.mean = controller->estimate.mean;
    detector_input.mean_samples = controller->estimate.mean_samples;
    detector_input.regime = controller->estimate.regime;
    detector_input.enabled = looks_for_hits(controller->supervisor.mode);
    detector_input.reaction_over = slow;
    /* The estimate is valid, so the detector cannot refuse it. */
    (void)gw_detector_step(&controller->detector, &detector_input, &controller->detection);
}

/* Is the robot being hit? */
static void detect(gw_controller_t *controller, bool slow)
{
    if (!uses_channels(controller)) {
        detect_by_threshold(controller, slow);
    } else if (looks_for_hits(controller->supervisor.mode)) {
        detect_by_channels(controller);
    } else {
        find_nothing(controller); /* they begin anew afterwards */
    }
    if (controller->detection.tripped) {
        controller->detection_count = (controller->detection_count + 1U) & GW_TICK_MASK;
        controller->detection_tick = (int32_t)controller->tick;
    }
    if (controller->detection.tripped || is_refined(controller)) {
        controller->detection_wrench = controller->detection.mean_wrench;
        (void)gw_contact_locate(&controller->contact, controller->detection.mean_wrench,
                                sigma_of_mean(controller->estimate.sigma, controller->detection.samples),
                                &controller->detection_contact);
    }
}

/* A new tare of the run was asked for: only a robot that stands may take one. */
GW_SMALL static gw_status_t judge_tare_request(gw_controller_t *controller, bool requested, bool *accepted)
{
    const gw_mode_t mode = controller->supervisor.mode;
    const bool asked = requested && (!controller->tare_request_before);
    controller->tare_request_before = requested;
    *accepted = asked && (controller->estimate.regime == GW_REGIME_REST) &&
                ((mode == GW_MODE_TRACKING) || (mode == GW_MODE_SETTLED));
    return (asked && (!*accepted)) ? GW_STATUS_TARE_REFUSED : GW_STATUS_OK;
}

/* One sample of the tare that runs in GW_MODE_TARING. */
GW_SMALL static gw_status_t continue_tare(gw_controller_t *controller, const gw_sensor_sample_t *sensor, bool *done)
{
    gw_wheels_t torque_nm;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        torque_nm.wheel[i] = sensor->torque_nm[i];
    }
    const gw_tare_progress_t progress = gw_estimator_tare(&controller->estimator, &torque_nm);
    *done = (progress == GW_TARE_DONE);
    return (progress == GW_TARE_REFUSED) ? GW_STATUS_TARE_REFUSED : GW_STATUS_OK;
}

/* The direction of the push in the world frame, as a unit vector; zero if there is none. */
static gw_vector_t push_direction(const gw_controller_t *controller)
{
    const gw_vector_t force = felt_push(controller);
    return gw_rotate(controller->reference.yaw, gw_unit(force.x, force.y, gw_length(force)));
}

/* A push that ends within a reaction is noticed, too: the reaction goes on. */
static bool gives_way_anew(gw_mode_t before, gw_vector_t direction)
{
    return (before != GW_MODE_REACTING) || (gw_length(direction) > GW_HALF);
}

/* What happens once, when a mode begins. */
static void enter_mode(gw_controller_t *controller, gw_mode_t before)
{
    const gw_mode_t mode = controller->supervisor.mode;
    const gw_vector_t velocity = {controller->reference.twist.vx_mps, controller->reference.twist.vy_mps};
    const bool decided = stops_waiting(controller);
    if ((mode == GW_MODE_REACTING) && controller->detection.tripped) {
        const gw_vector_t direction = push_direction(controller);
        if (gives_way_anew(before, direction)) {
            begin_reaction(controller, before, velocity, direction);
        }
    } else if (decided) {
        begin_escape(controller, velocity, push_direction(controller));
    } else if ((mode == GW_MODE_REACTING) && controller->turns && is_refined(controller)) {
        const gw_vector_t direction = push_direction(controller);
        if (gives_way_anew(before, direction)) {
            gw_admittance_redirect(&controller->admittance, direction);
        }
    } else if (mode != before) {
        if (mode == GW_MODE_REACTING) {
            /* After an interruption the space may no longer be free: come to rest, do not go on with the escape. */
            const gw_vector_t nowhere = {GW_ZERO, GW_ZERO};
            controller->turns = false;
            (void)gw_admittance_start(&controller->admittance, velocity, nowhere);
        } else if (mode == GW_MODE_TARING) {
            gw_estimator_start_tare(&controller->estimator);
            gw_detector_reset(&controller->detector);
        } else {
            gw_detector_reset(&controller->detector);
        }
        if (!looks_for_hits(before)) {
            restart_channels(controller, before);
        }
        if (mode == GW_MODE_FAULT) {
            gw_estimator_restart(&controller->estimator);
        }
    } else {
        /* nothing begins */
    }
}

/* Likewise of the paper's detectors. */
static gw_real_t threshold_leak(const gw_controller_t *controller)
{
    const bool just_hit = controller->detector.active &&
                          (controller->detector.ticks_since_trip < controller->detector.config.blanking_ticks);
    gw_regime_t regime = controller->estimate.regime;
    if (just_hit && (regime == GW_REGIME_CREEPING)) {
        regime = GW_REGIME_MOTION;
    }
    return gw_detector_leak(&controller->detector, regime);
}

/* Input of the live admittance, world frame: the mean force above the detector's leak. */
GW_SMALL static gw_vector_t live_force(const gw_controller_t *controller)
{
    const gw_vector_t base = {controller->estimate.mean.force_x_n, controller->estimate.mean.force_y_n};
    const gw_real_t length = gw_length(base);
    const gw_real_t leak_n = uses_channels(controller) ? channels_leak(controller) : threshold_leak(controller);
    const gw_real_t left = length - leak_n;
    gw_vector_t felt = {GW_ZERO, GW_ZERO};
    if ((left > GW_ZERO) && (controller->supervisor.mode == GW_MODE_REACTING)) {
        const gw_real_t share = gw_fraction(left, length);
        felt.x = base.x * share;
        felt.y = base.y * share;
    }
    return gw_rotate(controller->reference.yaw, felt);
}

/* The reaction: the reference moves as the admittance says. */
static void give_way(gw_controller_t *controller)
{
    gw_admittance_output_t motion;
    prepare_escape(controller);
    gw_vector_t force_n = {GW_ZERO, GW_ZERO}; /* a frozen impulse does not read it */
    if (controller->admittance.config.kind == GW_ADMITTANCE_LIVE_FORCE) {
        force_n = live_force(controller);
    }
    const gw_status_t status = gw_admittance_step(&controller->admittance, force_n, &motion);
    if (status == GW_STATUS_OK) {
        gw_reference_escape(&controller->reference, motion.displacement_m, motion.velocity_mps);
    } else {
        gw_reference_brake(&controller->reference);
    }
}

/* Places the reference on the plan at the first call, then follows the plan. The plan is valid; that its values are
 * within their ranges is said again, in a form that the provers understand. */
GW_SMALL static void take_plan(gw_controller_t *controller, const gw_plan_t *plan)
{
    const gw_plan_t valid = gw_plan_limited(plan);
    if (controller->on_plan) {
        gw_reference_follow(&controller->reference, &valid, controller->supervisor.mode == GW_MODE_REJOINING);
    } else {
        /* Without a tare the robot may already be moving along its plan. */
        const bool moving = (controller->estimator.config.tare_ticks == 0U) && controller->drives_enabled;
        gw_reference_place(&controller->reference, &valid, moving);
        controller->on_plan = true;
    }
}

/* Moves the reference by one tick, as the mode says. */
static void move_reference(gw_controller_t *controller, const gw_plan_t *plan, bool plan_valid)
{
    const gw_mode_t mode = controller->supervisor.mode;
    const bool on_the_path = (mode == GW_MODE_TRACKING) || (mode == GW_MODE_REJOINING);
    if (on_the_path && plan_valid && (!controller->on_plan)) {
        take_plan(controller, plan);
    } else if ((mode == GW_MODE_FAULT) || (!controller->drives_enabled)) {
        gw_reference_freeze(&controller->reference);
    } else if ((mode == GW_MODE_REACTING) || (mode == GW_MODE_SETTLED)) {
        give_way(controller);
    } else if (on_the_path && plan_valid) {
        take_plan(controller, plan);
    } else {
        gw_reference_brake(&controller->reference);
    }
}

static void command_wheels(gw_controller_t *controller, const gw_controller_input_t *input, bool sensors_good,
                           gw_controller_output_t *output)
{
    const gw_kinematics_t *const kinematics = &controller->estimator.kinematics;
    if (sensors_good && ((!gw_joint_is_placed(&controller->joint)) || (!controller->drives_enabled))) {
        gw_wheels_t measured;
        for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
            measured.wheel[i] = gw_estimator_encoder_angle(&controller->estimator, input->sensor.encoder_count[i]);
        }
        gw_joint_place(&controller->joint, &measured);
    }
    if (gw_joint_is_placed(&controller->joint) && (controller->supervisor.mode != GW_MODE_FAULT)) {
        gw_joint_step(&controller->joint, kinematics, controller->reference.displacement,
                      gw_reference_pose(&controller->reference).theta_rad, controller->reference.yaw,
                      commanded_twist(controller), &output->command);
    } else {
        gw_joint_hold(&controller->joint, &output->command);
    }
    output->enable = controller->drives_enabled && gw_joint_is_placed(&controller->joint);
    tell_command(controller, output);
}

/* Where the mean wrench of the estimate acts. */
static void locate_mean(const gw_controller_t *controller, gw_contact_estimate_t *contact)
{
    /* The estimate is valid or zero; both are accepted. */
    (void)gw_contact_locate(&controller->contact, controller->estimate.mean,
                            sigma_of_mean(controller->estimate.sigma, controller->estimate.mean_samples), contact);
}

#if (GW_WITH_CHANNELS == 1)
/* With channels: the hit as it was refined last, none if nothing touches. A contact that lasts longer than it is
 * refined is located anew where there is time. */
static void report_contact(gw_controller_t *controller, gw_contact_estimate_t *contact)
{
    static const gw_contact_estimate_t no_contact = {0};
    if (!uses_channels(controller)) {
        locate_mean(controller, contact);
    } else if (!is_felt(controller)) {
        *contact = no_contact;
    } else {
        if (is_refined(controller)) {
            controller->contact_now = controller->detection_contact;
        } else if ((!controller->contact_found.refining) && gw_channels_have_time(&controller->channels)) {
            locate_mean(controller, &controller->contact_now);
        } else {
            /* as it was */
        }
        *contact = controller->contact_now;
    }
}
#else
static void report_contact(const gw_controller_t *controller, gw_contact_estimate_t *contact)
{
    locate_mean(controller, contact);
}
#endif

static void report(gw_controller_t *controller, gw_controller_output_t *output)
{
    output->estimate = controller->estimate.mean;
    report_contact(controller, &output->contact);
    output->detection_active = uses_channels(controller) ? is_felt(controller) : controller->detector.active;
    output->detection_statistic = controller->detection.statistic;
    output->detection_count = controller->detection_count;
    output->detection_tick = controller->detection_tick;
    output->detection_channel = deciding_channel(controller);
    output->imu_trusted = is_imu_trusted(controller);
    output->acceleration_source = controller->estimate.acceleration_source;
    output->detection_wrench = controller->detection_wrench;
    output->detection_contact = controller->detection_contact;
    output->reference_pose = gw_reference_pose(&controller->reference);
    output->reference_twist = controller->reference.twist;
    output->mode = controller->supervisor.mode;
    output->path_ticks = controller->supervisor.path_ticks;
    output->tick = controller->tick;
}

/* Has the reference come back to the plan? Asked for a valid plan only. */
GW_SMALL static bool is_near(const gw_controller_t *controller, const gw_plan_t *plan)
{
    const gw_plan_t valid = gw_plan_limited(plan);
    return (gw_reference_distance(&controller->reference, &valid) < controller->supervisor.config.rejoin_distance_m) &&
           (gw_reference_angle(&controller->reference, &valid) < controller->supervisor.config.rejoin_angle_rad);
}

/* Does nothing push any more? */
GW_SMALL static bool is_quiet(const gw_controller_t *controller)
{
    const gw_vector_t force = {controller->estimate.mean.force_x_n, controller->estimate.mean.force_y_n};
    return uses_channels(controller)
               ? (!is_felt(controller))
               : (gw_length(force) < gw_detector_leak(&controller->detector, controller->estimate.regime));
}

/* Checks the sensors, estimates the push, and decides whether it is a hit. */
static gw_status_t sense(gw_controller_t *controller, const gw_controller_input_t *input, bool slow)
{
    gw_status_t status = gw_sensor_check_step(&controller->sensor_check, &input->sensor);
    feel_imu(controller, input);
    if (status == GW_STATUS_OK) {
        status = estimate(controller, input);
    }
    if (status == GW_STATUS_OK) {
        detect(controller, slow);
    } else {
        blank_tick(controller);
    }
    return status;
}

/* The status that a step returns: bad sensors tell more than a bad plan, and that more than a refused tare. */
GW_SMALL static gw_status_t worst_of(gw_status_t sensor_status, bool plan_valid, gw_status_t tare_status)
{
    gw_status_t status = tare_status;
    if (sensor_status != GW_STATUS_OK) {
        status = sensor_status;
    } else if (!plan_valid) {
        status = GW_STATUS_PLAN_INVALID;
    } else {
        /* a refused tare or nothing */
    }
    return status;
}

/* A step of an initialised controller: what happened, what follows for the mode, what follows for the motion. */
static gw_status_t step(gw_controller_t *controller, const gw_controller_input_t *input, gw_controller_output_t *output)
{
    gw_supervisor_events_t events;
    const gw_mode_t before = controller->supervisor.mode;
    const bool slow = is_slow(controller);
    const gw_status_t sensor_status = sense(controller, input, slow);
    events.sensors_good = (sensor_status == GW_STATUS_OK);
    events.plan_valid = gw_plan_is_valid(&input->plan);
    events.stop_request = input->stop_request;
    events.hit = controller->detection.tripped;
    events.tare_done = false;
    gw_status_t tare_status = judge_tare_request(controller, input->tare_request, &events.tare_accepted);
    if (events.sensors_good && (before == GW_MODE_TARING) && (!input->stop_request)) {
        const gw_status_t progress = continue_tare(controller, &input->sensor, &events.tare_done);
        tare_status = (progress == GW_STATUS_OK) ? tare_status : progress;
    }
    /* Each of these is asked for in one mode only. */
    events.quiet = slow && (before == GW_MODE_REACTING) && is_quiet(controller);
    events.on_path = events.plan_valid && slow && (before == GW_MODE_REJOINING) && is_near(controller, &input->plan);
    (void)gw_supervisor_step(&controller->supervisor, &events);
    enter_mode(controller, before);
    move_reference(controller, &input->plan, events.plan_valid);
    command_wheels(controller, input, events.sensors_good, output);
    report(controller, output);
    controller->tick = (controller->tick + 1U) & GW_TICK_MASK;
    return worst_of(sensor_status, events.plan_valid, tare_status);
}

gw_status_t gw_controller_step(gw_controller_t *controller, const gw_controller_input_t *input,
                               gw_controller_output_t *output)
{
    gw_status_t status = GW_STATUS_OK;
    if (output == NULL) {
        status = GW_STATUS_NULL_POINTER;
    } else {
        if ((controller == NULL) || (input == NULL)) {
            status = GW_STATUS_NULL_POINTER;
            gw_controller_safe_output(output);
        } else if (!controller->initialised) {
            status = GW_STATUS_NOT_INITIALISED;
            gw_controller_safe_output(output);
        } else {
            status = step(controller, input, output);
        }
    }
    return status;
}

bool gw_controller_invariant_holds(const gw_controller_t *controller)
{
    bool holds = (controller != NULL);
    if (holds) {
        holds = controller->initialised;
    }
    if (holds) {
        holds =
            gw_sensor_check_invariant_holds(&controller->sensor_check) &&
            gw_estimator_invariant_holds(&controller->estimator) && gw_contact_invariant_holds(&controller->contact) &&
            gw_detector_invariant_holds(&controller->detector) && channels_hold(controller) &&
            gw_admittance_invariant_holds(&controller->admittance) &&
            gw_reference_invariant_holds(&controller->reference) && gw_joint_invariant_holds(&controller->joint) &&
            gw_supervisor_invariant_holds(&controller->supervisor) && (controller->detection_count <= GW_TICK_MASK) &&
            (controller->detection_tick >= -1) && (controller->tick <= GW_TICK_MASK);
    }
    return holds;
}
