// Hash values of names and of transitions (Ghosh 2016, section 2.5).
#ifndef NAME_HASHES_H
#define NAME_HASHES_H

#include <cstddef>
#include <cstdint>
#include <string>

#include "murmur_hash_2.h"
#include "rules.h"

inline std::uint32_t hash_name(const std::string& name, std::uint32_t seed) {
    return murmur_hash_2(name.data(), name.size(), seed);
}

// The concatenation of the hash values of two signal-state names. A transition between two states
// of a starting signal can belong to its device and to its group; the paper keeps both in one table
// and says nothing of it. A group's keys are told apart by flipping bits.
inline std::uint64_t transition_key(std::uint32_t current, std::uint32_t next, bool of_group) {
    const std::uint64_t key = static_cast<std::uint64_t>(current) << 32 | next;
    return of_group ? ~key : key;
}

// The first seed from 0 for which no two names of a kind, and no two transitions, share a hash
// value, and none is 0 (which means null): "no hash code collision occurs".
std::uint32_t collision_free_seed(const RuleSet& rules);

#endif
