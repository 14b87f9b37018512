// Shared by the tests of c_core: tolerances, random robots, and Eigen's view of the same quantities.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "giveway/giveway.h"
#include "matrix_forms.h"

using Real = gw_real_t;

inline constexpr bool is_double = sizeof(Real) == sizeof(double);
inline constexpr double epsilon = static_cast<double>(std::numeric_limits<Real>::epsilon());
inline constexpr Real not_a_number = std::numeric_limits<Real>::quiet_NaN();
inline constexpr Real infinite = std::numeric_limits<Real>::infinity();
inline constexpr double pi = std::numbers::pi;

// Relative tolerance of a quantity computed with about twenty roundings: 1e-12 in double (4500 ulp) and 1e-5 in float
// (84 ulp). To be multiplied by the magnitude of the largest term.
inline constexpr double tolerance = is_double ? 1e-12 : 1e-5;

inline Real real(double value)
{
    return static_cast<Real>(value);
}

class Random
{
public:
    explicit Random(unsigned seed) : engine_(seed)
    {
    }
    double uniform(double low, double high)
    {
        return std::uniform_real_distribution<double>(low, high)(engine_);
    }
    double normal(double sigma)
    {
        return std::normal_distribution<double>(0.0, sigma)(engine_);
    }
    int integer(int low, int high)
    {
        return std::uniform_int_distribution<int>(low, high)(engine_);
    }
    std::uint64_t bits()
    {
        return engine_();
    }

private:
    std::mt19937_64 engine_;
};

inline constexpr std::array<std::array<std::uint32_t, 3>, 6> wheel_orders = {
    {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};

// Any robot that the configuration allows, wheel order included.
inline gw_geometry_config_t random_geometry(Random &random, int trial)
{
    gw_geometry_config_t g{};
    g.wheel_radius_m = real(random.uniform(0.02, 0.3));
    g.roller_radius_m = real(random.uniform(0.003, 0.05));
    g.wheel_distance_m = real(random.uniform(0.05, 1.0));
    const auto &order = wheel_orders[static_cast<std::size_t>(trial) % wheel_orders.size()];
    for (std::size_t i = 0; i < 3; ++i) {
        g.wheel_slot[i] = order[i];
    }
    g.azimuth_rad = real(random.uniform(-3.0, 3.0));
    return g;
}

inline double azimuth(const gw_geometry_config_t &g, std::size_t wheel)
{
    return g.wheel_slot[wheel] * 2.0 * pi / 3.0 + static_cast<double>(g.azimuth_rad);
}

// (15) and (16) as they are printed, at yaw theta.
inline Eigen::Matrix3d wheel_jacobian(const gw_geometry_config_t &g, double theta)
{
    Eigen::Matrix3d jacobian;
    for (std::size_t i = 0; i < 3; ++i) {
        const double angle = theta + azimuth(g, i);
        jacobian.row(static_cast<Eigen::Index>(i)) << -std::sin(angle), std::cos(angle), g.wheel_distance_m;
    }
    return jacobian / static_cast<double>(g.wheel_radius_m);
}

inline Eigen::Matrix3d roller_jacobian(const gw_geometry_config_t &g, double theta)
{
    Eigen::Matrix3d jacobian;
    for (std::size_t i = 0; i < 3; ++i) {
        const double angle = theta + azimuth(g, i);
        jacobian.row(static_cast<Eigen::Index>(i)) << std::cos(angle), std::sin(angle), 0.0;
    }
    return jacobian / static_cast<double>(g.roller_radius_m);
}

// Derivatives of the two with respect to theta.
inline Eigen::Matrix3d wheel_jacobian_slope(const gw_geometry_config_t &g, double theta)
{
    Eigen::Matrix3d slope = -static_cast<double>(g.roller_radius_m) * roller_jacobian(g, theta);
    return slope / static_cast<double>(g.wheel_radius_m);
}

inline Eigen::Matrix3d roller_jacobian_slope(const gw_geometry_config_t &g, double theta)
{
    Eigen::Matrix3d slope = static_cast<double>(g.wheel_radius_m) * wheel_jacobian(g, theta);
    slope.col(2).setZero();
    return slope / static_cast<double>(g.roller_radius_m);
}

inline Eigen::Vector3d vector(const gw_wheels_t &w)
{
    return {w.wheel[0], w.wheel[1], w.wheel[2]};
}
inline Eigen::Vector3d vector(const gw_wrench_t &w)
{
    return {w.force_x_n, w.force_y_n, w.torque_nm};
}
inline Eigen::Vector3d vector(const gw_twist_t &t)
{
    return {t.vx_mps, t.vy_mps, t.omega_radps};
}
inline Eigen::Vector3d vector(const gw_acceleration_t &a)
{
    return {a.ax_mps2, a.ay_mps2, a.alpha_radps2};
}
inline gw_wheels_t wheels(const Eigen::Vector3d &v)
{
    return {{real(v(0)), real(v(1)), real(v(2))}};
}
inline gw_wrench_t wrench(const Eigen::Vector3d &v)
{
    return {real(v(0)), real(v(1)), real(v(2))};
}
inline gw_twist_t twist(const Eigen::Vector3d &v)
{
    return {real(v(0)), real(v(1)), real(v(2))};
}
inline gw_acceleration_t acceleration(const Eigen::Vector3d &v)
{
    return {real(v(0)), real(v(1)), real(v(2))};
}

inline Eigen::Matrix3d matrix(const matrix_t &m)
{
    Eigen::Matrix3d result;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            result(i, j) = m.m[i][j];
        }
    }
    return result;
}

// The vector rounded to the real type: the library's actual input.
inline Eigen::Vector3d rounded(const Eigen::Vector3d &v)
{
    return {static_cast<double>(real(v(0))), static_cast<double>(real(v(1))), static_cast<double>(real(v(2)))};
}

inline Eigen::Vector3d random_vector(Random &random, double size)
{
    return rounded({random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)});
}

// From the world to the base frame at yaw theta.
inline Eigen::Matrix3d to_base(double theta)
{
    return Eigen::AngleAxisd(-theta, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

#define EXPECT_VECTOR_NEAR(actual, expected, absolute) \
    EXPECT_LE(((actual) - (expected)).cwiseAbs().maxCoeff(), (absolute)) \
        << "actual " << (actual).transpose() << "\nexpected " << (expected).transpose()
