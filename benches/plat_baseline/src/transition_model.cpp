#include "transition_model.h"

#include <algorithm>

#include "probing.h"

namespace {

const std::int64_t EMPTY = -1;

}  // namespace

TransitionModel::TransitionModel(std::size_t states)
    : q_(static_cast<std::int64_t>(states) + 1) {
    Successors none;
    none.size = 0;
    none.several = NULL;
    successors_.assign(states, none);
    const Counter empty = {EMPTY, 0, 0};
    counters_.assign(table_size(states), empty);
}

TransitionModel::~TransitionModel() {
    for (std::size_t i = 0; i < successors_.size(); ++i) {
        if (successors_[i].size > 1) delete[] successors_[i].several;
    }
}

void TransitionModel::add(std::int32_t current, std::int32_t next, double seconds,
                          std::size_t record) {
    const std::int64_t wanted = code(current, next);
    std::size_t place = slot(wanted);
    if (counters_[place].code == EMPTY) {
        if (static_cast<double>(transitions_.size() + 1) >
            LOAD_FACTOR * static_cast<double>(counters_.size())) {
            grow();
            place = slot(wanted);
        }
        counters_[place].code = wanted;
        counters_[place].transition = static_cast<std::uint32_t>(transitions_.size());
        const Transition transition = {current, next, record, std::vector<double>()};
        transitions_.push_back(transition);
        insert_successor(current, next);
    }
    ++counters_[place].count;
    transitions_[counters_[place].transition].times_s.push_back(seconds);
}

std::uint32_t TransitionModel::count(std::int32_t current, std::int32_t next) const {
    return counters_[slot(code(current, next))].count;
}

std::uint32_t TransitionModel::left(std::int32_t current) const {
    const Successors& successors = successors_[static_cast<std::size_t>(current)];
    if (successors.size == 1) return count(current, successors.single);
    std::uint32_t total = 0;
    for (std::uint32_t i = 0; i < successors.size; ++i) {
        total += count(current, successors.several[i]);
    }
    return total;
}

std::size_t TransitionModel::slot(std::int64_t wanted) const {
    std::size_t place = static_cast<std::size_t>(wanted) % counters_.size();
    while (counters_[place].code != wanted && counters_[place].code != EMPTY) {
        if (++place == counters_.size()) place = 0;
    }
    return place;
}

void TransitionModel::insert_successor(std::int32_t current, std::int32_t next) {
    Successors& successors = successors_[static_cast<std::size_t>(current)];
    if (successors.size == 0) {
        successors.single = next;
    } else {
        std::int32_t* const longer = new std::int32_t[successors.size + 1];
        if (successors.size == 1) {
            longer[0] = successors.single;
        } else {
            std::copy(successors.several, successors.several + successors.size, longer);
            delete[] successors.several;
        }
        longer[successors.size] = next;
        successors.several = longer;
    }
    ++successors.size;
}

void TransitionModel::grow() {
    std::vector<Counter> old;
    old.swap(counters_);
    const Counter empty = {EMPTY, 0, 0};
    counters_.assign(table_size(2 * (transitions_.size() + 1)), empty);
    for (std::size_t i = 0; i < old.size(); ++i) {
        if (old[i].code != EMPTY) counters_[slot(old[i].code)] = old[i];
    }
}
