// The times of one transition: Algorithms 1 to 3 of Ghosh 2016, decided as in
// tests/reference/plat.py.
#ifndef TIME_CLUSTERS_H
#define TIME_CLUSTERS_H

#include <cstddef>
#include <vector>

// The user-defined values; defaults of section 3.2.
struct Parameters {
    std::size_t k;
    double epsilon;
    double span_s;
    double merge_s;
    double support;
    Parameters() : k(5), epsilon(20.0), span_s(3.0), merge_s(3.0), support(0.08) {}
};

struct TimeCluster {
    double average_s;
    double minimum_s;
    double maximum_s;
    double probability;
};

// Algorithm 1; sorts `time_array`.
std::vector<TimeCluster> time_clusters(std::vector<double>& time_array,
                                       const Parameters& parameters);

#endif
