// What the batch library of a platform needs of a C++ runtime besides shell/heap.cpp, so that it is linked without one:
// aligned memory, local statics, and which instructions the processor has. Private to the library.
#include <sched.h>

#include <cstdint>
#include <cstdlib>
#include <new>

#ifdef _WIN32
#include <malloc.h>
#endif
#ifdef __x86_64__
#include <cpuid.h>
#endif

void *operator new(std::size_t size, std::align_val_t alignment, const std::nothrow_t &) noexcept {
#ifdef _WIN32
    return _aligned_malloc(size, static_cast<std::size_t>(alignment));
#else
    void *memory = nullptr;
    return posix_memalign(&memory, static_cast<std::size_t>(alignment), size) == 0 ? memory : nullptr;
#endif
}

void operator delete(void *memory, std::align_val_t) noexcept {
#ifdef _WIN32
    _aligned_free(memory);
#else
    std::free(memory);
#endif
}

void operator delete(void *memory, std::size_t, std::align_val_t alignment) noexcept {
    operator delete(memory, alignment);
}

// A guard's first byte: the static is there; its second: a thread makes it, and others wait.
extern "C" int __cxa_guard_acquire(std::uint8_t *guard) {
    while (__atomic_load_n(guard, __ATOMIC_ACQUIRE) == 0) {
        std::uint8_t nobody = 0;
        if (!__atomic_compare_exchange_n(guard + 1, &nobody, std::uint8_t{1}, false, __ATOMIC_ACQUIRE,
                                         __ATOMIC_RELAXED)) {
            (void)sched_yield();
        } else if (__atomic_load_n(guard, __ATOMIC_ACQUIRE) == 0) {
            return 1;
        } else { // made between the two looks
            __atomic_store_n(guard + 1, std::uint8_t{0}, __ATOMIC_RELEASE);
        }
    }
    return 0;
}

extern "C" void __cxa_guard_release(std::uint8_t *guard) {
    __atomic_store_n(guard, std::uint8_t{1}, __ATOMIC_RELEASE);
    __atomic_store_n(guard + 1, std::uint8_t{0}, __ATOMIC_RELEASE);
}

#ifdef __x86_64__
// What __builtin_cpu_supports reads; the bits' numbers are those of GCC's and LLVM's run-time libraries.
struct CpuModel {
    unsigned vendor, type, subtype, features;
};
extern "C" CpuModel __cpu_model;
CpuModel __cpu_model = {};

namespace {

constexpr unsigned has_avx2 = 1U << 10U, has_avx512f = 1U << 15U, has_avx512vl = 1U << 20U, has_avx512dq = 1U << 22U;

// The registers that the system saves when it changes threads.
unsigned saved_registers() {
    unsigned low = 0;
    unsigned high = 0;
    __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
    return low;
}

[[gnu::constructor(101)]] void look() {
    unsigned a = 0;
    unsigned b = 0;
    unsigned c = 0;
    unsigned d = 0;
    if (__get_cpuid(1, &a, &b, &c, &d) == 0 || (c & bit_OSXSAVE) == 0) {
        return;
    }
    const unsigned saved = saved_registers();
    if ((saved & 0x6U) != 0x6U || __get_cpuid_count(7, 0, &a, &b, &c, &d) == 0) {
        return;
    }
    unsigned features = (b & bit_AVX2) != 0 ? has_avx2 : 0U;
    if ((saved & 0xe6U) == 0xe6U) {
        features |= (b & bit_AVX512F) != 0 ? has_avx512f : 0U;
        features |= (b & bit_AVX512DQ) != 0 ? has_avx512dq : 0U;
        features |= (b & bit_AVX512VL) != 0 ? has_avx512vl : 0U;
    }
    __cpu_model.features = features;
}

} // namespace
#endif
