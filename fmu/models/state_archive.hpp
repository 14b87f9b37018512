// A model's state as bytes without pointers. A class lists its members once, in `template <class Archive> void
// archive(Archive&)`; the same list counts, writes and reads.
#pragma once

#include <cstddef>
#include <cstdio>
#include <cstring>
#include <type_traits>

#include "model.hpp"

namespace giveway {

// Counts, and writes unless `bytes` is null.
class StateWriter {
public:
    explicit StateWriter(void *bytes) : bytes_(static_cast<unsigned char *>(bytes)) {}

    template <class T> void operator()(T &value) {
        static_assert(std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>);
        array(&value, 1);
    }
    template <class T> void array(T *values, std::size_t count) {
        if (bytes_ != nullptr) {
            std::memcpy(bytes_ + size_, values, count * sizeof(T));
        }
        size_ += count * sizeof(T);
    }
    [[nodiscard]] std::size_t size() const { return size_; }

private:
    unsigned char *bytes_;
    std::size_t size_ = 0;
};

// Reads; if the bytes do not suffice it changes nothing any more.
class StateReader {
public:
    StateReader(const void *bytes, std::size_t size) : bytes_(static_cast<const unsigned char *>(bytes)), left_(size) {}

    template <class T> void operator()(T &value) {
        static_assert(std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>);
        array(&value, 1);
    }
    template <class T> void array(T *values, std::size_t count) {
        const std::size_t size = count * sizeof(T);
        sufficed_ = sufficed_ && size <= left_;
        if (sufficed_) {
            std::memcpy(values, bytes_, size);
            bytes_ += size;
            left_ -= size;
        }
    }
    // Every byte was used, and there were enough.
    [[nodiscard]] bool exact() const { return sufficed_ && left_ == 0; }

private:
    const unsigned char *bytes_;
    std::size_t left_;
    bool sufficed_ = true;
};

// Message and status for an unsuitable state are the same for every model.
template <class M> std::size_t save_archive(M &model, void *bytes) {
    StateWriter writer(bytes);
    model.archive(writer);
    return writer.size();
}

template <class M> Status load_archive(M &model, const void *bytes, std::size_t size, Message &message) {
    StateReader reader(bytes, size);
    model.archive(reader);
    if (!reader.exact()) {
        std::snprintf(message.text, sizeof message.text, "the state is not one of this build");
        return Status::error;
    }
    return Status::ok;
}

} // namespace giveway
