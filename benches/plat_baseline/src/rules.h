// The transition rules (Ghosh 2016, Table 2) and their file between the two phases.
#ifndef RULES_H
#define RULES_H

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "time_clusters.h"

// One transition of one device or group.
struct Rule {
    bool of_group;
    std::string group;
    std::string device;  // full name `Group-Device`; empty for a group
    std::string current;
    std::string next;
    std::size_t count;
    double probability;
    std::vector<TimeCluster> times;
    std::size_t position;      // of its first appearance among its model's transitions
    std::size_t first_record;  // row of the log that first showed it: the order of checking
};

struct DeviceStart {
    std::string device;
    std::string signal;
};

struct GroupStart {
    std::string group;
    std::string state;  // the first of its model: it closes a group cycle
};

struct RuleSet {
    std::vector<Rule> rules;
    std::vector<DeviceStart> devices;
    std::vector<GroupStart> groups;
    // Signals whose states are written NAME=VALUE.
    std::set<std::string> words() const;
};

void write_rules(const RuleSet& rules, const std::string& path);
RuleSet read_rules(const std::string& path);

#endif
