// Lanes have the bits of double, and a design of the plant has the same bits in every lane and width.
#include <gtest/gtest.h>

#include "lanes_checks.hpp"

namespace {

using namespace giveway::lanes_checks;

void fail(const char *what, double found, double expected, int lane) {
    ADD_FAILURE() << what << ": " << found << " instead of " << expected << " in lane " << lane;
}

bool has_avx2() { return __builtin_cpu_supports("avx2") != 0; }
bool has_avx512() {
    return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512dq") != 0 &&
           __builtin_cpu_supports("avx512vl") != 0;
}

int wrong = 0;

} // namespace

TEST(Lanes, One) {
    operations_1(fail);
    functions_1(fail);
    plant_1(fail);
}

TEST(Lanes, Four) {
    if (!has_avx2()) {
        GTEST_SKIP() << "this processor has no AVX2";
    }
    operations_4(fail);
    functions_4(fail);
    plant_4(fail);
}

TEST(Lanes, Eight) {
    if (!has_avx512()) {
        GTEST_SKIP() << "this processor has no AVX-512";
    }
    operations_8(fail);
    functions_8(fail);
    plant_8(fail);
}

// The planted fault: a number that is off by its last digit is reported.
TEST(Lanes, ADifferenceInTheLastDigitIsSeen) {
    wrong = 0;
    const Report count = [](const char *, double, double, int) { ++wrong; };
    compare(count, "the same", 0.1, 0.1, 0);
    compare(count, "next to it", 0.1, 0.10000000000000002, 0);
    EXPECT_EQ(wrong, 1);
    compare_close(count, "close", 1.0, 1.0 + 0.9e-11, 1e-11);
    compare_close(count, "not close", 1.0, 1.0 + 1.1e-11, 1e-11);
    compare_close(count, "no number", NAN, 1.0, 1e-11);
    EXPECT_EQ(wrong, 3);
}
