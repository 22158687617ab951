#include "rules.h"

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

namespace {

const char* const HEADER =
    "model\tgroup\tdevice\tcurrent\tnext\tcount\ttransition_probability\tcluster\taverage_s\t"
    "minimum_s\tmaximum_s\ttime_probability\tposition\tfirst_record";

std::vector<std::string> fields_of(const std::string& line) {
    std::vector<std::string> fields;
    std::size_t start = 0;
    for (;;) {
        const std::size_t tab = line.find('\t', start);
        fields.push_back(line.substr(start, tab - start));
        if (tab == std::string::npos) return fields;
        start = tab + 1;
    }
}

std::string short_device(const std::string& group, const std::string& device) {
    return device.empty() ? device : device.substr(group.size() + 1);
}

}  // namespace

std::set<std::string> RuleSet::words() const {
    std::set<std::string> words;
    for (std::size_t i = 0; i < rules.size(); ++i) {
        const std::string* const ends[2] = {&rules[i].current, &rules[i].next};
        for (int e = 0; e < 2; ++e) {
            const std::size_t equals = ends[e]->rfind('=');
            if (equals != std::string::npos &&
                ends[e]->find_first_not_of("-0123456789", equals + 1) == std::string::npos) {
                words.insert(ends[e]->substr(0, equals));
            }
        }
    }
    return words;
}

void write_rules(const RuleSet& set, const std::string& path) {
    std::FILE* file = std::fopen(path.c_str(), "w");
    if (!file) throw std::runtime_error("cannot write " + path);
    std::fprintf(file, "%s\n", HEADER);
    for (std::size_t i = 0; i < set.devices.size(); ++i) {
        std::fprintf(file, "starting_signal\t\t%s\t%s\n", set.devices[i].device.c_str(),
                     set.devices[i].signal.c_str());
    }
    for (std::size_t i = 0; i < set.groups.size(); ++i) {
        std::fprintf(file, "starting_state\t%s\t\t%s\n", set.groups[i].group.c_str(),
                     set.groups[i].state.c_str());
    }
    for (std::size_t i = 0; i < set.rules.size(); ++i) {
        const Rule& rule = set.rules[i];
        for (std::size_t c = 0; c < rule.times.size(); ++c) {
            const TimeCluster& time = rule.times[c];
            std::fprintf(file,
                         "%s\t%s\t%s\t%s\t%s\t%zu\t%.17g\t%zu\t%.17g\t%.17g\t%.17g\t%.17g\t%zu\t%zu\n",
                         rule.of_group ? "group" : "device", rule.group.c_str(),
                         short_device(rule.group, rule.device).c_str(), rule.current.c_str(),
                         rule.next.c_str(), rule.count, rule.probability, c, time.average_s,
                         time.minimum_s, time.maximum_s, time.probability, rule.position,
                         rule.first_record);
        }
    }
    if (std::fclose(file) != 0) throw std::runtime_error("cannot write " + path);
}

RuleSet read_rules(const std::string& path) {
    std::ifstream file(path.c_str());
    std::string line;
    if (!std::getline(file, line) || line != HEADER) {
        throw std::runtime_error(path + " is no file of rules");
    }
    RuleSet set;
    while (std::getline(file, line)) {
        const std::vector<std::string> f = fields_of(line);
        if (f.size() == 4 && f[0] == "starting_signal") {
            DeviceStart start = {f[2], f[3]};
            set.devices.push_back(start);
        } else if (f.size() == 4 && f[0] == "starting_state") {
            GroupStart start = {f[1], f[3]};
            set.groups.push_back(start);
        } else if (f.size() == 14) {
            if (f[7] == "0") {
                Rule rule;
                rule.of_group = f[0] == "group";
                rule.group = f[1];
                rule.device = rule.of_group ? std::string() : f[1] + "-" + f[2];
                rule.current = f[3];
                rule.next = f[4];
                rule.count = std::strtoull(f[5].c_str(), NULL, 10);
                rule.probability = std::strtod(f[6].c_str(), NULL);
                rule.position = std::strtoull(f[12].c_str(), NULL, 10);
                rule.first_record = std::strtoull(f[13].c_str(), NULL, 10);
                set.rules.push_back(rule);
            }
            TimeCluster time = {std::strtod(f[8].c_str(), NULL), std::strtod(f[9].c_str(), NULL),
                                std::strtod(f[10].c_str(), NULL), std::strtod(f[11].c_str(), NULL)};
            set.rules.back().times.push_back(time);
        } else {
            throw std::runtime_error(path + ": not a rule: " + line);
        }
    }
    return set;
}
