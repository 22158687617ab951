// Open addressing (Ghosh 2016, section 2.5): table sizes and the two ways of probing.
#ifndef PROBING_H
#define PROBING_H

#include <cstddef>
#include <cstdint>

const double LOAD_FACTOR = 0.6;

// The prime closest to entries / 0.6 (section 3.2).
std::size_t table_size(std::size_t entries);

enum Probing { DOUBLE_HASHING, LINEAR_PROBING };

// What was asked and how many slots were looked at, as in Figures 16, 19 and 21.
struct ProbeCounts {
    std::uint64_t queries;
    std::uint64_t probes;
    ProbeCounts() : queries(0), probes(0) {}
};

// The slots a key may lie in, in order. Double hashing is that of C# 2.0's Hashtable.
struct ProbeSequence {
    std::uint64_t slot;
    std::uint64_t step;
    std::uint64_t size;

    ProbeSequence(std::uint64_t key, std::uint64_t table, Probing probing)
        : slot(key % table),
          step(probing == LINEAR_PROBING ? 1 : 1 + ((key >> 5) + 1) % (table - 1)),
          size(table) {}

    void advance() {
        slot += step;
        if (slot >= size) slot -= size;
    }
};

#endif
