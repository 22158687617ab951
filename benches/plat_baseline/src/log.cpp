#include "log.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

namespace {

std::string file_content(const std::string& path) {
    std::FILE* file = std::fopen(path.c_str(), "rb");
    if (!file) throw std::runtime_error("cannot open " + path);
    std::string content;
    std::fseek(file, 0, SEEK_END);
    content.resize(static_cast<std::size_t>(std::ftell(file)));
    std::rewind(file);
    const std::size_t got = content.empty() ? 0 : std::fread(&content[0], 1, content.size(), file);
    std::fclose(file);
    if (got != content.size()) throw std::runtime_error("cannot read " + path);
    return content;
}

bool parse(const char* line, const char* end, Record& record) {
    char* after = NULL;
    record.time_ns = std::strtoll(line, &after, 10);
    if (after == line || *after != '\t') return false;
    const char* symbol = after + 1;
    const char* tab = static_cast<const char*>(
        std::memchr(symbol, '\t', static_cast<std::size_t>(end - symbol)));
    if (!tab) return false;
    record.symbol.assign(symbol, tab);
    record.value = std::strtoll(tab + 1, &after, 10);
    if (after != end && *after == '\r') ++after;
    return after != tab + 1 && after == end;
}

bool is_status(std::int64_t value) { return value == 0 || value == 1; }

}  // namespace

std::vector<Record> read_log(const std::string& path) {
    const std::string content = file_content(path);
    std::vector<Record> records;
    Record record = Record();
    const char* line = content.data();
    const char* const stop = line + content.size();
    for (std::size_t number = 1; line < stop; ++number) {
        const char* end = static_cast<const char*>(
            std::memchr(line, '\n', static_cast<std::size_t>(stop - line)));
        if (!end) end = stop;
        if (parse(line, end, record)) {
            records.push_back(record);
        } else if (number > 1) {
            throw std::runtime_error(path + ", line " + std::to_string(number) +
                                     ": expected time, symbol and value");
        }
        line = end + 1;
    }
    return records;
}

SymbolList mark_events(std::vector<Record>& records, const std::set<std::string>* learned_words) {
    SymbolList symbols;
    if (records.empty()) return symbols;
    std::set<std::string> words;
    if (learned_words) words = *learned_words;
    const std::int64_t first_ns = records[0].time_ns;
    bool image = false;
    for (std::size_t i = 0; i < records.size(); ++i) {
        const Record& record = records[i];
        if (!learned_words && !is_status(record.value)) words.insert(record.symbol);
        if (record.time_ns == first_ns && record.value == 0) image = true;
    }
    std::unordered_map<std::string, std::int64_t> values;
    for (std::size_t i = 0; i < records.size(); ++i) {
        Record& record = records[i];
        std::unordered_map<std::string, std::int64_t>::iterator last = values.find(record.symbol);
        const bool changed = last == values.end() || last->second != record.value;
        values[record.symbol] = record.value;
        record.event = changed && !(image && record.time_ns == first_ns);
        record.word = !is_status(record.value) || (!words.empty() && words.count(record.symbol) > 0);
        if (record.event) symbols[record.symbol].insert(record.value);
    }
    return symbols;
}
