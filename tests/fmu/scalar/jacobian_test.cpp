// Dual numbers through the plant: the values equal those of double, and the derivatives equal finite differences.
#include <cmath>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "jacobian.hpp"
#include "random_cases.hpp"

namespace {

using namespace giveway::plant;
using At = Layout<>;
using giveway::plant::random_cases::Case;
using giveway::plant::random_cases::random_case;
using giveway::plant::random_cases::random_tipping_case;

// The shared cases, moved to where the plant's parts are active: bristles around their sliding limit, motions slow
// enough for friction that is smooth over millimetres per second, and every structural choice.
Case<double> working_case(unsigned seed) {
    auto c = random_case<double>(seed);
    if (seed % 4U != 0U) {
        for (int i = 0; i < table_wheels; ++i) {
            c.x[At::bristle + i] *= 0.01;
        }
    }
    if (seed % 3U == 0U) {
        for (const int speed : {At::base_vx, At::base_vy, At::base_omega, At::slider_speed, At::compression_rate}) {
            c.x[speed] *= 0.02;
        }
        c.x[At::compression] *= 0.01;
    }
    c.p.roller_model = seed % 5U == 0U ? RollerModel::tanh : RollerModel::bristle;
    c.p.slider_present = seed % 17U == 0U ? 0 : 1;
    c.p.rope_attached = seed % 7U == 0U ? 0 : 1;
    c.d = derive(c.p);
    return c;
}

StateVector<double> rate(const Case<double> &c, const StateVector<double> &x) { return rhs(x, c.u, c.m, c.p, c.d); }

struct Differences {
    StateVector<double> above, below;
    double distance;
    [[nodiscard]] double slope(int row) const { return (above[row] - below[row]) / distance; }
    [[nodiscard]] double second(int row, const StateVector<double> &centre) const {
        return (above[row] - centre[row]) - (centre[row] - below[row]);
    }
};

} // namespace

TEST(PlantInDuals, HasTheBitsOfDouble) {
    using Scalar = Jacobian<>::Scalar;
    for (unsigned seed = 0; seed < 2000U; ++seed) {
        const auto c = working_case(seed);
        StateVector<Scalar> x;
        for (int i = 0; i < At::state_count; ++i) {
            x[i] = Scalar::variable(c.x[i], i % jacobian_chunk);
        }
        // Through convert(): a parameter that got lost there would show.
        const auto p = convert<Scalar>(c.p);
        const auto d = convert<Scalar>(c.d);
        const auto u = convert<Scalar>(c.u);
        const auto m = convert<Scalar>(c.m);
        const auto rate_of_double = rate(c, c.x);
        const auto rate_of_dual = rhs(x, u, m, p, d);
        for (int i = 0; i < At::state_count; ++i) {
            EXPECT_EQ(std::memcmp(&rate_of_double[i], &rate_of_dual[i].value, sizeof(double)), 0)
                << "case " << seed << ", rate " << i;
        }
        const auto indicators_of_double = event_indicators(c.x, c.u, c.m, c.p, c.d);
        const auto indicators_of_dual = event_indicators(x, u, m, p, d);
        for (int i = 0; i < At::event_count; ++i) {
            EXPECT_EQ(std::memcmp(&indicators_of_double[i], &indicators_of_dual[i].value, sizeof(double)), 0)
                << "case " << seed << ", indicator " << i;
        }
    }
}

TEST(PlantJacobian, IsWhatFiniteDifferencesFind) {
    constexpr unsigned cases = 3000;
    constexpr double step =
        1e-6; // of m, rad, m/s, rad/s: far below the 0.5 mm and 1 mm/s over which the sharpest functions bend
    long compared = 0;
    long sharp = 0;
    for (unsigned seed = 0; seed < cases; ++seed) {
        const auto c = working_case(seed);
        Jacobian<> jacobian;
        jacobian.set_parameters(c.p, c.d);
        std::array<double, At::state_count * At::state_count> matrix{};
        jacobian.evaluate(c.x, c.u, c.m, matrix.data());
        // Rounding of a rate is that of its terms, which may cancel. The largest term, the force of a stop, has this
        // magnitude.
        std::array<double, At::state_count> magnitude{};
        const auto centre = rate(c, c.x);
        for (int row = 0; row < At::state_count; ++row) {
            magnitude[row] = std::fabs(centre[row]);
            for (int column = 0; column < At::state_count; ++column) {
                magnitude[row] += std::fabs(matrix[column * At::state_count + row] * c.x[column]);
            }
        }
        // A force that is turned into base axes and back brings the rounding of its whole to both components.
        magnitude[At::impulse_x] = magnitude[At::impulse_y] = magnitude[At::impulse_x] + magnitude[At::impulse_y];
        for (int column = 0; column < At::state_count; ++column) {
            const auto differences = [&](double h) {
                auto above = c.x;
                auto below = c.x;
                above[column] += h;
                below[column] -= h;
                return Differences{rate(c, above), rate(c, below), above[column] - below[column]};
            };
            const auto coarse = differences(step);
            const auto fine = differences(0.5 * step);
            for (int row = 0; row < At::state_count; ++row) {
                const double exact = matrix[column * At::state_count + row];
                const double extrapolated = (4.0 * fine.slope(row) - coarse.slope(row)) / 3.0;
                // An estimate of the differences' error. Curvature and a kink between the points show in the
                // disagreement of the two steps; a kink right at the centre shows in the second differences, which are
                // 4 to 1 of a smooth function, 2 to 1 there.
                const double kink = std::fabs(coarse.second(row, centre) - 4.0 * fine.second(row, centre)) / step;
                const double rounding = 40.0 * std::numeric_limits<double>::epsilon() * magnitude[row] / step;
                const double tolerance = std::fabs(fine.slope(row) - coarse.slope(row)) + kink + rounding;
                EXPECT_NEAR(exact, extrapolated, tolerance)
                    << "case " << seed << ": d rate[" << row << "]/d x[" << column << "]";
                if (exact != 0.0 || extrapolated != 0.0) {
                    ++compared;
                    sharp += tolerance < 1e-4 * std::fabs(exact) ? 1 : 0;
                }
            }
        }
    }
    EXPECT_GT(compared, 100L * cases);
    // The comparison would be worth little if its tolerances were wide: entries that are small beside their rate's
    // rounding are the rest.
    EXPECT_GT(static_cast<double>(sharp), 0.9 * static_cast<double>(compared)) << sharp << " of " << compared;
}

TEST(PlantJacobian, IsFiniteOnKinks) {
    // At rest, touching, with every mode on: where differences have no limit, the derivative of one side.
    for (unsigned seed = 0; seed < 12U; ++seed) {
        auto c = random_case<double>(seed);
        c.x = {};
        c.m = {{0.0, 1.0, -1.0}, 1.0, 1.0, 1.0, 1.0, 0.0, 1.0, 1.0};
        Jacobian<> jacobian;
        jacobian.set_parameters(c.p, c.d);
        std::array<double, At::state_count * At::state_count> matrix{};
        jacobian.evaluate(c.x, c.u, c.m, matrix.data());
        for (const double entry : matrix) {
            EXPECT_TRUE(std::isfinite(entry)) << "case " << seed;
        }
    }
}

TEST(PlantJacobian, IsWhatFiniteDifferencesFindWhereTheBaseTips) {
    constexpr double step = 1e-8; // the grip bends over microns
    long compared = 0;
    for (unsigned seed = 0; seed < 500U; ++seed) {
        const auto [c, x, fired] = random_tipping_case<double>(seed);
        Jacobian<> jacobian;
        jacobian.set_parameters(c.p, c.d);
        std::array<double, At::tipping_state_count * At::tipping_state_count> matrix{};
        jacobian.evaluate(x, c.u, c.m, matrix.data());
        const auto centre = rhs(x, c.u, c.m, c.p, c.d);
        for (int column = 0; column < At::tipping_state_count; ++column) {
            auto above = x;
            auto below = x;
            above[column] += step;
            below[column] -= step;
            const auto high = rhs(above, c.u, c.m, c.p, c.d);
            const auto low = rhs(below, c.u, c.m, c.p, c.d);
            for (int row = 0; row < At::tipping_state_count; ++row) {
                const double exact = matrix[column * At::tipping_state_count + row];
                const double slope = (high[row] - low[row]) / (above[column] - below[column]);
                // Curvature and kinks show in the second difference; rounding is that of forces up to 1e5 N on a
                // wheel's inertia, 1e-3 kg m2.
                const double bend = std::fabs((high[row] - centre[row]) - (centre[row] - low[row])) / step;
                EXPECT_NEAR(exact, slope, bend + 1e-4 * std::fabs(exact) + 2.0)
                    << "case " << seed << ": d rate[" << row << "]/d x[" << column << "]";
                compared += std::fabs(exact) > 100.0 ? 1 : 0;
            }
        }
    }
    EXPECT_GT(compared, 10000);
}
