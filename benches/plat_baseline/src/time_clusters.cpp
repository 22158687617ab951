#include "time_clusters.h"

#include <algorithm>
#include <cmath>

namespace {

const double KMEANS_THRESHOLD_S = 1e-9;
const int KMEANS_ROUNDS = 1000;

typedef std::vector<double> Times;
typedef std::vector<long> Positions;

// First and last index of partition `i`; the last lies before the first if it is empty.
long first_of(const Positions& pos, std::size_t i) { return i == 0 ? 0 : pos[i - 1] + 1; }
long last_of(const Positions& pos, std::size_t i, std::size_t n) {
    return i < pos.size() ? pos[i] : static_cast<long>(n) - 1;
}

double mean(const Times& times, long first, long last) {
    double total = 0.0;
    for (long j = first; j <= last; ++j) total += times[static_cast<std::size_t>(j)];
    return total / static_cast<double>(last - first + 1);
}

// Algorithm 1, lines 6 to 10.
TimeCluster one_cluster(const Times& times) {
    TimeCluster all = {mean(times, 0, static_cast<long>(times.size()) - 1), times.front(),
                       times.back(), 1.0};
    return all;
}

// Algorithm 1, lines 12 to 21: the ends of the partitions, at the k - 1 largest relative gaps.
Positions seed_positions(const Times& times, std::size_t k, double epsilon) {
    Times gap_val(k - 1, -1.0);
    Positions pos(k - 1, -1);
    for (std::size_t i = 0; i + 1 < times.size(); ++i) {
        const double gap = (times[i + 1] - times[i]) / (times[i] + epsilon);
        double smallest = gap_val[0];
        std::size_t smallest_index = 0;
        for (std::size_t j = 1; j + 1 < k; ++j) {
            if (gap_val[j] < smallest) {
                smallest = gap_val[j];
                smallest_index = j;
            }
        }
        if (gap > smallest) {
            gap_val[smallest_index] = gap;
            pos[smallest_index] = static_cast<long>(i);
        }
    }
    std::sort(pos.begin(), pos.end());
    return pos;
}

// Algorithm 2.
void k_means(const Times& times, Positions& pos, Times& clus_avg) {
    const std::size_t n = times.size();
    const std::size_t k = clus_avg.size();
    for (int round = 0; round < KMEANS_ROUNDS; ++round) {
        std::size_t temp = 0;
        for (std::size_t i = 1; i < n && temp != k - 1; ++i) {
            const double dist1 = std::fabs(times[i] - clus_avg[temp]);
            const double dist2 = std::fabs(times[i] - clus_avg[temp + 1]);
            if (dist1 > dist2) {
                pos[temp] = static_cast<long>(i) - 1;
                ++temp;
            }
        }
        // Positions the loop never reached would stay from the round before and run backwards.
        for (std::size_t unreached = temp; unreached < k - 1; ++unreached) {
            pos[unreached] = static_cast<long>(n) - 1;
        }
        bool repeat = false;
        for (std::size_t i = 0; i < k; ++i) {
            const long first = first_of(pos, i), last = last_of(pos, i, n);
            if (first > last) continue;  // an empty partition keeps its mean
            const double old = clus_avg[i];
            clus_avg[i] = mean(times, first, last);
            if (!(std::fabs(clus_avg[i] - old) <= KMEANS_THRESHOLD_S)) repeat = true;
        }
        if (!repeat) return;
    }
}

struct Merging {
    double average_s;
    double minimum_s;
    double maximum_s;
    std::size_t total;
};

// Algorithm 3: merges near centres, then drops clusters of low support.
std::vector<TimeCluster> merged(const Times& times, const Positions& pos, const Times& clus_avg,
                                const Parameters& parameters) {
    const std::size_t n = times.size();
    std::vector<Merging> clusters;
    for (std::size_t i = 0; i < clus_avg.size(); ++i) {
        const long first = first_of(pos, i), last = last_of(pos, i, n);
        if (first > last) continue;
        Merging cluster = {clus_avg[i], times[static_cast<std::size_t>(first)],
                           times[static_cast<std::size_t>(last)],
                           static_cast<std::size_t>(last - first + 1)};
        clusters.push_back(cluster);
    }
    while (clusters.size() > 1) {
        std::size_t left = 0;
        double shortest = clusters[1].average_s - clusters[0].average_s;
        for (std::size_t i = 1; i + 1 < clusters.size(); ++i) {
            const double distance = clusters[i + 1].average_s - clusters[i].average_s;
            if (distance < shortest) {
                shortest = distance;
                left = i;
            }
        }
        if (!(shortest < parameters.merge_s)) break;
        Merging& into = clusters[left];
        const Merging& from = clusters[left + 1];
        const double tmp1 = into.average_s * static_cast<double>(into.total);
        const double tmp2 = from.average_s * static_cast<double>(from.total);
        into.total += from.total;
        into.average_s = (tmp1 + tmp2) / static_cast<double>(into.total);
        into.maximum_s = from.maximum_s;
        clusters.erase(clusters.begin() + static_cast<long>(left) + 1);
    }
    std::vector<TimeCluster> kept;
    for (std::size_t i = 0; i < clusters.size(); ++i) {
        const double probability = static_cast<double>(clusters[i].total) / static_cast<double>(n);
        if (probability > parameters.support) {
            TimeCluster cluster = {clusters[i].average_s, clusters[i].minimum_s,
                                   clusters[i].maximum_s, probability};
            kept.push_back(cluster);
        }
    }
    if (kept.empty()) kept.push_back(one_cluster(times));
    return kept;
}

}  // namespace

std::vector<TimeCluster> time_clusters(std::vector<double>& time_array,
                                       const Parameters& parameters) {
    std::sort(time_array.begin(), time_array.end());  // libstdc++'s sort is introsort
    const std::size_t n = time_array.size();
    const std::size_t k = std::min(parameters.k, n);
    if (time_array[n - 1] - time_array[0] < parameters.span_s || k < 2) {
        return std::vector<TimeCluster>(1, one_cluster(time_array));
    }
    Positions pos = seed_positions(time_array, k, parameters.epsilon);
    Times clus_avg(k);
    for (std::size_t i = 0; i < k; ++i) {
        clus_avg[i] = mean(time_array, first_of(pos, i), last_of(pos, i, n));
    }
    k_means(time_array, pos, clus_avg);
    return merged(time_array, pos, clus_avg, parameters);
}
