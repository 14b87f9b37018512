// The part of the C++ runtime that an FMU needs, so that its binary is linked without one: heap memory that is asked
// for without exceptions. Private to the binary. Where a C++ library is linked (tests, sources of an FMU compiled by an
// importer), this file is left out.
#include <cstdlib>
#include <new>

namespace std {
const nothrow_t nothrow{};
}

void *operator new(std::size_t size, const std::nothrow_t &) noexcept { return std::malloc(size); }
void *operator new[](std::size_t size, const std::nothrow_t &) noexcept { return std::malloc(size); }
void operator delete(void *memory) noexcept { std::free(memory); }
void operator delete(void *memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void *memory) noexcept { std::free(memory); }
void operator delete[](void *memory, std::size_t) noexcept { std::free(memory); }

// Called for a virtual function without a body, which only happens if an object is used after it was freed.
extern "C" [[noreturn]] void __cxa_pure_virtual() { std::abort(); }
