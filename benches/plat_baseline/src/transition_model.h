// The transitions of one device or group (Ghosh 2016, Figure 9(b) and (c)).
#ifndef TRANSITION_MODEL_H
#define TRANSITION_MODEL_H

#include <cstddef>
#include <cstdint>
#include <vector>

class TransitionModel {
  public:
    struct Transition {
        std::int32_t current;
        std::int32_t next;
        std::size_t first_record;
        std::vector<double> times_s;
    };

    explicit TransitionModel(std::size_t states);
    ~TransitionModel();

    void add(std::int32_t current, std::int32_t next, double seconds, std::size_t record);

    // In the order of their first appearance.
    std::vector<Transition>& transitions() { return transitions_; }
    std::uint32_t count(std::int32_t current, std::int32_t next) const;
    // How often `current` was left: the counters of all its successors.
    std::uint32_t left(std::int32_t current) const;

  private:
    TransitionModel(const TransitionModel&);
    TransitionModel& operator=(const TransitionModel&);

    // Figure 9(b): null, one successor in place, or a pointer to an array of several.
    struct Successors {
        std::uint32_t size;
        union {
            std::int32_t single;
            std::int32_t* several;
        };
    };
    // Figure 9(c): hash code and counter, and where the transition's times are kept.
    struct Counter {
        std::int64_t code;
        std::uint32_t count;
        std::uint32_t transition;
    };

    std::int64_t code(std::int32_t current, std::int32_t next) const { return current * q_ + next; }
    std::size_t slot(std::int64_t code) const;
    void insert_successor(std::int32_t current, std::int32_t next);
    void grow();

    std::int64_t q_;
    std::vector<Successors> successors_;
    std::vector<Counter> counters_;
    std::vector<Transition> transitions_;
};

#endif
