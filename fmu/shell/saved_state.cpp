#include "saved_state.hpp"

#include "model.hpp"

#include <cstring>

namespace giveway {
namespace {

constexpr char magic[8] = "GWSTATE";
constexpr std::uint32_t version = 1;
constexpr std::uint32_t byte_order = 1;

std::uint64_t token_hash() {
    const char *token = model_info().token;
    return checksum(token, std::strlen(token));
}

} // namespace

std::uint64_t checksum(const void *bytes, std::size_t size) {
    const auto *byte = static_cast<const unsigned char *>(bytes);
    std::uint64_t hash = 0xcbf29ce484222325ull;
    for (std::size_t i = 0; i < size; ++i) {
        hash = (hash ^ byte[i]) * 0x100000001b3ull;
    }
    return hash;
}

void seal(unsigned char *bytes, std::size_t size) {
    StateHeader header{};
    std::memcpy(header.magic, magic, sizeof magic);
    header.version = version;
    header.byte_order = byte_order;
    header.token = token_hash();
    header.size = size;
    header.checksum = checksum(bytes + sizeof header, size);
    std::memcpy(bytes, &header, sizeof header);
}

const char *state_fault(const unsigned char *bytes, std::size_t size) {
    StateHeader header{};
    if (bytes == nullptr || size < sizeof header) {
        return "it is shorter than its header";
    }
    std::memcpy(&header, bytes, sizeof header);
    if (std::memcmp(header.magic, magic, sizeof magic) != 0) {
        return "it is not a saved state of giveway";
    }
    if (header.version != version || header.byte_order != byte_order) {
        return "it was saved by another version, or on a machine with another byte order";
    }
    if (header.token != token_hash()) {
        return "it was saved by another FMU or another build of it (tokens differ)";
    }
    if (header.size != size - sizeof header) {
        return "it is truncated, or something was added to it";
    }
    if (header.checksum != checksum(bytes + sizeof header, size - sizeof header)) {
        return "it was altered (checksums differ)";
    }
    return nullptr;
}

} // namespace giveway
