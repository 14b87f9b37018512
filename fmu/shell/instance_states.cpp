// The whole state of an instance: saved, set, freed, as bytes and back.
#include "handles.hpp"
#include "instance.hpp"
#include "saved_state.hpp"
#include "state_archive.hpp"

#include <cstring>
#include <new>
#include <utility>

namespace giveway {
namespace {

// Of the saved states; one for all instances, which may take over each other's states.
Handles saved_states;

} // namespace

const SavedState *Instance::find_state(const char *function, const void *saved) {
    const auto *state = static_cast<const SavedState *>(saved_states.find(saved));
    if (state == nullptr) {
        refuse(function, saved == nullptr ? "the saved state is a null pointer"
                                          : "there is no such saved state, or it was freed");
    }
    return state;
}

bool Instance::get_state(const char *function, void **saved) {
    if (saved == nullptr) {
        return refuse(function, "the state's address is a null pointer");
    }
    StateWriter counter(nullptr);
    archive(counter);
    const std::size_t own = counter.size();
    const std::size_t size = own + model_->save_state(nullptr);
    std::unique_ptr<unsigned char[]> bytes(new (std::nothrow) unsigned char[sizeof(StateHeader) + size]);
    if (bytes == nullptr) {
        return refuse(function, "out of memory");
    }
    StateWriter writer(bytes.get() + sizeof(StateHeader));
    archive(writer);
    (void)model_->save_state(bytes.get() + sizeof(StateHeader) + own);
    seal(bytes.get(), size);
    return keep_state(function, std::move(bytes), sizeof(StateHeader) + size, saved);
}

// Fills the state that *saved stands for, or a new one if that is null or was never one: some importers leave the
// pointer uninitialised.
bool Instance::keep_state(const char *function, std::unique_ptr<unsigned char[]> bytes, std::size_t size,
                          void **saved) {
    if (saved_states.was_given_out(*saved)) {
        auto *old = static_cast<SavedState *>(saved_states.find(*saved));
        if (old == nullptr) {
            return refuse(function, "there is no such saved state to fill, or it was freed");
        }
        *old = SavedState{std::move(bytes), size};
        return true;
    }
    std::unique_ptr<SavedState> state(new (std::nothrow) SavedState{std::move(bytes), size});
    void *handle = state == nullptr ? nullptr : saved_states.add(state.get());
    if (handle == nullptr) {
        return refuse(function, "out of memory");
    }
    (void)state.release(); // the handle's
    *saved = handle;
    return true;
}

bool Instance::set_state(const char *function, const void *saved) {
    const SavedState *state = find_state(function, saved);
    if (state == nullptr) {
        return false;
    }
    StateWriter counter(nullptr);
    archive(counter);
    const std::size_t own = counter.size();
    if (state->size < sizeof(StateHeader) + own) {
        return refuse(function, "the saved state is too short for this FMU");
    }
    const Interface interface = interface_;
    StateReader reader(state->bytes.get() + sizeof(StateHeader), own);
    archive(reader);
    if (interface_ != interface) {
        interface_ = interface;
        state_ = State::failed;
        return refuse(function, "the state was saved by an instance of the other interface "
                                "(Co-Simulation, Model Exchange)");
    }
    Message message{};
    const std::size_t before = sizeof(StateHeader) + own;
    if (model_->load_state(state->bytes.get() + before, state->size - before, message) != Status::ok) {
        return fail(function, message);
    }
    return true;
}

bool Instance::free_state(const char *function, void **saved) {
    if (saved_states.was_given_out(saved)) {
        return refuse(function, "this is the saved state itself, but must be the address of where it is kept");
    }
    if (saved == nullptr || *saved == nullptr) {
        return true; // nothing to free, as the standard has it
    }
    auto *state = static_cast<SavedState *>(saved_states.remove(*saved));
    if (state == nullptr) {
        return refuse(function, "there is no such saved state, or it was freed");
    }
    delete state;
    *saved = nullptr;
    return true;
}

bool Instance::serialised_size(const char *function, const void *saved, std::size_t *size) {
    const SavedState *state = find_state(function, saved);
    if (state == nullptr) {
        return false;
    }
    if (size == nullptr) {
        return refuse(function, "the size is a null pointer");
    }
    *size = state->size;
    return true;
}

bool Instance::serialise(const char *function, const void *saved, unsigned char *bytes, std::size_t size) {
    const SavedState *state = find_state(function, saved);
    if (state == nullptr) {
        return false;
    }
    if (bytes == nullptr) {
        return refuse(function, "the bytes are a null pointer");
    }
    if (size < state->size) {
        return refuse(function, "room for %zu bytes, but the state has %zu", size, state->size);
    }
    std::memcpy(bytes, state->bytes.get(), state->size);
    return true;
}

bool Instance::deserialise(const char *function, const unsigned char *bytes, std::size_t size, void **saved) {
    if (saved == nullptr) {
        return refuse(function, "the state's address is a null pointer");
    }
    const char *fault = state_fault(bytes, size);
    if (fault != nullptr) {
        return refuse(function, "the state cannot be used: %s", fault);
    }
    std::unique_ptr<unsigned char[]> copy(new (std::nothrow) unsigned char[size]);
    if (copy == nullptr) {
        return refuse(function, "out of memory");
    }
    std::memcpy(copy.get(), bytes, size);
    *saved = nullptr; // an importer need not have set it
    return keep_state(function, std::move(copy), size, saved);
}

} // namespace giveway
