#include "index_hash_table.h"

namespace {

const std::uint64_t EMPTY = 0;

template <class Row>
std::size_t free_slot(const std::vector<Row>& rows, std::uint64_t key, Probing probing) {
    ProbeSequence sequence(key, rows.size(), probing);
    while (rows[sequence.slot].key != EMPTY) sequence.advance();
    return static_cast<std::size_t>(sequence.slot);
}

template <class Row>
std::size_t find_slot(const std::vector<Row>& rows, std::uint64_t key, Probing probing,
                      ProbeCounts& counts) {
    ++counts.queries;
    ++counts.probes;
    ProbeSequence sequence(key, rows.size(), probing);
    while (rows[sequence.slot].key != key) {
        if (rows[sequence.slot].key == EMPTY) return NO_SLOT;
        sequence.advance();
        ++counts.probes;
    }
    return static_cast<std::size_t>(sequence.slot);
}

TimeEntry fresh_entry(double maximum_s) {
    const TimeEntry entry = {maximum_s, 0.0, 0};
    return entry;
}

}  // namespace

PointerIndex::PointerIndex(std::size_t transitions, Probing probing) : probing_(probing) {
    Row empty = Row();
    empty.key = EMPTY;
    rows_.assign(table_size(transitions), empty);
}

PointerIndex::~PointerIndex() {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        if (rows_[i].number > 1) delete[] rows_[i].times;
    }
}

std::size_t PointerIndex::insert(std::uint64_t key, const std::vector<TimeCluster>& times) {
    const std::size_t slot = free_slot(rows_, key, probing_);
    Row& row = rows_[slot];
    row.key = key;
    row.number = static_cast<std::uint8_t>(times.size());
    if (times.size() == 1) {
        row.maximum_s = times[0].maximum_s;
    } else {
        row.times = new TimeEntry[times.size()];
        for (std::size_t t = 0; t < times.size(); ++t) {
            row.times[t] = fresh_entry(times[t].maximum_s);
        }
    }
    return slot;
}

std::size_t PointerIndex::find(std::uint64_t key, ProbeCounts& counts) const {
    return find_slot(rows_, key, probing_, counts);
}

double PointerIndex::maximum_s(std::size_t slot, std::size_t time) const {
    const Row& row = rows_[slot];
    return row.number == 1 ? row.maximum_s : row.times[time].maximum_s;
}

void PointerIndex::update(std::size_t slot, std::size_t time, double seconds) {
    Row& row = rows_[slot];
    ++row.count;
    row.sum_s += seconds;
    if (row.number == 1) return;
    ++row.times[time].count;
    // "Time counter ... is not needed for the first transition time": it is what is left.
    if (time > 0) row.times[time].sum_s += seconds;
}

std::uint32_t PointerIndex::time_count(std::size_t slot, std::size_t time) const {
    const Row& row = rows_[slot];
    return row.number == 1 ? row.count : row.times[time].count;
}

double PointerIndex::time_sum_s(std::size_t slot, std::size_t time) const {
    const Row& row = rows_[slot];
    if (time > 0) return row.times[time].sum_s;
    double first = row.sum_s;
    for (std::size_t t = 1; t < row.number; ++t) first -= row.times[t].sum_s;
    return first;
}

void PointerIndex::reset(std::size_t slot) {
    Row& row = rows_[slot];
    row.count = 0;
    row.sum_s = 0.0;
    for (std::size_t t = 0; row.number > 1 && t < row.number; ++t) {
        row.times[t].count = 0;
        row.times[t].sum_s = 0.0;
    }
}

std::size_t PointerIndex::memory_bytes() const {
    std::size_t bytes = rows_.size() * sizeof(Row);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        if (rows_[i].number > 1) bytes += rows_[i].number * sizeof(TimeEntry);
    }
    return bytes;
}

SequentialIndex::SequentialIndex(std::size_t transitions, Probing probing) : probing_(probing) {
    Row empty = Row();
    empty.key = EMPTY;
    rows_.assign(table_size(transitions), empty);
    waiting_.resize(rows_.size());
}

std::size_t SequentialIndex::insert(std::uint64_t key, const std::vector<TimeCluster>& times) {
    const std::size_t slot = free_slot(rows_, key, probing_);
    rows_[slot].key = key;
    rows_[slot].number = static_cast<std::uint8_t>(times.size());
    for (std::size_t t = 0; t < times.size(); ++t) waiting_[slot].push_back(times[t].maximum_s);
    return slot;
}

void SequentialIndex::finish() {
    for (std::size_t slot = 0; slot < rows_.size(); ++slot) {
        for (std::size_t t = 0; t < waiting_[slot].size(); ++t) {
            entries_.push_back(fresh_entry(waiting_[slot][t]));
        }
        ends_.push_back(static_cast<std::uint32_t>(entries_.size()));
    }
    std::vector<std::vector<double> >().swap(waiting_);
}

std::size_t SequentialIndex::find(std::uint64_t key, ProbeCounts& counts) const {
    return find_slot(rows_, key, probing_, counts);
}

void SequentialIndex::update(std::size_t slot, std::size_t time, double seconds) {
    Row& row = rows_[slot];
    ++row.count;
    row.sum_s += seconds;
    if (row.number == 1) return;
    TimeEntry& entry = entries_[first(slot) + time];
    ++entry.count;
    if (time > 0) entry.sum_s += seconds;
}

std::uint32_t SequentialIndex::time_count(std::size_t slot, std::size_t time) const {
    return rows_[slot].number == 1 ? rows_[slot].count : entries_[first(slot) + time].count;
}

double SequentialIndex::time_sum_s(std::size_t slot, std::size_t time) const {
    if (time > 0) return entries_[first(slot) + time].sum_s;
    double sum_s = rows_[slot].sum_s;
    for (std::size_t t = 1; t < rows_[slot].number; ++t) sum_s -= entries_[first(slot) + t].sum_s;
    return sum_s;
}

void SequentialIndex::reset(std::size_t slot) {
    rows_[slot].count = 0;
    rows_[slot].sum_s = 0.0;
    for (std::size_t e = first(slot); e < ends_[slot]; ++e) {
        entries_[e].count = 0;
        entries_[e].sum_s = 0.0;
    }
}

std::size_t SequentialIndex::memory_bytes() const {
    return rows_.size() * sizeof(Row) + ends_.size() * sizeof ends_[0] +
           entries_.size() * sizeof(TimeEntry);
}
