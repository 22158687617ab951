// MurmurHash2, 32 bits (Austin Appleby, public domain): the paper's hash of every name.
#ifndef MURMUR_HASH_2_H
#define MURMUR_HASH_2_H

#include <cstddef>
#include <cstdint>

std::uint32_t murmur_hash_2(const char* bytes, std::size_t length, std::uint32_t seed);

#endif
