// A saved FMU state: a header with its FMU and a checksum, then the bytes of instance and model.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

namespace giveway {

struct StateHeader {
    char magic[8];            // "GWSTATE"
    std::uint32_t version;    // of this header and what follows
    std::uint32_t byte_order; // 1, as this machine writes it
    std::uint64_t token;      // hash of the instantiation token: the variable table
    std::uint64_t size;       // of what follows the header
    std::uint64_t checksum;   // of what follows the header
};

struct SavedState {
    std::unique_ptr<unsigned char[]> bytes;
    std::size_t size = 0; // header included
};

// FNV-1a, 64 bits.
std::uint64_t checksum(const void *bytes, std::size_t size);

// Writes the header in front of `size` bytes that are already in place behind it.
void seal(unsigned char *bytes, std::size_t size);

// nullptr if the bytes are a complete state of this FMU, otherwise the fault.
const char *state_fault(const unsigned char *bytes, std::size_t size);

} // namespace giveway
