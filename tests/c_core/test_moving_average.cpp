#include <deque>
#include <memory>
#include <vector>

#include "support.hpp"

namespace
{

class MovingAverage : public testing::TestWithParam<unsigned>
{
};

TEST_P(MovingAverage, IsEigensMeanOverAMillionSamples)
{
    const unsigned window = GetParam();
    auto average = std::make_unique<gw_moving_average_t>();
    ASSERT_EQ(gw_moving_average_init(average.get(), window), GW_STATUS_OK);
    Random random(41 + window);
    Eigen::MatrixXd history = Eigen::MatrixXd::Zero(3, window);
    constexpr int samples = 1'000'000;
    for (int i = 0; i < samples; ++i) {
        // Bursts of large values in between, whose rounding errors must not persist.
        const double size = (i / 1000) % 50 == 7 ? 1e6 : 10.0;
        const Eigen::Vector3d sample = random_vector(random, size);
        history.col(i % static_cast<int>(window)) = sample;
        ASSERT_EQ(gw_moving_average_add(average.get(), wrench(sample)), GW_STATUS_OK);
        const bool looked_at = i < 3000 || i % 997 == 0 || i > samples - 3000;
        // One window after a burst its rounding error is gone; until then it is proportional to the burst.
        if (looked_at) {
            const auto held = std::min<int>(i + 1, static_cast<int>(window));
            const Eigen::Vector3d truth = history.rowwise().sum() / held;
            const bool burst_is_near =
                ((i / 1000) % 50) >= 7 && ((i / 1000) % 50) <= 9 + static_cast<int>(window) / 500;
            // Rounding errors of `window` additions, as a random walk with a margin of ten.
            const double allowed = 10.0 * epsilon * std::sqrt(window) * (burst_is_near ? 1e6 : 10.0);
            EXPECT_VECTOR_NEAR(vector(gw_moving_average_mean(average.get())), truth, allowed) << i;
            EXPECT_VECTOR_NEAR(vector(gw_moving_average_window_mean(average.get())),
                               Eigen::Vector3d(truth * held / window), allowed);
        }
        if (i % 100'000 == 0) {
            ASSERT_TRUE(gw_moving_average_invariant_holds(average.get()));
        }
    }
    EXPECT_EQ(gw_moving_average_count(average.get()), window);
}

INSTANTIATE_TEST_SUITE_P(Windows, MovingAverage, testing::Values(1U, 2U, 3U, 20U, 1000U, 1023U, 1024U));

} // namespace
