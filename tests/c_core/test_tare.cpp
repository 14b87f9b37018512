#include "support.hpp"

namespace
{

TEST(Tare, IsTheMeanOfItsSamples)
{
    Random random(111);
    for (const unsigned samples : {1U, 2U, 100U, 100'000U}) {
        gw_tare_t tare{};
        gw_tare_start(&tare);
        Eigen::Matrix<long double, 3, 1> sum = Eigen::Matrix<long double, 3, 1>::Zero();
        gw_wheels_t mean = wheels({7.0, 7.0, 7.0});
        for (unsigned i = 1; i <= samples; ++i) {
            const gw_wheels_t torque = wheels({1.5 + random.uniform(-0.2, 0.2), -2.4 + random.uniform(-0.2, 0.2), 0.1});
            sum += vector(torque).cast<long double>();
            const auto progress = gw_tare_add(&tare, &torque, samples, real(0.5), &mean);
            ASSERT_EQ(progress, i == samples ? GW_TARE_DONE : GW_TARE_RUNNING);
            ASSERT_TRUE(gw_tare_invariant_holds(&tare));
            if (i < samples) {
                ASSERT_EQ(mean.wheel[0], real(7)); // untouched until it is done
            }
        }
        EXPECT_VECTOR_NEAR(vector(mean), Eigen::Vector3d((sum / samples).cast<double>()), 4.0 * epsilon * 2.4);
        EXPECT_EQ(tare.count, 0U); // ready for the next
    }
}

} // namespace
