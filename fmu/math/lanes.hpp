// N designs side by side: a scalar type of the plant that computes N of them at once, with gcc's vector types.
// Every operation is exact or correctly rounded in each lane, so a design gets the same bits in every lane and in every
// width. 4 lanes need a file compiled for AVX2, 8 lanes one for AVX-512; 1 lane is for any processor.
#pragma once

#include <bit>
#include <cstdint>

#include "scalar.hpp"

#if defined(__AVX2__)
#include <immintrin.h>
#endif

namespace giveway::math {

namespace detail {

template <int N> struct LaneRegister;
template <> struct LaneRegister<1> {
    using Numbers = double;
    using Bits = std::int64_t;
    static Numbers min(Numbers a, Numbers b) { return math::min(a, b); }
    static Numbers max(Numbers a, Numbers b) { return math::max(a, b); }
    static Numbers sqrt(Numbers a) { return math::sqrt(a); }
    static bool any(Bits a) { return a != 0; }
    // Uses the low halves; likewise below.
    static Bits multiply_words(Bits a, Bits b) {
        return static_cast<Bits>((static_cast<std::uint64_t>(a) & 0xFFFFFFFFU) *
                                 (static_cast<std::uint64_t>(b) & 0xFFFFFFFFU));
    }
};
#if defined(__AVX2__)
template <> struct LaneRegister<4> {
    typedef double Numbers __attribute__((vector_size(32)));
    typedef std::int64_t Bits __attribute__((vector_size(32)));
    static Numbers min(Numbers a, Numbers b) { return _mm256_min_pd(a, b); } // a < b ? a : b, as for double
    static Numbers max(Numbers a, Numbers b) { return _mm256_max_pd(a, b); }
    static Numbers sqrt(Numbers a) { return _mm256_sqrt_pd(a); }
    static bool any(Bits a) { return _mm256_movemask_pd(_mm256_castsi256_pd(std::bit_cast<__m256i>(a))) != 0; }
    static Bits multiply_words(Bits a, Bits b) {
        return std::bit_cast<Bits>(_mm256_mul_epu32(std::bit_cast<__m256i>(a), std::bit_cast<__m256i>(b)));
    }
};
#endif
#if defined(__AVX512F__)
// The unmasked intrinsics make gcc 12 warn of its own header.
template <> struct LaneRegister<8> {
    typedef double Numbers __attribute__((vector_size(64)));
    typedef std::int64_t Bits __attribute__((vector_size(64)));
    static Numbers min(Numbers a, Numbers b) { return _mm512_maskz_min_pd(0xFF, a, b); }
    static Numbers max(Numbers a, Numbers b) { return _mm512_maskz_max_pd(0xFF, a, b); }
    static Numbers sqrt(Numbers a) { return _mm512_maskz_sqrt_pd(0xFF, a); }
    static bool any(Bits a) { return _mm512_movepi64_mask(std::bit_cast<__m512i>(a)) != 0; }
    static Bits multiply_words(Bits a, Bits b) {
        return std::bit_cast<Bits>(_mm512_maskz_mul_epu32(0xFF, std::bit_cast<__m512i>(a), std::bit_cast<__m512i>(b)));
    }
};
#endif

} // namespace detail

template <int N> struct LaneMask {
    typename detail::LaneRegister<N>::Bits bits; // zero where false
};

template <int N> struct Lanes {
    using Register = detail::LaneRegister<N>;
    using Numbers = typename Register::Numbers;
    using Bits = typename Register::Bits;
    Numbers value;

    Lanes() : value{} {}
    explicit Lanes(double same) : value(same - Numbers{}) {} // exact, and keeps -0
    static Lanes of(Numbers numbers) {
        Lanes a;
        a.value = numbers;
        return a;
    }
    // From and to N numbers of any alignment.
    static Lanes load(const double *from) {
        Lanes a;
        __builtin_memcpy(&a.value, from, sizeof a.value);
        return a;
    }
    void store(double *to) const { __builtin_memcpy(to, &value, sizeof value); }

    friend Lanes operator+(Lanes a, Lanes b) { return of(a.value + b.value); }
    friend Lanes operator-(Lanes a, Lanes b) { return of(a.value - b.value); }
    friend Lanes operator*(Lanes a, Lanes b) { return of(a.value * b.value); }
    friend Lanes operator/(Lanes a, Lanes b) { return of(a.value / b.value); }
};

template <int N> struct LaneDivisor {
    Lanes<N> value, inverse;

    LaneDivisor() : LaneDivisor(Lanes<N>(1.0)) {}
    LaneDivisor(Lanes<N> a) : value(a), inverse(Lanes<N>(1.0) / a) {}
    operator Lanes<N>() const { return value; }
    friend Lanes<N> operator/(Lanes<N> a, const LaneDivisor &b) { return a * b.inverse; }
};
template <int N> struct DivisorOf<Lanes<N>> {
    using Type = LaneDivisor<N>;
};

template <int N> LaneMask<N> less(Lanes<N> a, Lanes<N> b) { return {a.value < b.value}; }
template <int N> Lanes<N> select(LaneMask<N> mask, Lanes<N> if_true, Lanes<N> if_false) {
    return Lanes<N>::of(mask.bits ? if_true.value : if_false.value);
}
template <int N> Lanes<N> min(Lanes<N> a, Lanes<N> b) {
    return Lanes<N>::of(Lanes<N>::Register::min(a.value, b.value));
}
template <int N> Lanes<N> max(Lanes<N> a, Lanes<N> b) {
    return Lanes<N>::of(Lanes<N>::Register::max(a.value, b.value));
}
template <int N> Lanes<N> sqrt(Lanes<N> a) { return Lanes<N>::of(Lanes<N>::Register::sqrt(a.value)); }
template <int N> Lanes<N> abs(Lanes<N> a) {
    using L = Lanes<N>;
    return L::of(std::bit_cast<typename L::Numbers>(std::bit_cast<typename L::Bits>(a.value) & 0x7FFFFFFFFFFFFFFFLL));
}

template <int N> bool any(LaneMask<N> mask) { return Lanes<N>::Register::any(mask.bits); }
template <int N, class Of> Lanes<N> where(LaneMask<N> needed, Of of) {
    return any(needed) ? select(needed, of(), Lanes<N>(0.0)) : Lanes<N>(0.0);
}

template <int N> Lanes<N> acting(Lanes<N> mode, Lanes<N> depth) {
    return select(less(Lanes<N>(0.0), depth), mode, Lanes<N>(0.0));
}

// Nearest integer (ties to even) for |a| < 2^51, as for double.
template <int N> Lanes<N> round(Lanes<N> a) {
    const Lanes<N> shift(6755399441055744.0); // 1.5 * 2^52
    return (a + shift) - shift;
}

// 2^k for an integral k in [-1022, 1023]: the sum carries k + 1023 in its lowest bits.
template <int N> Lanes<N> exp2_integer(Lanes<N> k) {
    using L = Lanes<N>;
    const L sum = k + L(6755399441055744.0 + 1023.0);
    return L::of(std::bit_cast<typename L::Numbers>(std::bit_cast<typename L::Bits>(sum.value) << 52));
}

// As for double: the exponent's bits become the last ones of a number of 2^52.
template <int N> Split<Lanes<N>> split(Lanes<N> a) {
    using L = Lanes<N>;
    const auto bits = std::bit_cast<typename L::Bits>(a.value);
    const L exponent =
        L::of(std::bit_cast<typename L::Numbers>((bits >> 52) | 0x4330000000000000LL)) - L(0x1p52 + 1023.0);
    return {exponent, L::of(std::bit_cast<typename L::Numbers>((bits & 0x000FFFFFFFFFFFFFLL) | 0x3FF0000000000000LL))};
}

} // namespace giveway::math
