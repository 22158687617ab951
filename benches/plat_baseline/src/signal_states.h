// The signal-states of a group's devices (Ghosh 2016, Figure 8).
#ifndef SIGNAL_STATES_H
#define SIGNAL_STATES_H

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "log.h"

// Figure 8(b): Device Array and signal-state array, both sorted, without pointers.
struct GroupStates {
    std::string group;
    std::vector<std::string> devices;      // first column of the Device Array
    std::vector<std::size_t> ends;         // second column: cumulative number of signal-states
    std::vector<std::string> states;       // the sorted signal-states of device after device

    std::size_t begin_of(std::size_t device) const { return device == 0 ? 0 : ends[device - 1]; }
    std::size_t size_of(std::size_t device) const { return ends[device] - begin_of(device); }
    // Position of a device's full name in the Device Array, by binary search.
    std::size_t device_position(const char* name, std::size_t length) const;
    // A signal-state's number within its device, by binary search.
    std::size_t state_number(std::size_t device, const std::string& state) const;
};

// All groups, sorted by name. Built by way of Figure 8(a).
std::vector<GroupStates> group_states(const SymbolList& symbols,
                                      const std::set<std::string>& words);

#endif
