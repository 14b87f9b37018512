// Nominal torque (27) and external wrench (40) against the multiplier system (20)-(24), (31), solved by Eigen with the
// corrected sign: A qdd + B + J_c^T lambda = U^T T + J_ext^T F, J_c qdd = -Jdot_c qd.
#include "support.hpp"

namespace
{

struct Case {
    gw_geometry_config_t geometry;
    gw_inertia_config_t inertia;
    gw_friction_config_t friction;
    double theta;
    Eigen::Vector3d twist; // world
    Eigen::Vector3d torque;
    Eigen::Vector3d push;         // world, about the centre
    Eigen::Vector3d acceleration; // world: the solution
};

Case random_case(Random &random, int trial)
{
    Case c{};
    c.geometry = random_geometry(random, trial);
    c.inertia = {real(random.uniform(5.0, 100.0)), real(random.uniform(0.1, 10.0)), real(random.uniform(0.0, 0.02)),
                 real(random.uniform(0.0, 1e-4))};
    c.friction = {real(random.uniform(0.0, 0.5)), real(random.uniform(0.0, 2.0))};
    c.theta = random.uniform(-3.0, 3.0);
    c.twist = random_vector(random, 1.0);
    c.twist(2) *= 4.0;
    c.torque = random_vector(random, 20.0);
    c.push = random_vector(random, 100.0);

    const Eigen::Matrix3d wheel = wheel_jacobian(c.geometry, c.theta);
    const Eigen::Matrix3d roller = roller_jacobian(c.geometry, c.theta);
    Eigen::Matrix<double, 6, 9> constraint = Eigen::Matrix<double, 6, 9>::Zero();
    constraint.block<3, 3>(0, 0) = wheel;
    constraint.block<3, 3>(3, 0) = roller;
    constraint.block<6, 6>(0, 3) = -Eigen::Matrix<double, 6, 6>::Identity();
    Eigen::Matrix<double, 6, 1> drift;
    drift.head<3>() = wheel_jacobian_slope(c.geometry, c.theta) * c.twist(2) * c.twist;
    drift.tail<3>() = roller_jacobian_slope(c.geometry, c.theta) * c.twist(2) * c.twist;

    Eigen::Matrix<double, 15, 15> system = Eigen::Matrix<double, 15, 15>::Zero();
    Eigen::Matrix<double, 15, 1> right = Eigen::Matrix<double, 15, 1>::Zero();
    const double mass = c.inertia.mass_kg;
    system.diagonal().head<3>() << mass, mass, c.inertia.yaw_inertia_kgm2;
    system.diagonal().segment<3>(3).setConstant(c.inertia.wheel_inertia_kgm2);
    system.diagonal().segment<3>(6).setConstant(c.inertia.roller_inertia_kgm2);
    system.block<9, 6>(0, 9) = constraint.transpose();
    system.block<6, 9>(9, 0) = constraint;
    right.head<3>() = c.push;
    right.segment<3>(3) = c.torque;
    const Eigen::Vector3d roller_rates = roller * c.twist;
    right.segment<3>(6) =
        -c.friction.coulomb_torque_nm * (c.friction.tanh_slope_s_per_rad * roller_rates.array()).tanh().matrix();
    right.tail<6>() = -drift;
    c.acceleration = system.fullPivLu().solve(right).head<3>();
    return c;
}

TEST(Nominal, WrenchOfTheMultiplierSystemIsRecovered)
{
    Random random(21);
    for (int trial = 0; trial < 5000; ++trial) {
        const Case c = random_case(random, trial);
        gw_kinematics_t kinematics;
        gw_nominal_t nominal;
        ASSERT_EQ(gw_kinematics_init(&kinematics, &c.geometry), GW_STATUS_OK);
        ASSERT_EQ(gw_nominal_init(&nominal, &c.inertia, &c.friction, &kinematics), GW_STATUS_OK);
        ASSERT_TRUE(gw_nominal_invariant_holds(&nominal));
        const Eigen::Matrix3d turn = to_base(c.theta);
        const gw_wheels_t expected =
            nominal_torques(&nominal, &kinematics, twist(turn * c.twist), acceleration(turn * c.acceleration));
        const gw_wheels_t sensed = wheels(c.torque);
        const gw_wrench_t found = gw_wrench_external(&kinematics, &expected, &sensed);
        // Sizes of the terms that nearly cancel: traction, inertia and friction forces.
        const double traction = 20.0 / c.geometry.wheel_radius_m;
        const double inertia = c.inertia.mass_kg * c.acceleration.head<2>().norm();
        const double yaw = c.inertia.yaw_inertia_kgm2 * std::fabs(c.acceleration(2)) / c.geometry.wheel_distance_m;
        const double friction = 3.0 * c.friction.coulomb_torque_nm / c.geometry.roller_radius_m;
        const double size = 300.0 + 3.0 * traction + inertia + yaw + friction;
        EXPECT_VECTOR_NEAR(vector(found), turn * c.push, (is_double ? 1e-12 : 1e-5) * size) << trial;
    }
}

TEST(Nominal, NeglectedInertiasLeaveTheEquation38)
{
    Random random(22);
    for (int trial = 0; trial < 1000; ++trial) {
        Case c = random_case(random, trial);
        c.inertia.wheel_inertia_kgm2 = real(0);
        c.inertia.roller_inertia_kgm2 = real(0);
        gw_kinematics_t kinematics;
        gw_nominal_t nominal;
        ASSERT_EQ(gw_kinematics_init(&kinematics, &c.geometry), GW_STATUS_OK);
        ASSERT_EQ(gw_nominal_init(&nominal, &c.inertia, &c.friction, &kinematics), GW_STATUS_OK);
        const Eigen::Vector3d a = random_vector(random, 5.0);
        const Eigen::Matrix3d roller = roller_jacobian(c.geometry, 0.0);
        const Eigen::Vector3d friction =
            c.friction.coulomb_torque_nm * (c.friction.tanh_slope_s_per_rad * (roller * c.twist).array()).tanh();
        const Eigen::Vector3d mass(c.inertia.mass_kg, c.inertia.mass_kg, c.inertia.yaw_inertia_kgm2);
        const Eigen::Vector3d forces = mass.cwiseProduct(a) + roller.transpose() * friction;
        const Eigen::Vector3d expected = wheel_jacobian(c.geometry, 0.0).transpose().inverse() * forces;
        EXPECT_VECTOR_NEAR(vector(nominal_torques(&nominal, &kinematics, twist(c.twist), acceleration(a))), expected,
                           tolerance * (forces.cwiseAbs().maxCoeff() + 100.0));
    }
}

TEST(Nominal, NoisePropagation)
{
    Random random(23);
    gw_controller_config_t config;
    gw_controller_config_paper(&config);
    gw_kinematics_t k;
    ASSERT_EQ(gw_kinematics_init(&k, &config.geometry), GW_STATUS_OK);
    const gw_wrench_sigma_t sigma = gw_wrench_noise(&k, real(0.03));
    EXPECT_NEAR(sigma.force_n, 0.3616, 1e-4); // 12.05 x 0.03
    Eigen::Vector3d squares = Eigen::Vector3d::Zero();
    constexpr int samples = 200'000;
    const gw_wheels_t none{};
    for (int i = 0; i < samples; ++i) {
        const gw_wheels_t noise = wheels({random.normal(0.03), random.normal(0.03), random.normal(0.03)});
        squares += vector(gw_wrench_external(&k, &none, &noise)).cwiseAbs2();
    }
    const Eigen::Vector3d seen = (squares / samples).cwiseSqrt();
    // A standard deviation from 200 000 samples is good to 0.16 %; 1 % is six of these.
    EXPECT_NEAR(seen(0) / sigma.force_n, 1.0, 0.01);
    EXPECT_NEAR(seen(1) / sigma.force_n, 1.0, 0.01);
    EXPECT_NEAR(seen(2) / sigma.torque_nm, 1.0, 0.01);
}

TEST(Nominal, ValidWrenches)
{
    EXPECT_TRUE(gw_wrench_is_valid({real(1e9), real(-1e9), real(0)}));
    EXPECT_FALSE(gw_wrench_is_valid({real(1.1e9), real(0), real(0)}));
    EXPECT_FALSE(gw_wrench_is_valid({real(0), not_a_number, real(0)}));
    EXPECT_FALSE(gw_wrench_is_valid({real(0), real(0), -infinite}));
}

TEST(Nominal, RefusesNullAndBadNumbers)
{
    gw_controller_config_t config;
    gw_controller_config_paper(&config);
    gw_kinematics_t k;
    ASSERT_EQ(gw_kinematics_init(&k, &config.geometry), GW_STATUS_OK);
    gw_nominal_t nominal{};
    EXPECT_EQ(gw_nominal_init(nullptr, &config.base, &config.friction, &k), GW_STATUS_NULL_POINTER);
    EXPECT_EQ(gw_nominal_init(&nominal, nullptr, &config.friction, &k), GW_STATUS_NULL_POINTER);
    EXPECT_EQ(gw_nominal_init(&nominal, &config.base, nullptr, &k), GW_STATUS_NULL_POINTER);
    EXPECT_EQ(gw_nominal_init(&nominal, &config.base, &config.friction, nullptr), GW_STATUS_NULL_POINTER);
    config.base.mass_kg = not_a_number;
    EXPECT_EQ(gw_nominal_init(&nominal, &config.base, &config.friction, &k), GW_STATUS_CONFIG_INVALID);
    EXPECT_FALSE(gw_nominal_invariant_holds(nullptr));
}

} // namespace
