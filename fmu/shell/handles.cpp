#include "handles.hpp"

#include <new>

namespace giveway {
namespace {

std::uintptr_t hide(void *object) { return ~reinterpret_cast<std::uintptr_t>(object); }
void *reveal(std::uintptr_t hidden) { return hidden == 0 ? nullptr : reinterpret_cast<void *>(~hidden); }

} // namespace

Handles::~Handles() {
    for (std::atomic<Slot *> &chunk : chunks_) {
        delete[] chunk.exchange(nullptr);
    }
}

// A handle is (generation << index_bits) | index, with a generation of at least 1, so no handle is null; each time that
// a slot is used again its generation grows.
Handles::Slot *Handles::slot(std::uintptr_t handle) const {
    const std::size_t index = handle & ((std::uintptr_t{1} << index_bits) - 1);
    Slot *chunk = chunks_[index >> chunk_bits].load(std::memory_order_acquire);
    if (chunk == nullptr) {
        return nullptr;
    }
    Slot *found = &chunk[index & (chunk_size - 1)];
    return found->handle.load(std::memory_order_acquire) == handle ? found : nullptr;
}

// The chunks live as long as the library: a handle may be asked for at any time.
std::size_t Handles::take_free_index() {
    if (first_free_ != 0) {
        const std::size_t index = first_free_ - 1;
        Slot *chunk = chunks_[index >> chunk_bits].load(std::memory_order_relaxed);
        first_free_ = chunk[index & (chunk_size - 1)].next_free;
        return index;
    }
    const std::size_t index = used_;
    if (index == chunk_size * chunk_count) {
        return index;
    }
    if ((index & (chunk_size - 1)) == 0) {
        Slot *chunk = new (std::nothrow) Slot[chunk_size];
        if (chunk == nullptr) {
            return chunk_size * chunk_count;
        }
        chunks_[index >> chunk_bits].store(chunk, std::memory_order_release);
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
    Slot &free = chunks_[index >> chunk_bits].load(std::memory_order_relaxed)[index & (chunk_size - 1)];
    constexpr std::uintptr_t one_generation = std::uintptr_t{1} << index_bits;
    std::uintptr_t handle = free.handle.load(std::memory_order_relaxed) + one_generation;
    if (handle < one_generation) {
        handle += one_generation; // the generations of a 32-bit machine come round after 4096
    }
    handle = (handle & ~(one_generation - 1)) | index;
    free.object.store(hide(object), std::memory_order_relaxed);
    free.handle.store(handle, std::memory_order_release);
    unlock();
    return reinterpret_cast<void *>(handle);
}

void *Handles::find(const void *handle) const {
    const Slot *found = slot(reinterpret_cast<std::uintptr_t>(handle));
    return found == nullptr ? nullptr : reveal(found->object.load(std::memory_order_relaxed));
}

void *Handles::remove(void *handle) {
    const auto number = reinterpret_cast<std::uintptr_t>(handle);
    lock();
    Slot *found = slot(number);
    void *object = found == nullptr ? nullptr : reveal(found->object.exchange(0, std::memory_order_relaxed));
    if (object != nullptr) {
        found->next_free = first_free_;
        first_free_ = (number & ((std::uintptr_t{1} << index_bits) - 1)) + 1;
    }
    unlock();
    return object;
}

} // namespace giveway
