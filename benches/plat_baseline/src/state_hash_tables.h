// The device hash table and the group hash table (Ghosh 2016, Figure 11).
#ifndef STATE_HASH_TABLES_H
#define STATE_HASH_TABLES_H

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "index_hash_table.h"
#include "probing.h"

// The last columns of both tables: what was last seen of a device or group. The hash value is kept
// beside the name, so that a state's name is hashed once and not twice.
struct CurrentState {
    std::string name;
    std::uint32_t hash;  // 0 is null
    std::int64_t time_ns;
    CurrentState() : hash(0), time_ns(0) {}
    void set(const std::string& state, std::uint32_t state_hash, std::int64_t now_ns) {
        name.assign(state);
        hash = state_hash;
        time_ns = now_ns;
    }
};

struct DeviceRow {
    std::uint32_t key;
    std::uint32_t starting_signal;
    CurrentState current;
    DeviceRow() : key(0), starting_signal(0) {}
};

struct GroupRow {
    std::uint32_t key;
    CurrentState current;
    GroupRow() : key(0) {}
};

template <class Row>
class StateHashTable {
  public:
    StateHashTable(std::size_t entries, Probing probing)
        : probing_(probing), rows_(table_size(entries)) {}

    std::size_t insert(std::uint32_t key) {
        ProbeSequence sequence(key, rows_.size(), probing_);
        while (rows_[sequence.slot].key != 0) sequence.advance();
        rows_[sequence.slot].key = key;
        return static_cast<std::size_t>(sequence.slot);
    }

    std::size_t find(std::uint32_t key, ProbeCounts& counts) const {
        ++counts.queries;
        ++counts.probes;
        ProbeSequence sequence(key, rows_.size(), probing_);
        while (rows_[sequence.slot].key != key) {
            if (rows_[sequence.slot].key == 0) return NO_SLOT;
            sequence.advance();
            ++counts.probes;
        }
        return static_cast<std::size_t>(sequence.slot);
    }

    Row& row(std::size_t slot) { return rows_[slot]; }
    const std::vector<Row>& rows() const { return rows_; }

    std::size_t memory_bytes() const {
        std::size_t bytes = rows_.size() * sizeof(Row);
        const std::size_t within = std::string().capacity();
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            const std::size_t capacity = rows_[i].current.name.capacity();
            if (capacity > within) bytes += capacity + 1;
        }
        return bytes;
    }

  private:
    Probing probing_;
    std::vector<Row> rows_;
};

#endif
