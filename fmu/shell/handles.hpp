// Handles that importers get instead of pointers, so that a freed or invalid handle is noticed and not dereferenced.
//
// Making, finding and freeing may happen in several threads at once; finding one of the first thousand takes no lock.
//
// A table is a static object that needs no destructor: a destructor at exit needs start files in the shared library
// that run it when the library is unloaded, and not every linker brings them. An empty table uses no heap memory.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace giveway {

class Handles {
public:
    constexpr Handles() = default;
    ~Handles() = default; // trivial: see above
    Handles(const Handles &) = delete;
    Handles &operator=(const Handles &) = delete;

    // A handle for `object` (not null); null when out of memory or with a million objects alive.
    void *add(void *object);

    // The object; null if the handle was freed, or was never given out.
    void *find(const void *handle);

    // Whether it is the number of a present or former handle. The address of a pointer is hardly ever one, as it is
    // even.
    bool was_given_out(const void *handle);

    // Frees the handle and gives the object back, to one caller only; null as above.
    void *remove(void *handle);

private:
    static constexpr unsigned chunk_bits = 10;
    static constexpr unsigned index_bits = 20;
    static constexpr std::size_t chunk_size = std::size_t{1} << chunk_bits;
    static constexpr std::size_t chunk_count = std::size_t{1} << (index_bits - chunk_bits);

    struct Slot {
        // The complement of the object's address, 0 if there is none, so that a leak checker does not treat the table
        // as an owner.
        std::atomic<std::uintptr_t> object{0};
        std::atomic<std::uintptr_t> handle{0}; // of the object that is, or was last, in this slot
        std::size_t next_free = 0;             // index + 1; 0: none
    };

    static constexpr std::uintptr_t one_generation = std::uintptr_t{2} << index_bits;

    static std::size_t index_of(std::uintptr_t handle) { return (handle & (one_generation - 1)) >> 1; }
    // Null if there is no such slot (any more).
    Slot *slot(std::size_t index);
    void *object_of(std::uintptr_t handle);
    std::size_t take_free_index();
    void give_memory_back();
    void lock() {
        while (busy_.test_and_set(std::memory_order_acquire)) {
        }
    }
    void unlock() { busy_.clear(std::memory_order_release); }

    Slot first_[chunk_size] = {};
    Slot *further_[chunk_count] = {}; // from the heap, until the table is empty again; the first place is not used
    std::atomic_flag busy_ = ATOMIC_FLAG_INIT;
    std::uintptr_t last_ = 0; // the generation of the last handle
    std::size_t alive_ = 0;
    std::size_t used_ = 0;       // slots that were used since the table was empty
    std::size_t first_free_ = 0; // index + 1
};

} // namespace giveway
