// Watching (Ghosh 2016, section 2.6).
#ifndef MONITOR_H
#define MONITOR_H

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "index_hash_table.h"
#include "log.h"
#include "name_hashes.h"
#include "names.h"
#include "rules.h"
#include "state_hash_tables.h"

struct Finding {
    std::size_t record;  // row of the log, counted from 1
    const char* kind;
    std::string from;
    std::string to;
    double observed;
    double limit;
};

struct Settings {
    Probing index_probing;
    Probing device_probing;
    std::int64_t stall_after_ns;
    unsigned check_every;  // group cycles
    double significant_change;
    Settings()
        : index_probing(DOUBLE_HASHING),
          device_probing(DOUBLE_HASHING),
          stall_after_ns(180000000000LL),
          check_every(30),
          significant_change(0.15) {}
};

// The user-defined threshold below Table 4.
inline double allowance_s(double maximum_s) {
    return maximum_s <= 15.0 ? 1.5 : maximum_s <= 30.0 ? 3.0 : 4.0;
}

template <class Index>
class Monitor {
  public:
    Monitor(const RuleSet& rules, std::uint32_t seed, const Settings& settings);

    void process(const Record& record, std::size_t number);

    const std::vector<Finding>& findings() const { return findings_; }
    ProbeCounts index_probes;
    ProbeCounts device_probes;
    ProbeCounts group_probes;
    std::size_t unknown_devices;

    // The three hash tables and the timers; the rules kept for checking are on file in the paper.
    std::size_t memory_bytes() const {
        return index_.memory_bytes() + devices_.memory_bytes() + groups_.memory_bytes() +
               timers_.size() * sizeof(Timer);
    }
    const StateHashTable<DeviceRow>& devices() const { return devices_; }
    const StateHashTable<GroupRow>& groups() const { return groups_; }
    // "Saved into the file system for the first identified transition error."
    const std::string& snapshot() const { return snapshot_; }

  private:
    // One per slot of the group hash table.
    struct Timer {
        std::int64_t last_ns;
        std::size_t last_device;  // its current state is the group's last observed one
        bool running;
        std::uint32_t starting_state;
        unsigned cycles;
        std::size_t group;  // in checked_
        Timer() : last_ns(0), last_device(0), running(false), starting_state(0), cycles(0), group(0) {}
    };
    struct CheckedRule {
        const Rule* rule;
        std::size_t slot;
        std::size_t branch;  // number of its current state within its group's check
    };
    struct CheckedGroup {
        std::vector<CheckedRule> rules;                  // in order of first appearance
        std::vector<std::vector<std::size_t> > branches;  // rules by current state
    };

    void step(CurrentState& current, bool of_group, std::uint32_t hash, const Record& record);
    void examine_timers(std::int64_t now_ns);
    void check(const CheckedGroup& group);
    void check_branch(const CheckedGroup& group, const CheckedRule& checked);
    void check_times(const CheckedRule& checked);
    void check_averages(const CheckedRule& checked);
    void report(const char* kind, const std::string& from, const std::string& to, double observed,
                double limit);
    void save_snapshot();
    void prepare_checks(const RuleSet& rules, const std::vector<std::size_t>& slots);

    std::uint32_t seed_;
    Settings settings_;
    Index index_;
    StateHashTable<DeviceRow> devices_;
    StateHashTable<GroupRow> groups_;
    std::vector<Timer> timers_;
    std::int64_t next_expiry_ns_;
    std::vector<CheckedGroup> checked_;
    std::vector<Finding> findings_;
    std::string snapshot_;
    std::string state_;  // the present record's signal-state name
    std::size_t number_;
};

template <class Index>
Monitor<Index>::Monitor(const RuleSet& set, std::uint32_t seed, const Settings& settings)
    : unknown_devices(0),
      seed_(seed),
      settings_(settings),
      index_(set.rules.size(), settings.index_probing),
      devices_(set.devices.size(), settings.device_probing),
      groups_(set.groups.size(), settings.device_probing),
      next_expiry_ns_(std::numeric_limits<std::int64_t>::max()),
      number_(0) {
    std::vector<std::size_t> slots;
    for (std::size_t i = 0; i < set.rules.size(); ++i) {
        const Rule& rule = set.rules[i];
        slots.push_back(index_.insert(
            transition_key(hash_name(rule.current, seed), hash_name(rule.next, seed), rule.of_group),
            rule.times));
    }
    index_.finish();
    for (std::size_t i = 0; i < set.devices.size(); ++i) {
        const std::size_t slot = devices_.insert(hash_name(set.devices[i].device, seed));
        devices_.row(slot).starting_signal = hash_name(set.devices[i].signal, seed);
    }
    timers_.resize(groups_.rows().size());
    for (std::size_t i = 0; i < set.groups.size(); ++i) {
        const std::size_t slot = groups_.insert(hash_name(set.groups[i].group, seed));
        timers_[slot].starting_state = hash_name(set.groups[i].state, seed);
        timers_[slot].group = i;
    }
    prepare_checks(set, slots);
}

inline bool appears_before(const Rule* a, const Rule* b) {
    return a->first_record != b->first_record ? a->first_record < b->first_record
                                              : a->of_group < b->of_group;
}

template <class Index>
void Monitor<Index>::prepare_checks(const RuleSet& set, const std::vector<std::size_t>& slots) {
    std::map<std::string, std::size_t> group_of;
    for (std::size_t i = 0; i < set.groups.size(); ++i) group_of[set.groups[i].group] = i;
    std::vector<const Rule*> order;
    for (std::size_t i = 0; i < set.rules.size(); ++i) order.push_back(&set.rules[i]);
    std::sort(order.begin(), order.end(), appears_before);
    checked_.resize(set.groups.size());
    std::map<std::pair<bool, std::string>, std::size_t> branch_of;
    for (std::size_t i = 0; i < order.size(); ++i) {
        const Rule* const rule = order[i];
        CheckedGroup& group = checked_[group_of[rule->group]];
        const std::pair<bool, std::string> from(rule->of_group, rule->current);
        if (branch_of.find(from) == branch_of.end()) {
            branch_of[from] = group.branches.size();
            group.branches.push_back(std::vector<std::size_t>());
        }
        const CheckedRule checked = {rule, slots[static_cast<std::size_t>(rule - &set.rules[0])],
                                     branch_of[from]};
        group.branches[checked.branch].push_back(group.rules.size());
        group.rules.push_back(checked);
    }
}

template <class Index>
void Monitor<Index>::process(const Record& record, std::size_t number) {
    number_ = number;
    if (record.time_ns >= next_expiry_ns_) examine_timers(record.time_ns);
    if (!record.event) return;
    state_name(record.symbol, record.word, record.value, state_);
    const NameParts parts = split_name(record.symbol);
    const char* const symbol = record.symbol.data();
    const std::size_t device_slot =
        devices_.find(murmur_hash_2(symbol, parts.device_length, seed_), device_probes);
    const std::size_t group_slot =
        groups_.find(murmur_hash_2(symbol, parts.group_length, seed_), group_probes);
    if (device_slot == NO_SLOT || group_slot == NO_SLOT) {
        ++unknown_devices;
        return;
    }
    Timer& timer = timers_[group_slot];
    timer.last_ns = record.time_ns;
    timer.last_device = device_slot;
    timer.running = true;
    next_expiry_ns_ = std::min(next_expiry_ns_, record.time_ns + settings_.stall_after_ns);

    const std::uint32_t hash = hash_name(state_, seed_);
    DeviceRow& device = devices_.row(device_slot);
    step(device.current, false, hash, record);
    if (device.starting_signal == hash_name(record.symbol, seed_)) {
        step(groups_.row(group_slot).current, true, hash, record);
        if (hash == timer.starting_state && ++timer.cycles % settings_.check_every == 0) {
            check(checked_[timer.group]);
        }
    }
}

// One device or group moves on to the present signal-state.
template <class Index>
void Monitor<Index>::step(CurrentState& current, bool of_group, std::uint32_t hash,
                          const Record& record) {
    if (current.hash != 0) {
        const double seconds =
            static_cast<double>(std::max<std::int64_t>(record.time_ns - current.time_ns, 0)) / 1e9;
        const std::size_t slot =
            index_.find(transition_key(current.hash, hash, of_group), index_probes);
        if (slot == NO_SLOT) {
            if (snapshot_.empty()) save_snapshot();
            report("transition", current.name, state_, seconds, 0.0);
        } else {
            // The maximum most similar to the query decides.
            std::size_t nearest = 0;
            double maximum_s = index_.maximum_s(slot, 0);
            for (std::size_t time = 1; time < index_.times(slot); ++time) {
                const double other_s = index_.maximum_s(slot, time);
                if (std::fabs(other_s - seconds) < std::fabs(maximum_s - seconds)) {
                    maximum_s = other_s;
                    nearest = time;
                }
            }
            const double limit_s = maximum_s + allowance_s(maximum_s);
            if (seconds > limit_s) {
                report("late", current.name, state_, seconds, limit_s);
            } else {
                index_.update(slot, nearest, seconds);
            }
        }
    }
    current.set(state_, hash, record.time_ns);
}

template <class Index>
void Monitor<Index>::examine_timers(std::int64_t now_ns) {
    next_expiry_ns_ = std::numeric_limits<std::int64_t>::max();
    for (std::size_t i = 0; i < timers_.size(); ++i) {
        Timer& timer = timers_[i];
        if (!timer.running) continue;
        const std::int64_t expiry_ns = timer.last_ns + settings_.stall_after_ns;
        if (expiry_ns <= now_ns) {
            timer.running = false;
            report("stall", devices_.row(timer.last_device).current.name, "",
                   static_cast<double>(now_ns - timer.last_ns) / 1e9,
                   static_cast<double>(settings_.stall_after_ns) / 1e9);
        } else {
            next_expiry_ns_ = std::min(next_expiry_ns_, expiry_ns);
        }
    }
}

template <class Index>
void Monitor<Index>::check(const CheckedGroup& group) {
    for (std::size_t i = 0; i < group.rules.size(); ++i) {
        const CheckedRule& checked = group.rules[i];
        if (group.branches[checked.branch][0] == i) check_branch(group, checked);
        check_times(checked);
        check_averages(checked);
    }
    for (std::size_t i = 0; i < group.rules.size(); ++i) index_.reset(group.rules[i].slot);
}

// The transitions out of one state; the one that changed most is reported.
template <class Index>
void Monitor<Index>::check_branch(const CheckedGroup& group, const CheckedRule& checked) {
    const std::vector<std::size_t>& branch = group.branches[checked.branch];
    double total = 0.0;
    for (std::size_t b = 0; b < branch.size(); ++b) {
        total += index_.count(group.rules[branch[b]].slot);
    }
    if (branch.size() < 2 || total == 0.0) return;
    double most = settings_.significant_change, observed = 0.0;
    const Rule* changed = NULL;
    for (std::size_t b = 0; b < branch.size(); ++b) {
        const CheckedRule& one = group.rules[branch[b]];
        const double share = index_.count(one.slot) / total;
        const double change = std::fabs(share - one.rule->probability);
        if (change > most) {
            most = change;
            observed = share;
            changed = one.rule;
        }
    }
    if (changed) {
        report("transition_probability", changed->current, changed->next, observed,
               changed->probability);
    }
}

template <class Index>
void Monitor<Index>::check_times(const CheckedRule& checked) {
    const std::vector<TimeCluster>& times = checked.rule->times;
    const double total = index_.count(checked.slot);
    if (times.size() < 2 || total == 0.0) return;
    for (std::size_t t = 0; t < times.size(); ++t) {
        const double share = index_.time_count(checked.slot, t) / total;
        if (std::fabs(share - times[t].probability) > settings_.significant_change) {
            report("time_probability", checked.rule->current, checked.rule->next, share,
                   times[t].probability);
            return;
        }
    }
}

template <class Index>
void Monitor<Index>::check_averages(const CheckedRule& checked) {
    const std::vector<TimeCluster>& times = checked.rule->times;
    for (std::size_t t = 0; t < times.size(); ++t) {
        const std::uint32_t count = index_.time_count(checked.slot, t);
        if (count == 0) continue;
        const double average_s = index_.time_sum_s(checked.slot, t) / count;
        if (std::fabs(average_s - times[t].average_s) > allowance_s(times[t].average_s)) {
            report("average_time", checked.rule->current, checked.rule->next, average_s,
                   times[t].average_s);
            return;
        }
    }
}

template <class Index>
void Monitor<Index>::report(const char* kind, const std::string& from, const std::string& to,
                            double observed, double limit) {
    const Finding finding = {number_, kind, from, to, observed, limit};
    findings_.push_back(finding);
}

template <class Index>
void Monitor<Index>::save_snapshot() {
    snapshot_ = "table\tcurrent\ttime_ns\n";
    for (std::size_t i = 0; i < devices_.rows().size(); ++i) {
        const CurrentState& current = devices_.rows()[i].current;
        if (current.hash == 0) continue;
        snapshot_ += "device\t" + current.name + "\t" + std::to_string(current.time_ns) + "\n";
    }
    for (std::size_t i = 0; i < groups_.rows().size(); ++i) {
        const CurrentState& current = groups_.rows()[i].current;
        if (current.hash == 0) continue;
        snapshot_ += "group\t" + current.name + "\t" + std::to_string(current.time_ns) + "\n";
    }
}

#endif
