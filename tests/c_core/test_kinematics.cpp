#include <cstring>

#include "support.hpp"

namespace
{

constexpr int trials = 3000;

struct Robot {
    gw_geometry_config_t geometry;
    gw_kinematics_t kinematics;
};

Robot random_robot(Random &random, int trial)
{
    Robot robot{random_geometry(random, trial), {}};
    EXPECT_EQ(gw_kinematics_init(&robot.kinematics, &robot.geometry), GW_STATUS_OK);
    EXPECT_TRUE(gw_kinematics_invariant_holds(&robot.kinematics));
    return robot;
}

// Entries of a matrix are compared relative to its largest one.
void expect_close(const Eigen::MatrixXd &actual, const Eigen::MatrixXd &expected)
{
    ASSERT_LE((actual - expected).cwiseAbs().maxCoeff(), tolerance * expected.cwiseAbs().maxCoeff());
}

TEST(Kinematics, JacobiansAndInverseAreEigens)
{
    Random random(11);
    for (int trial = 0; trial < trials; ++trial) {
        const Robot robot = random_robot(random, trial);
        const double theta = static_cast<double>(real(random.uniform(-6.0, 6.0)));
        const auto yaw = real(theta);
        const Eigen::Matrix3d wheel = wheel_jacobian(robot.geometry, theta);
        const Eigen::Matrix3d roller = roller_jacobian(robot.geometry, theta);
        expect_close(matrix(wheel_jacobian(&robot.kinematics, yaw)), wheel);
        expect_close(matrix(roller_jacobian(&robot.kinematics, yaw)), roller);
        // Rows of the inverse differ in unit: compare row by row.
        const Eigen::Matrix3d inverse = matrix(wheel_jacobian_inverse(&robot.kinematics, yaw));
        const Eigen::Matrix3d truth = wheel.inverse();
        for (int row = 0; row < 3; ++row) {
            expect_close(inverse.row(row), truth.row(row));
        }
        Eigen::Matrix<double, 6, 9> constraint = Eigen::Matrix<double, 6, 9>::Zero(); // (19)
        constraint.block<3, 3>(0, 0) = wheel;
        constraint.block<3, 3>(3, 0) = roller;
        constraint.block<6, 6>(0, 3) = -Eigen::Matrix<double, 6, 6>::Identity();
        const constraint_matrix_t found = constraint_jacobian(&robot.kinematics, yaw);
        Eigen::Matrix<double, 6, 9> actual;
        for (int i = 0; i < 6; ++i) {
            for (int j = 0; j < 9; ++j) {
                actual(i, j) = found.m[i][j];
            }
        }
        expect_close(actual, constraint);
    }
}

TEST(Kinematics, MappingsAreEigensMatrixProducts)
{
    Random random(12);
    for (int trial = 0; trial < trials; ++trial) {
        const Robot robot = random_robot(random, trial);
        const gw_kinematics_t &k = robot.kinematics;
        const Eigen::Matrix3d wheel = wheel_jacobian(robot.geometry, 0.0);
        const Eigen::Matrix3d roller = roller_jacobian(robot.geometry, 0.0);
        const Eigen::Vector3d v = random_vector(random, 2.0);
        const Eigen::Vector3d torque = random_vector(random, 20.0);
        const auto scale = [](const Eigen::Matrix3d &m, const Eigen::Vector3d &x) {
            return tolerance * (m.cwiseAbs() * x.cwiseAbs()).maxCoeff();
        };
        const gw_wheels_t rates = gw_kinematics_wheel_rates(&k, twist(v));
        EXPECT_VECTOR_NEAR(vector(rates), wheel * v, scale(wheel, v));
        EXPECT_VECTOR_NEAR(vector(gw_kinematics_roller_rates(&k, twist(v))), roller * v, scale(roller, v));
        const gw_wheels_t torques = wheels(torque);
        EXPECT_VECTOR_NEAR(vector(gw_kinematics_wrench_of_torques(&k, &torques)), wheel.transpose() * torque,
                           scale(wheel.transpose(), torque));
        EXPECT_VECTOR_NEAR(vector(gw_kinematics_wrench_of_rollers(&k, &torques)), roller.transpose() * torque,
                           scale(roller.transpose(), torque));
        const Eigen::Matrix3d inverse = wheel.inverse();
        EXPECT_VECTOR_NEAR(vector(gw_kinematics_torques_of_wrench(&k, wrench(torque))), inverse.transpose() * torque,
                           scale(inverse.transpose(), torque));
        const gw_wheels_t turning = wheels(v);
        EXPECT_VECTOR_NEAR(vector(gw_kinematics_twist(&k, &turning)), inverse * v, scale(inverse, v));
    }
}

// (29) and (30), corrected, on a spinning base: in the world frame xdd = J^-1 (qdd - Jdot xd).
TEST(Kinematics, AccelerationsOfASpinningBase)
{
    Random random(13);
    for (int trial = 0; trial < trials; ++trial) {
        const Robot robot = random_robot(random, trial);
        const double theta = random.uniform(-3.0, 3.0);
        const Eigen::Matrix3d wheel = wheel_jacobian(robot.geometry, theta);
        const Eigen::Vector3d rate = random_vector(random, 10.0);
        const Eigen::Vector3d rate_change = random_vector(random, 50.0);
        const Eigen::Vector3d v = wheel.inverse() * rate;
        const Eigen::Matrix3d wheel_change = wheel_jacobian_slope(robot.geometry, theta) * v(2);
        const Eigen::Vector3d a = wheel.inverse() * (rate_change - wheel_change * v);
        const Eigen::Vector3d roller_change =
            roller_jacobian(robot.geometry, theta) * a + roller_jacobian_slope(robot.geometry, theta) * v(2) * v;
        const gw_wheels_t rates = wheels(rate);
        const gw_wheels_t changes = wheels(rate_change);
        const gw_acceleration_t found = gw_kinematics_acceleration(&robot.kinematics, &rates, &changes);
        const double size = (wheel.inverse().cwiseAbs() * rate_change.cwiseAbs()).maxCoeff() + v.squaredNorm();
        EXPECT_VECTOR_NEAR(vector(found), to_base(theta) * a, tolerance * size);
        const gw_twist_t base_twist = gw_kinematics_twist(&robot.kinematics, &rates);
        const gw_wheels_t wheel_back = wheel_accelerations(&robot.kinematics, base_twist, found);
        const double wheel_size = (wheel.cwiseAbs() * a.cwiseAbs()).maxCoeff() + 50.0 + v.squaredNorm() * 50.0;
        EXPECT_VECTOR_NEAR(vector(wheel_back), rate_change, 10.0 * tolerance * wheel_size);
        const gw_wheels_t rollers = roller_accelerations(&robot.kinematics, base_twist, found);
        const double roller_size = (size + v.squaredNorm()) / robot.geometry.roller_radius_m;
        EXPECT_VECTOR_NEAR(vector(rollers), roller_change, 10.0 * tolerance * roller_size);
    }
}

TEST(Kinematics, ExternalJacobian)
{
    Random random(14);
    for (int trial = 0; trial < 300; ++trial) {
        const Eigen::Vector3d p = random_vector(random, 1.0);
        const Eigen::Vector3d force = random_vector(random, 50.0);
        const gw_vector_t point = {real(p(0)), real(p(1))};
        Eigen::Matrix3d expected; // (34) about the centre
        expected << 1, 0, -p(1), 0, 1, p(0), 0, 0, 1;
        EXPECT_VECTOR_NEAR(matrix(external_jacobian(point)), expected, 0.0);
        EXPECT_VECTOR_NEAR(vector(wrench_at_centre(point, wrench(force))), expected.transpose() * force,
                           200.0 * tolerance);
    }
}

// At rest T = -J^-T F: 100 N along 240 degrees gives wheel 0 two thirds of sin(60 deg) x 100 N x r_w.
TEST(Kinematics, SignOfTheTorqueOfAPush)
{
    gw_controller_config_t config;
    gw_controller_config_paper(&config);
    gw_kinematics_t k;
    ASSERT_EQ(gw_kinematics_init(&k, &config.geometry), GW_STATUS_OK);
    const double angle = 4.0 * pi / 3.0;
    const gw_wrench_t push = wrench({100.0 * std::cos(angle), 100.0 * std::sin(angle), 0.0});
    EXPECT_NEAR(-gw_kinematics_torques_of_wrench(&k, push).wheel[0], 5.866, 0.001);
}

} // namespace
