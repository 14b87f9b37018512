#include "support.hpp"

namespace
{

// A day at 1 kHz.
constexpr int ticks_of_a_day = 86'400'000;

TEST(Sum, APositionAfterADayIsAsFineAsInTheFirstSecond)
{
    // 0.16 m/s back and forth: the plain float sum would be off by millimetres.
    const Real step = real(0.16e-3);
    gw_sum_t sum = gw_sum_of(real(0));
    for (int i = 0; i < ticks_of_a_day; ++i) {
        sum = gw_sum_add(sum, ((i / 1000) % 2 == 0) ? step : -step);
    }
    EXPECT_NEAR(sum.value, 0.0, 0.16 * epsilon);
    // And one way: 13.8 km, to the last bit of the value.
    sum = gw_sum_of(real(0));
    for (int i = 0; i < ticks_of_a_day; ++i) {
        sum = gw_sum_add(sum, step);
    }
    EXPECT_NEAR(sum.value / (static_cast<double>(step) * ticks_of_a_day), 1.0, epsilon);
}

TEST(Sum, AnAngleAfterADayIsAsFineAsInTheFirstSecond)
{
    for (const double speed : {2.0, -2.0, 0.7}) {
        const Real step = real(speed * 1e-3);
        gw_sum_t sum = gw_sum_of(real(0));
        for (int i = 0; i < ticks_of_a_day; ++i) {
            sum = gw_sum_add_angle(sum, step);
        }
        ASSERT_GE(sum.value, -GW_PI);
        ASSERT_LT(sum.value, GW_PI);
        const long double truth = static_cast<long double>(step) * ticks_of_a_day;
        const long double turn = 2.0L * std::numbers::pi_v<long double>;
        const long double error = std::remainder(truth - sum.value, turn);
        // The compensated sum keeps about eps^2 per addend; 86 million of them in float add up to 3e-6.
        EXPECT_LE(std::fabs(error), is_double ? 1e-14L : 4e-6L) << speed;
    }
}

} // namespace
