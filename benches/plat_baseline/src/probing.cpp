#include "probing.h"

#include <cmath>

namespace {

bool is_prime(std::size_t number) {
    if (number < 2) return false;
    for (std::size_t divisor = 2; divisor * divisor <= number; ++divisor) {
        if (number % divisor == 0) return false;
    }
    return true;
}

}  // namespace

std::size_t table_size(std::size_t entries) {
    const std::size_t aim = static_cast<std::size_t>(
        std::floor(static_cast<double>(entries) / LOAD_FACTOR + 0.5));
    for (std::size_t distance = 0;; ++distance) {
        // One slot must stay free, or a search for an absent key would not end.
        if (aim >= distance && aim - distance > entries && aim - distance >= 3 &&
            is_prime(aim - distance)) {
            return aim - distance;
        }
        if (aim + distance > entries && aim + distance >= 3 && is_prime(aim + distance)) {
            return aim + distance;
        }
    }
}
