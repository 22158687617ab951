#include "learn.h"

#include <algorithm>

#include "names.h"
#include "signal_states.h"
#include "transition_model.h"

namespace {

// A group's records, and what is known of its devices once they were gone through in file order.
struct GroupRecords {
    std::vector<std::size_t> device_of;   // Device Array position of each of its records
    std::vector<std::size_t> record_of;   // and its row in the log
    std::vector<std::size_t> sorted;      // the rows, sorted by device, in time order within one
    std::vector<std::size_t> device_end;  // where each device's rows end in `sorted`
    std::vector<std::string> starting;    // the starting signal of each device
};

bool group_before(const GroupStates& states, const std::string& name) { return states.group < name; }

std::vector<GroupRecords> records_of_groups(const std::vector<Record>& records,
                                            const std::vector<GroupStates>& states) {
    std::vector<GroupRecords> groups(states.size());
    for (std::size_t g = 0; g < states.size(); ++g) {
        groups[g].starting.resize(states[g].devices.size());
        groups[g].device_end.assign(states[g].devices.size(), 0);
    }
    std::string name;
    for (std::size_t r = 0; r < records.size(); ++r) {
        if (!records[r].event) continue;
        const std::string& symbol = records[r].symbol;
        const NameParts parts = split_name(symbol);
        name.assign(symbol, 0, parts.group_length);
        const std::size_t g = static_cast<std::size_t>(
            std::lower_bound(states.begin(), states.end(), name, group_before) - states.begin());
        const std::size_t device = states[g].device_position(symbol.data(), parts.device_length);
        groups[g].device_of.push_back(device);
        groups[g].record_of.push_back(r);
        ++groups[g].device_end[device];
        if (groups[g].starting[device].empty()) groups[g].starting[device] = symbol;
    }
    return groups;
}

// "The log data records are sorted according to the device name of each group."
void sort_by_device(GroupRecords& group) {
    std::vector<std::size_t> next(group.device_end.size());
    std::size_t total = 0;
    for (std::size_t d = 0; d < next.size(); ++d) {
        next[d] = total;
        total += group.device_end[d];
        group.device_end[d] = total;
    }
    group.sorted.resize(total);
    for (std::size_t i = 0; i < total; ++i) {
        group.sorted[next[group.device_of[i]]++] = group.record_of[i];
    }
}

double seconds_between(const Record& before, const Record& after) {
    return static_cast<double>(after.time_ns - before.time_ns) / 1e9;
}

// Reads integer-represented signal-states back into their names.
struct StateNames {
    virtual ~StateNames() {}
    virtual std::string operator()(std::int32_t state) const = 0;
};

void add_rules(TransitionModel& model, const StateNames& name_of, const Rule& prototype,
               const Parameters& parameters, std::vector<Rule>& rules) {
    for (std::size_t t = 0; t < model.transitions().size(); ++t) {
        TransitionModel::Transition& transition = model.transitions()[t];
        Rule rule(prototype);
        rule.current = name_of(transition.current);
        rule.next = name_of(transition.next);
        rule.count = model.count(transition.current, transition.next);
        rule.probability =
            static_cast<double>(rule.count) / static_cast<double>(model.left(transition.current));
        rule.times = time_clusters(transition.times_s, parameters);
        rule.position = t;
        rule.first_record = transition.first_record;
        rules.push_back(rule);
    }
}

struct DeviceStateNames : StateNames {
    const GroupStates& states;
    std::size_t device;
    DeviceStateNames(const GroupStates& s, std::size_t d) : states(s), device(d) {}
    std::string operator()(std::int32_t state) const {
        return states.states[states.begin_of(device) + static_cast<std::size_t>(state)];
    }
};

void learn_device(const std::vector<Record>& records, const GroupStates& states,
                  const GroupRecords& group, std::size_t device, const Parameters& parameters,
                  std::vector<Rule>& rules) {
    TransitionModel model(states.size_of(device));
    std::string name;
    const Record* before = NULL;
    std::int32_t current = -1;
    for (std::size_t i = device == 0 ? 0 : group.device_end[device - 1];
         i < group.device_end[device]; ++i) {
        const Record& record = records[group.sorted[i]];
        state_name(record.symbol, record.word, record.value, name);
        const std::int32_t next = static_cast<std::int32_t>(states.state_number(device, name));
        if (before) model.add(current, next, seconds_between(*before, record), group.sorted[i]);
        before = &record;
        current = next;
    }
    Rule prototype = Rule();
    prototype.group = states.group;
    prototype.device = states.devices[device];
    add_rules(model, DeviceStateNames(states, device), prototype, parameters, rules);
}

// Equation (2): device position x 2 + status. Words widen the 2 to the most states of any starting
// signal, and their status is the value's rank.
struct GroupNumbering : StateNames {
    std::vector<std::vector<std::int64_t> > values;
    std::vector<bool> word;
    const std::vector<std::string>& starting;
    std::size_t width;

    GroupNumbering(const GroupRecords& group, const SymbolList& symbols,
                   const std::set<std::string>& words)
        : starting(group.starting), width(2) {
        for (std::size_t d = 0; d < starting.size(); ++d) {
            const std::set<std::int64_t>& seen = symbols.find(starting[d])->second;
            word.push_back(words.count(starting[d]) > 0);
            values.push_back(std::vector<std::int64_t>(seen.begin(), seen.end()));
            if (word[d]) width = std::max(width, values[d].size());
        }
    }
    std::int32_t number(std::size_t device, std::int64_t value) const {
        const std::vector<std::int64_t>& known = values[device];
        const std::size_t status =
            word[device] ? static_cast<std::size_t>(
                               std::lower_bound(known.begin(), known.end(), value) - known.begin())
                         : static_cast<std::size_t>(value);
        return static_cast<std::int32_t>(device * width + status);
    }
    std::string operator()(std::int32_t state) const {
        const std::size_t device = static_cast<std::size_t>(state) / width;
        const std::size_t status = static_cast<std::size_t>(state) % width;
        std::string name;
        state_name(starting[device], word[device],
                   word[device] ? values[device][status] : static_cast<std::int64_t>(status), name);
        return name;
    }
};

void learn_group(const std::vector<Record>& records, const GroupStates& states,
                 const GroupRecords& group, const GroupNumbering& numbering,
                 const Parameters& parameters, RuleSet& set) {
    TransitionModel model(states.devices.size() * numbering.width);
    const Record* before = NULL;
    std::int32_t current = -1;
    for (std::size_t i = 0; i < group.record_of.size(); ++i) {
        const Record& record = records[group.record_of[i]];
        if (record.symbol != group.starting[group.device_of[i]]) continue;
        const std::int32_t next = numbering.number(group.device_of[i], record.value);
        if (before) {
            model.add(current, next, seconds_between(*before, record), group.record_of[i]);
        } else {
            const GroupStart start = {states.group, numbering(next)};
            set.groups.push_back(start);
        }
        before = &record;
        current = next;
    }
    Rule prototype = Rule();
    prototype.of_group = true;
    prototype.group = states.group;
    add_rules(model, numbering, prototype, parameters, set.rules);
}

}  // namespace

RuleSet learn(const std::vector<Record>& records, const SymbolList& symbols,
              const Parameters& parameters) {
    std::set<std::string> words;
    for (std::size_t r = 0; r < records.size(); ++r) {
        if (records[r].word && records[r].event) words.insert(records[r].symbol);
    }
    const std::vector<GroupStates> states = group_states(symbols, words);
    std::vector<GroupRecords> groups = records_of_groups(records, states);
    RuleSet set;
    for (std::size_t g = 0; g < groups.size(); ++g) {
        sort_by_device(groups[g]);
        for (std::size_t d = 0; d < states[g].devices.size(); ++d) {
            const DeviceStart start = {states[g].devices[d], groups[g].starting[d]};
            set.devices.push_back(start);
            learn_device(records, states[g], groups[g], d, parameters, set.rules);
        }
        learn_group(records, states[g], groups[g],
                    GroupNumbering(groups[g], symbols, words), parameters, set);
    }
    return set;
}
