/* Clusterings of one transition's times, sorted: CSk-means and merging as Ghosh 2016 has them
 * (Algorithms 1 to 3, with the decisions listed in tests/reference/plat.py), the traditional k-means,
 * and the optimum by dynamic programming. */

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_CLUSTERS = 16, MOST_ROUNDS = 1000 };
static const double THRESHOLD_S = 1e-9;

typedef struct {
    int count;
    double centre[MOST_CLUSTERS];
    int size[MOST_CLUSTERS];
} Clusters;

/* The ends of the first k - 1 partitions, at the largest relative gaps (Algorithm 1, 12 to 21). */
static void seed_at_gaps(const double *times, int n, int k, double epsilon, int *ends)
{
    double largest[MOST_CLUSTERS];
    for (int j = 0; j < k - 1; j++) {
        largest[j] = -1;
        ends[j] = -1;
    }
    for (int i = 0; i + 1 < n; i++) {
        double gap = (times[i + 1] - times[i]) / (times[i] + epsilon);
        int least = 0;
        for (int j = 1; j < k - 1; j++)
            if (largest[j] < largest[least])
                least = j;
        if (gap > largest[least]) {
            largest[least] = gap;
            ends[least] = i;
        }
    }
    for (int i = 1; i < k - 1; i++)
        for (int j = i; j > 0 && ends[j] < ends[j - 1]; j--) {
            int end = ends[j];
            ends[j] = ends[j - 1];
            ends[j - 1] = end;
        }
}

static void average(const double *times, int n, int k, const int *ends, double *means, int *sizes)
{
    for (int cluster = 0, low = 0; cluster < k; cluster++) {
        int high = cluster < k - 1 ? ends[cluster] : n - 1;
        double total = 0;
        for (int i = low; i <= high; i++)
            total += times[i];
        sizes[cluster] = high - low + 1 > 0 ? high - low + 1 : 0;
        if (sizes[cluster])
            means[cluster] = total / sizes[cluster];
        low = high + 1;
    }
}

/* Algorithm 2: returns the rounds it took. */
static int iterate(const double *times, int n, int k, int *ends, double *means, int *sizes)
{
    for (int round = 1; round <= MOST_ROUNDS; round++) {
        int reached = 0;
        for (int i = 1; i < n && reached < k - 1; i++)
            if (fabs(times[i] - means[reached]) > fabs(times[i] - means[reached + 1]))
                ends[reached++] = i - 1;
        for (; reached < k - 1; reached++)
            ends[reached] = n - 1;
        double before[MOST_CLUSTERS];
        memcpy(before, means, sizeof before);
        average(times, n, k, ends, means, sizes);
        int same = 1;
        for (int cluster = 0; cluster < k; cluster++)
            same &= fabs(means[cluster] - before[cluster]) <= THRESHOLD_S;
        if (same)
            return round;
    }
    return MOST_ROUNDS;
}

static Clusters keep_filled(int k, const double *means, const int *sizes)
{
    Clusters kept = {0};
    for (int cluster = 0; cluster < k; cluster++)
        if (sizes[cluster]) {
            kept.centre[kept.count] = means[cluster];
            kept.size[kept.count++] = sizes[cluster];
        }
    return kept;
}

static Clusters cs_k_means(const double *times, int n, int k, double epsilon, int *rounds)
{
    int ends[MOST_CLUSTERS], sizes[MOST_CLUSTERS];
    double means[MOST_CLUSTERS] = {0};
    seed_at_gaps(times, n, k, epsilon, ends);
    average(times, n, k, ends, means, sizes);
    *rounds = iterate(times, n, k, ends, means, sizes);
    return keep_filled(k, means, sizes);
}

/* Where the traditional k-means takes its seeds from the sorted data points. */
typedef enum { EVENLY_SPREAD = -1, DRAWN_UNIFORMLY = -2 } Seeding;

static int by_size(const void *left, const void *right)
{
    double a = *(const double *)left, b = *(const double *)right;
    return (a > b) - (a < b);
}

/* Lloyd's: every time goes to the nearest mean. A mean without times stays where it is. */
static Clusters k_means(const double *times, int n, int k, Seeding seeding, uint64_t *chance,
                        int *rounds)
{
    int sizes[MOST_CLUSTERS] = {0};
    double means[MOST_CLUSTERS] = {0};
    for (int cluster = 0; cluster < k; cluster++) {
        *chance = *chance * 6364136223846793005u + 1442695040888963407u;
        double place = seeding == EVENLY_SPREAD ? (cluster + 0.5) / k
                                                : (double)(*chance >> 11) / 9007199254740992.0;
        means[cluster] = times[(int)(place * n)];
    }
    qsort(means, (size_t)k, sizeof *means, by_size);
    for (*rounds = 1; *rounds < MOST_ROUNDS; ++*rounds) {
        double totals[MOST_CLUSTERS] = {0};
        int cluster = 0, same = 1;
        memset(sizes, 0, sizeof sizes);
        for (int i = 0; i < n; i++) {
            for (int next = cluster + 1; next < k; next++)
                if (fabs(times[i] - means[next]) < fabs(times[i] - means[cluster]))
                    cluster = next;
            totals[cluster] += times[i];
            sizes[cluster]++;
        }
        for (cluster = 0; cluster < k; cluster++)
            if (sizes[cluster]) {
                double mean = totals[cluster] / sizes[cluster];
                same &= fabs(mean - means[cluster]) <= THRESHOLD_S;
                means[cluster] = mean;
            }
        if (same)
            break;
    }
    return keep_filled(k, means, sizes);
}

/* Algorithm 3: the nearest two are merged while they lie nearer than `merge_s`, or while there are
 * more than `most`. */
static void merge(Clusters *clusters, double merge_s, int most)
{
    while (clusters->count > 1) {
        int left = 0;
        double *centre = clusters->centre;
        for (int i = 1; i + 1 < clusters->count; i++)
            if (centre[i + 1] - centre[i] < centre[left + 1] - centre[left])
                left = i;
        if (centre[left + 1] - centre[left] >= merge_s && clusters->count <= most)
            return;
        int total = clusters->size[left] + clusters->size[left + 1];
        centre[left] = (centre[left] * clusters->size[left] +
                        centre[left + 1] * clusters->size[left + 1]) / total;
        clusters->size[left] = total;
        clusters->count--;
        for (int i = left + 1; i < clusters->count; i++) {
            centre[i] = centre[i + 1];
            clusters->size[i] = clusters->size[i + 1];
        }
    }
}

/* Squared deviations of times[low..high], from running sums. */
static double cost(const double *sum, const double *square, int low, int high)
{
    double total = sum[high + 1] - sum[low];
    double left = square[high + 1] - square[low] - total * total / (high - low + 1);
    return left > 0 ? left : 0;
}

/* One row of the table by divide and conquer: the best last cut moves right with the end. */
static void best_cuts(const double *sum, const double *square, const double *before, double *best,
                      int *cut, int low, int high, int cut_low, int cut_high)
{
    if (low > high)
        return;
    int middle = (low + high) / 2, last = cut_high < middle ? cut_high : middle;
    best[middle] = INFINITY;
    cut[middle] = cut_low;
    for (int i = cut_low; i <= last; i++) {
        double with = before[i - 1] + cost(sum, square, i, middle);
        if (with < best[middle]) {
            best[middle] = with;
            cut[middle] = i;
        }
    }
    best_cuts(sum, square, before, best, cut, low, middle - 1, cut_low, cut[middle]);
    best_cuts(sum, square, before, best, cut, middle + 1, high, cut[middle], cut_high);
}

/* The optimal clusters for every number of clusters up to k; returns the number that the Bayesian
 * information criterion would choose. */
static int optimum(const double *times, int n, int k, Clusters *of_number)
{
    double *sum = malloc((size_t)(2 * (n + 1) + k * n) * sizeof *sum);
    double *square = sum + n + 1, *best = square + n + 1;
    int *cut = malloc((size_t)(k * n) * sizeof *cut);
    double base = times[n / 2];
    sum[0] = square[0] = 0;
    for (int i = 0; i < n; i++) {
        double time = times[i] - base;
        sum[i + 1] = sum[i] + time;
        square[i + 1] = square[i] + time * time;
    }
    for (int i = 0; i < n; i++) {
        best[i] = cost(sum, square, 0, i);
        cut[i] = 0;
    }
    for (int cluster = 1; cluster < k; cluster++)
        best_cuts(sum, square, best + (cluster - 1) * n, best + cluster * n, cut + cluster * n,
                  cluster, n - 1, cluster, n - 1);
    int chosen = 1;
    double least = INFINITY;
    for (int number = 1; number <= k; number++) {
        double variance = best[(number - 1) * n + n - 1] / n;
        double criterion = n * log(variance > 1e-5 ? variance : 1e-5) + 2 * number * log(n);
        if (criterion < least) {
            least = criterion;
            chosen = number;
        }
        Clusters *clusters = &of_number[number - 1];
        clusters->count = number;
        for (int cluster = number - 1, high = n - 1; cluster >= 0; cluster--) {
            int low = cluster ? cut[cluster * n + high] : 0;
            clusters->size[cluster] = high - low + 1;
            clusters->centre[cluster] = base + (sum[high + 1] - sum[low]) / (high - low + 1);
            high = low - 1;
        }
    }
    free(sum);
    free(cut);
    return chosen;
}

/* How many of the optimum's centres have no counterpart within `close_s`: in their order where
 * both have as many clusters, else the nearest. */
static int far_off(const Clusters *found, const Clusters *best, double close_s)
{
    int far = 0;
    for (int i = 0; i < best->count; i++) {
        double off = INFINITY;
        if (found->count == best->count)
            off = fabs(found->centre[i] - best->centre[i]);
        else
            for (int j = 0; j < found->count; j++)
                off = fmin(off, fabs(found->centre[j] - best->centre[i]));
        far += off > close_s;
    }
    return far;
}

/* `counts`: clusters, those off the optimum by any amount, those far off; the same after merging;
 * rounds; transitions. An `epsilon` below 0 is a way of seeding k-means; `most` is the most clusters kept by
 * merging. `optima` holds k entries per transition, for 1 to k clusters. */
void compare(const double *times, const int64_t *offsets, int64_t transitions, int k,
             double epsilon, double merge_s, int most, double close_s, const Clusters *optima,
             int64_t *counts)
{
    uint64_t chance = 1;
    for (int64_t each = 0; each < transitions; each++) {
        const double *own = times + offsets[each];
        int n = (int)(offsets[each + 1] - offsets[each]), fewer = n < k ? n : k, rounds;
        const Clusters *best = optima + each * k;
        Clusters found = epsilon < 0
                             ? k_means(own, n, fewer, (Seeding)epsilon, &chance, &rounds)
                             : cs_k_means(own, n, fewer, epsilon, &rounds);
        counts[0] += best[fewer - 1].count;
        counts[1] += far_off(&found, &best[fewer - 1], 1e-6);
        counts[2] += far_off(&found, &best[fewer - 1], close_s);
        merge(&found, merge_s, most);
        counts[3] += best[found.count - 1].count;
        counts[4] += far_off(&found, &best[found.count - 1], 1e-6);
        counts[5] += far_off(&found, &best[found.count - 1], close_s);
        counts[6] += rounds;
        counts[7]++;
    }
}

/* The optima of all transitions; `chosen` is what the information criterion makes of each. */
void find_optima(const double *times, const int64_t *offsets, int64_t transitions, int k,
                 Clusters *optima, int32_t *chosen)
{
    for (int64_t each = 0; each < transitions; each++) {
        int n = (int)(offsets[each + 1] - offsets[each]);
        chosen[each] = optimum(times + offsets[each], n, n < k ? n : k, optima + each * k);
    }
}

/* CSk-means and merging of all transitions, for its time; returns the clusters left. */
int64_t cluster_and_merge(const double *times, const int64_t *offsets, int64_t transitions, int k,
                          double epsilon, double merge_s)
{
    int64_t clusters = 0;
    for (int64_t each = 0; each < transitions; each++) {
        int n = (int)(offsets[each + 1] - offsets[each]), rounds;
        Clusters found = cs_k_means(times + offsets[each], n, n < k ? n : k, epsilon, &rounds);
        merge(&found, merge_s, MOST_CLUSTERS);
        clusters += found.count;
    }
    return clusters;
}

/* Bytes of one entry of `optima`. */
int64_t bytes_of_clusters(void) { return sizeof(Clusters); }
