#include "handles.hpp"

#include <new>

namespace giveway {
namespace {

std::uintptr_t hide(void *object) { return ~reinterpret_cast<std::uintptr_t>(object); }
void *reveal(std::uintptr_t hidden) { return hidden == 0 ? nullptr : reinterpret_cast<void *>(~hidden); }

} // namespace

Handles::Slot *Handles::slot(std::size_t index) {
    Slot *chunk = index < chunk_size ? first_ : further_[index >> chunk_bits];
    return chunk == nullptr ? nullptr : &chunk[index & (chunk_size - 1)];
}

// A handle is generation, index and a bit that is set, from high to low. The generation is at least 1, and that of
// every handle that is given out is the next one.
void *Handles::object_of(std::uintptr_t handle) {
    const Slot *found = slot(index_of(handle));
    if (found == nullptr || found->handle.load(std::memory_order_acquire) != handle) {
        return nullptr;
    }
    return reveal(found->object.load(std::memory_order_relaxed));
}

std::size_t Handles::take_free_index() {
    if (first_free_ != 0) {
        const std::size_t index = first_free_ - 1;
        first_free_ = slot(index)->next_free;
        return index;
    }
    const std::size_t index = used_;
    if (index == chunk_size * chunk_count) {
        return index;
    }
    if (slot(index) == nullptr) {
        Slot *chunk = new (std::nothrow) Slot[chunk_size];
        if (chunk == nullptr) {
            return chunk_size * chunk_count;
        }
        further_[index >> chunk_bits] = chunk;
    }
    ++used_;
    return index;
}

void *Handles::add(void *object) {
    lock();
    const std::size_t index = take_free_index();
    if (index == chunk_size * chunk_count) {
        unlock();
        return nullptr;
    }
    last_ += one_generation;
    if (last_ == 0) {
        last_ = one_generation; // the generations of a 32-bit machine come round after 2047
    }
    const std::uintptr_t handle = last_ | (index << 1) | 1;
    Slot &free = *slot(index);
    free.object.store(hide(object), std::memory_order_relaxed);
    free.handle.store(handle, std::memory_order_release);
    ++alive_;
    unlock();
    return reinterpret_cast<void *>(handle);
}

// The first chunk is always there. Others come and go, so nobody reads them without the lock.
void *Handles::find(const void *handle) {
    const auto number = reinterpret_cast<std::uintptr_t>(handle);
    if (index_of(number) < chunk_size) {
        return object_of(number);
    }
    lock();
    void *object = object_of(number);
    unlock();
    return object;
}

bool Handles::was_given_out(const void *handle) {
    const auto number = reinterpret_cast<std::uintptr_t>(handle);
    lock();
    const std::uintptr_t last = last_;
    unlock();
    return (number & 1) != 0 && number >= one_generation && number < last + one_generation;
}

void *Handles::remove(void *handle) {
    const auto number = reinterpret_cast<std::uintptr_t>(handle);
    lock();
    void *object = object_of(number);
    if (object != nullptr) {
        Slot &freed = *slot(index_of(number));
        freed.object.store(0, std::memory_order_relaxed);
        freed.next_free = first_free_;
        first_free_ = index_of(number) + 1;
        if (--alive_ == 0 && used_ > chunk_size) {
            give_memory_back();
        }
    }
    unlock();
    return object;
}

void Handles::give_memory_back() {
    for (Slot *&chunk : further_) {
        delete[] chunk;
        chunk = nullptr;
    }
    used_ = 0;
    first_free_ = 0;
}

} // namespace giveway
