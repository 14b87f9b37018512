#include <algorithm>

#include "support.hpp"

namespace
{

// Friction of three wheels, mass, and a force along x and y in parts of `offset_n`.
constexpr int states = 6;
constexpr double offset_n = 30.0;
using State = Eigen::Vector<double, states>;
using Covariance = Eigen::Matrix<double, states, states>;
using Regressor = Eigen::Matrix<double, 2, states>;

constexpr double interval = 0.008;

gw_kinematics_t kinematics_of(Random &random, int trial)
{
    const gw_geometry_config_t geometry = random_geometry(random, trial);
    gw_kinematics_t kinematics{};
    EXPECT_EQ(gw_kinematics_init(&kinematics, &geometry), GW_STATUS_OK);
    return kinematics;
}

Eigen::Vector2d planar(const gw_vector_t &v)
{
    return {v.x, v.y};
}

// A textbook Kalman filter of one component of the force, in double, with the covariance in Joseph's form.
class Textbook
{
public:
    explicit Textbook(const gw_follower_config_t &config) : config_(config)
    {
        const double common = config.friction_common;
        const double wheel = config.friction_wheel;
        const double mass = config.mass;
        const double offset = config.offset_n / offset_n;
        covariance.setZero();
        covariance.topLeftCorner<3, 3>().setConstant(common * common);
        covariance.diagonal() +=
            State(wheel * wheel, wheel * wheel, wheel * wheel, mass * mass, offset * offset, offset * offset);
        first_ = covariance.diagonal();
    }

    void learn(const Regressor &columns, const Eigen::Vector2d &residual, int component)
    {
        Eigen::RowVector<double, states> h = -columns.row(component);
        if (columns.col(3).norm() < 8.0) {
            h(3) = 0.0;
        }
        for (int i = 0; i < states; ++i) {
            if (covariance(i, i) < first_(i)) {
                covariance(i, i) += (i < 4 ? 1.0 : 100.0) * std::pow(config_.drift_per_root_s, 2) * interval;
            }
        }
        const double noise = config_.residual_n * config_.residual_n;
        const State gain = covariance * h.transpose() / (h * covariance * h.transpose() + noise);
        const Covariance kept = Covariance::Identity() - gain * h;
        state += gain * (residual(component) - h * state);
        covariance = (kept * covariance * kept.transpose() + gain * noise * gain.transpose()).eval();
    }

    State state = State::Zero();
    Covariance covariance;

private:
    gw_follower_config_t config_;
    State first_;
};

// What happens to one robot: its model's forces and the residual without contact.
struct Moment {
    gw_model_forces_t forces{};
    gw_vector_t residual{};
};

Regressor columns_of(const gw_kinematics_t &kinematics, const gw_model_forces_t &forces)
{
    Regressor columns;
    for (int i = 0; i < 3; ++i) {
        columns.col(i) = planar(kinematics.radial[i]) * static_cast<double>(forces.friction_n.wheel[i]);
    }
    columns.col(3) = planar(forces.inertia_n);
    columns.rightCols<2>() = offset_n * Eigen::Matrix2d::Identity();
    return columns;
}

// Friction up to `size` per wheel and as much inertia; now and then the robot coasts or turns on the spot.
Moment random_moment(Random &random, const gw_kinematics_t &kinematics, const State &truth, double size, double noise)
{
    Moment moment;
    for (auto &friction : moment.forces.friction_n.wheel) {
        friction = real(random.uniform(-size, size));
    }
    if (random.integer(0, 2) == 0) {
        moment.forces.inertia_n = {real(random.uniform(-size, size)), real(random.uniform(-size, size))};
    }
    const Eigen::Vector2d residual =
        -columns_of(kinematics, moment.forces) * truth + Eigen::Vector2d(random.normal(noise), random.normal(noise));
    moment.residual = {real(residual(0)), real(residual(1))};
    return moment;
}

State state_of(const gw_follower_t &follower)
{
    State state;
    std::copy_n(follower.difference, states, state.data());
    return state;
}

Covariance covariance_of(const gw_follower_t &follower)
{
    Covariance covariance;
    for (int i = 0; i < states; ++i) {
        for (int k = 0; k < states; ++k) {
            covariance(i, k) = follower.covariance[i][k];
        }
    }
    return covariance;
}

State random_truth(Random &random, const gw_follower_config_t &config)
{
    const double common = random.normal(config.friction_common);
    State truth;
    for (int i = 0; i < 3; ++i) {
        truth(i) = std::clamp(common + random.normal(config.friction_wheel), -0.5, 0.5);
    }
    truth(3) = std::clamp(random.normal(config.mass), -0.5, 0.5);
    for (int i = 4; i < states; ++i) {
        truth(i) = std::clamp(random.normal(config.offset_n / offset_n), -0.5, 0.5);
    }
    return truth;
}

gw_follower_config_t trikey_follower()
{
    gw_follower_config_t config;
    gw_follower_config_trikey(&config);
    return config;
}

// Ten minutes of motion on each of 20 robots. Drift makes the filter forget what it rounded, so errors do not add up:
// some hundred roundings of differences of 0.5, and ten of the first covariance (0.04).
TEST(Follower, LearnsAsATextbooksFilterInJosephsForm)
{
    Random random(131);
    const gw_follower_config_t config = trikey_follower();
    double worst_state = 0.0;
    double worst_covariance = 0.0;
    for (int trial = 0; trial < 20; ++trial) {
        const gw_kinematics_t kinematics = kinematics_of(random, trial);
        const State truth = random_truth(random, config);
        gw_follower_t follower{};
        gw_follower_init(&follower, &config, real(interval));
        Textbook textbook(config);
        for (int i = 0; i < 75'000; ++i) {
            const Moment moment = random_moment(random, kinematics, truth, 40.0, 5.0);
            const Regressor columns = columns_of(kinematics, moment.forces);
            const gw_regressors_t regressors = gw_follower_regressors(&kinematics, &moment.forces);
            gw_follower_learn(&follower, &regressors, moment.residual, i % 2 == 1);
            textbook.learn(columns, planar(moment.residual), i % 2);
            worst_state = std::max(worst_state, (state_of(follower) - textbook.state).cwiseAbs().maxCoeff());
            worst_covariance =
                std::max(worst_covariance, (covariance_of(follower) - textbook.covariance).cwiseAbs().maxCoeff());
        }
        ASSERT_TRUE(gw_follower_invariant_holds(&follower));
        // Drift keeps some 3 % unknown of each wheel; the estimate is within four of its own standard deviations.
        for (int i = 0; i < states; ++i) {
            EXPECT_NEAR(state_of(follower)(i), truth(i), 4.0 * std::sqrt(covariance_of(follower)(i, i)) + 1e-3);
        }
        // What the detector asks for, against the textbook's.
        const Moment moment = random_moment(random, kinematics, truth, 40.0, 0.0);
        const Regressor columns = columns_of(kinematics, moment.forces);
        const gw_regressors_t regressors = gw_follower_regressors(&kinematics, &moment.forces);
        const gw_vector_t correction = gw_follower_correction(&follower, &kinematics, &moment.forces);
        EXPECT_LE((planar(correction) - columns.leftCols<4>() * textbook.state.head<4>()).norm(),
                  is_double ? 1e-10 : 1e-3);
        const gw_planar_covariance_t s = gw_follower_uncertainty(&follower, &regressors);
        const Eigen::Matrix2d expected =
            columns.leftCols<4>() * textbook.covariance.topLeftCorner<4, 4>() * columns.leftCols<4>().transpose();
        EXPECT_NEAR(s.xx, expected(0, 0), (is_double ? 1e-12 : 1e-5) * expected.trace());
        EXPECT_NEAR(s.xy, expected(0, 1), (is_double ? 1e-12 : 1e-5) * expected.trace());
        EXPECT_NEAR(s.yy, expected(1, 1), (is_double ? 1e-12 : 1e-5) * expected.trace());
    }
    EXPECT_LE(worst_state, is_double ? 1e-13 : 1e-5);
    EXPECT_LE(worst_covariance, is_double ? 1e-15 : 5e-8);
}

// The short form of the update loses symmetry and definiteness to rounding; over an hour no more than float can tell.
TEST(Follower, CovarianceStaysOneForAnHour)
{
    Random random(132);
    const gw_follower_config_t config = trikey_follower();
    const gw_kinematics_t kinematics = kinematics_of(random, 0);
    const State truth = random_truth(random, config);
    gw_follower_t follower{};
    gw_follower_init(&follower, &config, real(interval));
    double least = 1.0;
    double skew = 0.0;
    for (int i = 0; i < 450'000; ++i) {
        const Moment moment = random_moment(random, kinematics, truth, 60.0, 5.0);
        const gw_regressors_t regressors = gw_follower_regressors(&kinematics, &moment.forces);
        gw_follower_learn(&follower, &regressors, moment.residual, i % 2 == 1);
        if (i % 100 == 0) {
            const Covariance covariance = covariance_of(follower);
            skew = std::max(skew, (covariance - covariance.transpose()).cwiseAbs().maxCoeff());
            const Covariance even = 0.5 * (covariance + covariance.transpose());
            // A negative eigenvalue would give a negative pivot. Eigen's eigenvalues take 14 s more to compile.
            least = std::min(least, even.ldlt().vectorD().minCoeff());
        }
    }
    EXPECT_GE(least, 0.0);
    EXPECT_LE(skew, 0.1 * epsilon); // the covariance soon is 1e-3 and less
}

} // namespace
