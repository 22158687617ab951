// The change log in memory, and which of its rows are events.
#ifndef LOG_H
#define LOG_H

#include <cstdint>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

struct Record {
    std::int64_t time_ns;
    std::string symbol;
    std::int64_t value;
    bool event;  // false for a sample: it repeats its signal's value, or belongs to the first image
    bool word;   // its states are written NAME=VALUE
};

// The "PLC program symbol list" of the paper: every symbol with the values of its events.
typedef std::unordered_map<std::string, std::set<std::int64_t> > SymbolList;

// Reads `time_ns<TAB>Group-Device-Signal<TAB>value` lines; a header line is passed over.
std::vector<Record> read_log(const std::string& path);

// Marks events and words (decisions 1, 2 and 4 of tests/reference/plat.py) and returns the symbols.
// The paper's logger writes changes only, so this stands for it and is never timed. Words are those
// of the log when learning (`learned_words` is null), and those learned when watching.
SymbolList mark_events(std::vector<Record>& records, const std::set<std::string>* learned_words);

#endif
