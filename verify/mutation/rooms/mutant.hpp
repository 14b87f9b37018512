// Included first in every C++ file of a build with mutants: giveway_mutant(k) asks whether mutant k is chosen.
// GIVEWAY_MUTANT=k chooses one; GIVEWAY_MUTANTS_REACHED names a file with one byte per mutant, set when a program
// reaches it. Both are read once, when a program or library is loaded.
#pragma once
#ifdef __cplusplus

#include <fcntl.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace giveway_mutation
{

struct Choice {
    long number = 0;
    long count = 0;
    volatile unsigned char *reached = nullptr;

    Choice() noexcept
    {
        if (const char *chosen = getenv("GIVEWAY_MUTANT")) {
            number = atol(chosen);
        }
        const char *file = getenv("GIVEWAY_MUTANTS_REACHED");
        const int descriptor = file != nullptr ? open(file, O_RDWR) : -1;
        struct stat status {
        };
        if (descriptor >= 0 && fstat(descriptor, &status) == 0) {
            void *map =
                mmap(nullptr, static_cast<size_t>(status.st_size), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
            if (map != MAP_FAILED) {
                reached = static_cast<volatile unsigned char *>(map);
                count = status.st_size;
            }
            close(descriptor);
        }
    }
};

inline const Choice choice;

} // namespace giveway_mutation

// Not constexpr: a value that the compiler computes cannot be chosen at run time, so a mutant there does not compile.
inline bool giveway_mutant(long number) noexcept
{
    if (giveway_mutation::choice.reached != nullptr && number < giveway_mutation::choice.count) {
        giveway_mutation::choice.reached[number] = 1;
    }
    return giveway_mutation::choice.number == number;
}

#endif
