#include "murmur_hash_2.h"

#include <cstring>

std::uint32_t murmur_hash_2(const char* bytes, std::size_t length, std::uint32_t seed) {
    const std::uint32_t m = 0x5bd1e995;
    const int r = 24;
    std::uint32_t hash = seed ^ static_cast<std::uint32_t>(length);
    while (length >= 4) {
        std::uint32_t k;
        std::memcpy(&k, bytes, sizeof k);
        k *= m;
        k ^= k >> r;
        k *= m;
        hash *= m;
        hash ^= k;
        bytes += 4;
        length -= 4;
    }
    if (length >= 3) hash ^= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[2])) << 16;
    if (length >= 2) hash ^= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[1])) << 8;
    if (length >= 1) {
        hash ^= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[0]));
        hash *= m;
    }
    hash ^= hash >> 13;
    hash *= m;
    hash ^= hash >> 15;
    return hash;
}
