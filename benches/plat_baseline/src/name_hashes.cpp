#include "name_hashes.h"

#include <algorithm>
#include <set>
#include <vector>

namespace {

typedef std::set<std::string> Names;

bool collide(const Names& names, std::uint32_t seed) {
    std::vector<std::uint32_t> hashes;
    for (Names::const_iterator name = names.begin(); name != names.end(); ++name) {
        hashes.push_back(hash_name(*name, seed));
    }
    std::sort(hashes.begin(), hashes.end());
    return (!hashes.empty() && hashes[0] == 0) ||
           std::adjacent_find(hashes.begin(), hashes.end()) != hashes.end();
}

bool keys_collide(const std::vector<Rule>& rules, std::uint32_t seed) {
    std::vector<std::uint64_t> keys;
    for (std::size_t i = 0; i < rules.size(); ++i) {
        keys.push_back(transition_key(hash_name(rules[i].current, seed),
                                      hash_name(rules[i].next, seed), rules[i].of_group));
    }
    std::sort(keys.begin(), keys.end());
    return (!keys.empty() && keys[0] == 0) ||
           std::adjacent_find(keys.begin(), keys.end()) != keys.end();
}

}  // namespace

std::uint32_t collision_free_seed(const RuleSet& set) {
    Names states, signals, devices, groups;
    for (std::size_t i = 0; i < set.rules.size(); ++i) {
        const Rule& rule = set.rules[i];
        states.insert(rule.current);
        states.insert(rule.next);
        groups.insert(rule.group);
    }
    for (Names::const_iterator state = states.begin(); state != states.end(); ++state) {
        const std::size_t equals = state->rfind('=');
        signals.insert(state->substr(0, equals != std::string::npos ? equals : state->rfind('_')));
    }
    for (std::size_t i = 0; i < set.devices.size(); ++i) {
        devices.insert(set.devices[i].device);
        signals.insert(set.devices[i].signal);
    }
    for (std::size_t i = 0; i < set.groups.size(); ++i) groups.insert(set.groups[i].group);
    std::uint32_t seed = 0;
    while (collide(states, seed) || collide(signals, seed) || collide(devices, seed) ||
           collide(groups, seed) || keys_collide(set.rules, seed)) {
        ++seed;
    }
    return seed;
}
