// Symbol names `Group-Device-Signal` and the names of their signal-states (Ghosh 2016, Table 1).
#ifndef NAMES_H
#define NAMES_H

#include <cstddef>
#include <stdexcept>
#include <string>

// Where the group's name and the device's full name (`Group-Device`) end within a symbol name.
struct NameParts {
    std::size_t group_length;
    std::size_t device_length;
};

inline NameParts split_name(const std::string& symbol) {
    NameParts parts;
    parts.group_length = symbol.find('-');
    parts.device_length = parts.group_length == std::string::npos
                              ? std::string::npos
                              : symbol.find('-', parts.group_length + 1);
    if (parts.device_length == std::string::npos) {
        throw std::runtime_error("'" + symbol + "' is not named Group-Device-Signal");
    }
    return parts;
}

// Writes the signal-state's name into `name`, whose memory is used again.
inline void state_name(const std::string& symbol, bool word, long long value, std::string& name) {
    name.assign(symbol);
    if (word) {
        name += '=';
        name += std::to_string(value);
    } else if (value) {
        name += "_ON";
    } else {
        name += "_OFF";
    }
}

#endif
