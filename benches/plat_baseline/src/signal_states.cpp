#include "signal_states.h"

#include <algorithm>

#include "names.h"

namespace {

// Figure 8(a): one row per device, its signal-states through a pointer to an array.
typedef std::map<std::string, std::vector<std::string>*> PointerRows;

GroupStates sequential(const std::string& group, const PointerRows& rows) {
    GroupStates converted;
    converted.group = group;
    for (PointerRows::const_iterator row = rows.begin(); row != rows.end(); ++row) {
        std::vector<std::string>& states = *row->second;
        std::sort(states.begin(), states.end());
        converted.devices.push_back(row->first);
        converted.states.insert(converted.states.end(), states.begin(), states.end());
        converted.ends.push_back(converted.states.size());
    }
    return converted;
}

}  // namespace

std::size_t GroupStates::device_position(const char* name, std::size_t length) const {
    std::size_t low = 0, high = devices.size();
    while (low < high) {
        const std::size_t middle = (low + high) / 2;
        if (devices[middle].compare(0, std::string::npos, name, length) < 0) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

std::size_t GroupStates::state_number(std::size_t device, const std::string& state) const {
    std::size_t low = begin_of(device), high = ends[device];
    while (low < high) {
        const std::size_t middle = (low + high) / 2;
        if (states[middle] < state) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low - begin_of(device);
}

std::vector<GroupStates> group_states(const SymbolList& symbols,
                                      const std::set<std::string>& words) {
    std::map<std::string, PointerRows> groups;
    std::string name;
    for (SymbolList::const_iterator symbol = symbols.begin(); symbol != symbols.end(); ++symbol) {
        const NameParts parts = split_name(symbol->first);
        std::vector<std::string>*& states = groups[symbol->first.substr(0, parts.group_length)]
                                                  [symbol->first.substr(0, parts.device_length)];
        if (!states) states = new std::vector<std::string>();
        const bool word = words.count(symbol->first) > 0;
        for (std::set<std::int64_t>::const_iterator value = symbol->second.begin();
             value != symbol->second.end(); ++value) {
            state_name(symbol->first, word, *value, name);
            states->push_back(name);
        }
    }
    std::vector<GroupStates> converted;
    for (std::map<std::string, PointerRows>::iterator group = groups.begin();
         group != groups.end(); ++group) {
        converted.push_back(sequential(group->first, group->second));
        for (PointerRows::iterator row = group->second.begin(); row != group->second.end(); ++row) {
            delete row->second;
        }
    }
    return converted;
}
