// The index hash table (Ghosh 2016, Figure 10): all transitions of all devices and groups.
//
// Both layouts offer the same: find a transition's slot, its maximum times, and its counters since
// the last check.
#ifndef INDEX_HASH_TABLE_H
#define INDEX_HASH_TABLE_H

#include <cstddef>
#include <cstdint>
#include <vector>

#include "probing.h"
#include "rules.h"

const std::size_t NO_SLOT = static_cast<std::size_t>(-1);

struct TimeEntry {
    double maximum_s;
    double sum_s;  // time counter, for the average transition time
    std::uint32_t count;
};

// As published: a transition with one time keeps its maximum in the fifth column, one with several
// keeps a pointer to an array there.
class PointerIndex {
  public:
    PointerIndex(std::size_t transitions, Probing probing);
    ~PointerIndex();

    std::size_t insert(std::uint64_t key, const std::vector<TimeCluster>& times);
    void finish() {}

    std::size_t find(std::uint64_t key, ProbeCounts& counts) const;
    std::size_t times(std::size_t slot) const { return rows_[slot].number; }
    double maximum_s(std::size_t slot, std::size_t time) const;
    void update(std::size_t slot, std::size_t time, double seconds);

    std::uint32_t count(std::size_t slot) const { return rows_[slot].count; }
    std::uint32_t time_count(std::size_t slot, std::size_t time) const;
    double time_sum_s(std::size_t slot, std::size_t time) const;
    void reset(std::size_t slot);
    std::size_t memory_bytes() const;

  private:
    PointerIndex(const PointerIndex&);
    PointerIndex& operator=(const PointerIndex&);

    // 8 + 1 + 4 + 8 + 8 bytes; the paper's record has 168 bits in all. Naturally aligned to 32
    // bytes, so that two lie in a cache line and none across two.
    struct Row {
        std::uint64_t key;
        union {
            double maximum_s;
            TimeEntry* times;
        };
        double sum_s;
        std::uint32_t count;
        std::uint8_t number;  // of transition times
    };

    Probing probing_;
    std::vector<Row> rows_;
};

// The "sequential index hash table": the fifth column is a structure of its own, built like Figure
// 8(b), a cumulative number per slot and one array of all times.
class SequentialIndex {
  public:
    SequentialIndex(std::size_t transitions, Probing probing);

    std::size_t insert(std::uint64_t key, const std::vector<TimeCluster>& times);
    // Lays the times out, once all transitions are in.
    void finish();

    std::size_t find(std::uint64_t key, ProbeCounts& counts) const;
    std::size_t times(std::size_t slot) const { return rows_[slot].number; }
    double maximum_s(std::size_t slot, std::size_t time) const {
        return entries_[first(slot) + time].maximum_s;
    }
    void update(std::size_t slot, std::size_t time, double seconds);

    std::uint32_t count(std::size_t slot) const { return rows_[slot].count; }
    std::uint32_t time_count(std::size_t slot, std::size_t time) const;
    double time_sum_s(std::size_t slot, std::size_t time) const;
    void reset(std::size_t slot);
    std::size_t memory_bytes() const;

  private:
    struct Row {
        std::uint64_t key;
        double sum_s;
        std::uint32_t count;
        std::uint8_t number;
    };

    std::size_t first(std::size_t slot) const { return slot == 0 ? 0 : ends_[slot - 1]; }

    Probing probing_;
    std::vector<Row> rows_;
    std::vector<std::uint32_t> ends_;
    std::vector<TimeEntry> entries_;
    std::vector<std::vector<double> > waiting_;  // maxima until `finish`
};

#endif
