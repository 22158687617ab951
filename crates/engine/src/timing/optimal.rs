//! Exact one-dimensional clustering of transition times: optimal k-means by dynamic programming
//! (Wang & Song 2011, Ckmeans.1d.dp, with divide and conquer instead of their quadratic fill),
//! the number of clusters by the Bayesian information criterion, and a separation test, so that
//! one broad time is not cut into slices.

use std::ops::Range;

use super::TimeCluster;

/// More times than this per transition are not told apart: the papers' plants have up to three.
const CLUSTERS_AT_MOST: usize = 6;
/// Distinct values the dynamic programme looks at; more are first pooled with their neighbours.
const DISTINCT_AT_MOST: usize = 2048;
/// Clusters are told apart only where the gap between them is this many times their own spread…
const SEPARATION: f64 = 3.0;
/// … and so wide that spread evenly, the instances would leave such a gap with no more than this
/// probability. Without it a handful of instances falls apart into single ones.
const CHANCE_GAP: f64 = 1e-3;

/// False where even the widest gap is one that chance leaves, so that nothing can be told apart.
fn has_wide_gap(sorted: &[f64], resolution_s: f64) -> bool {
    let range = sorted[sorted.len() - 1] - sorted[0];
    let widest = sorted.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    widest > SEPARATION * resolution_s && chance_of_gap(sorted.len(), widest / range) <= CHANCE_GAP
}

/// The widest of the spacings between n points spread evenly over a range exceeds the share `gap`
/// of it with at most this probability: n (1 − gap)^(n−1) (Fisher 1929, first term).
fn chance_of_gap(n: usize, gap: f64) -> f64 {
    n as f64 * (1.0 - gap).powf(n as f64 - 1.0)
}

/// One value, or several pooled neighbours.
#[derive(Clone, Copy)]
struct Point {
    /// Index of its first instance among the sorted instances.
    start: usize,
    weight: f64,
    sum: f64,
}

/// Clusters instances sorted in ascending order. `resolution_s` is the scan interval or the time
/// resolution of the log: spreads below it mean nothing.
pub fn cluster(sorted: &[f64], resolution_s: f64) -> Vec<TimeCluster> {
    if sorted.is_empty() {
        return Vec::new();
    }
    let starts = if has_wide_gap(sorted, resolution_s) {
        let floor = (resolution_s / 12f64.sqrt()).max(1e-6);
        best_starts(sorted, &points(sorted), floor)
    } else {
        vec![0]
    };
    join_unseparated(sorted, &starts, resolution_s)
        .map(|run| {
            let mut cluster = TimeCluster::of(run, sorted.len());
            let (early_s, late_s) = half_scales(run);
            (cluster.early_scale_s, cluster.late_scale_s) = (early_s as f32, late_s as f32);
            cluster.deviation_s = deviation(run, cluster.average_s) as f32;
            cluster.tail_gini = tail_gini(run) as f32;
            cluster
        })
        .collect()
}

fn points(sorted: &[f64]) -> Vec<Point> {
    let mut points: Vec<Point> = Vec::with_capacity(sorted.len());
    let mut last = f64::NAN;
    for (start, &time) in sorted.iter().enumerate() {
        match points.last_mut() {
            Some(point) if time == last => {
                point.weight += 1.0;
                point.sum += time;
            }
            _ => points.push(Point { start, weight: 1.0, sum: time }),
        }
        last = time;
    }
    if points.len() > DISTINCT_AT_MOST {
        let pooled = points.len().div_ceil(DISTINCT_AT_MOST);
        points = points
            .chunks(pooled)
            .map(|run| Point {
                start: run[0].start,
                weight: run.iter().map(|p| p.weight).sum(),
                sum: run.iter().map(|p| p.sum).sum(),
            })
            .collect();
    }
    points
}

/// Prefix sums, centred on the overall mean for accuracy.
struct Prefix {
    weight: Vec<f64>,
    sum: Vec<f64>,
    square: Vec<f64>,
}

impl Prefix {
    fn of(points: &[Point]) -> Self {
        let total: f64 = points.iter().map(|p| p.weight).sum();
        let centre = points.iter().map(|p| p.sum).sum::<f64>() / total;
        let zero = || {
            let mut sums = Vec::with_capacity(points.len() + 1);
            sums.push(0.0);
            sums
        };
        let mut prefix = Self { weight: zero(), sum: zero(), square: zero() };
        let (mut weight, mut sum, mut square) = (0.0, 0.0, 0.0);
        for point in points {
            let value = point.sum / point.weight - centre;
            weight += point.weight;
            sum += value * point.weight;
            square += value * value * point.weight;
            prefix.weight.push(weight);
            prefix.sum.push(sum);
            prefix.square.push(square);
        }
        prefix
    }

    /// Sum of squared distances to the mean over points `from..to`.
    fn cost(&self, from: usize, to: usize) -> f64 {
        let weight = self.weight[to] - self.weight[from];
        let sum = self.sum[to] - self.sum[from];
        (self.square[to] - self.square[from] - sum * sum / weight).max(0.0)
    }

    /// Costs over points `from..to`, each with what is added to it, for several `from`.
    fn costs(&self, from: Range<usize>, to: usize, added: &[f64], costs: &mut Vec<f64>) {
        let (to_weight, to_sum, to_square) = (self.weight[to], self.sum[to], self.square[to]);
        let (weights, sums) = (&self.weight[from.clone()], &self.sum[from.clone()]);
        let (squares, added) = (&self.square[from.clone()], &added[from]);
        costs.clear();
        // No bounds and no branches: several at a time.
        costs.extend(weights.iter().zip(sums).zip(squares).zip(added).map(
            |(((weight, sum), square), added)| {
                let (weight, sum) = (to_weight - weight, to_sum - sum);
                added + (to_square - square - sum * sum / weight).max(0.0)
            },
        ));
    }
}

/// Start indices (into the sorted instances) of the partition with the best BIC.
fn best_starts(sorted: &[f64], points: &[Point], floor: f64) -> Vec<usize> {
    let prefix = Prefix::of(points);
    let n = points.len();
    let total = sorted.len() as f64;
    let at_most = CLUSTERS_AT_MOST.min(n);
    let one: Vec<f64> = (0..=n).map(|j| if j == 0 { 0.0 } else { prefix.cost(0, j) }).collect();
    let mut programme = Programme {
        prefix: &prefix,
        next: vec![f64::INFINITY; n + 1],
        before: one,
        cuts: vec![0; n + 1],
        costs: Vec::with_capacity(n),
        is_last: false,
    };
    let mut best = (criterion(&prefix, &[0], n, total, floor), vec![0]);
    for k in 2..=at_most {
        programme.is_last = k == at_most;
        programme.layer(k, n);
        let starts = trace_back(&programme.cuts, n);
        let value = criterion(&prefix, &starts, n, total, floor);
        if value < best.0 {
            best = (value, starts);
        }
    }
    best.1.into_iter().map(|point| points[point].start).collect()
}

/// The dynamic programme, layer by layer: one more cluster in each.
struct Programme<'a> {
    prefix: &'a Prefix,
    /// By j: least cost of the first j points in the clusters so far.
    before: Vec<f64>,
    /// The same with one more.
    next: Vec<f64>,
    /// By layer, by j: where the last cluster starts.
    cuts: Vec<usize>,
    costs: Vec<f64>,
    /// After the last layer only what all points cost is asked for.
    is_last: bool,
}

impl Programme<'_> {
    fn layer(&mut self, k: usize, n: usize) {
        self.cuts.resize(k * (n + 1), 0);
        self.next[..k].fill(f64::INFINITY);
        self.fill((k - 1) * (n + 1), (k, n), (k - 1, n - 1));
        std::mem::swap(&mut self.before, &mut self.next);
    }

    /// Fills a layer, whose cuts begin at `row`: the best cut never moves back as the end moves on.
    fn fill(
        &mut self,
        row: usize,
        (mut low, high): (usize, usize),
        (mut cut_low, cut_high): (usize, usize),
    ) {
        while low <= high {
            let middle = low.midpoint(high);
            let end = cut_high.min(middle - 1) + 1;
            self.prefix.costs(cut_low..end, middle, &self.before, &mut self.costs);
            let (mut least, mut at) = (f64::INFINITY, 0);
            for (start, &cost) in (cut_low..).zip(&self.costs) {
                if cost < least {
                    (least, at) = (cost, start);
                }
            }
            self.next[middle] = least;
            self.cuts[row + middle] = at;
            if !self.is_last {
                self.fill(row, (low, middle - 1), (cut_low, at.max(cut_low)));
            }
            (low, cut_low) = (middle + 1, at.max(cut_low));
        }
    }
}

fn trace_back(cuts: &[usize], n: usize) -> Vec<usize> {
    let mut starts = Vec::with_capacity(CLUSTERS_AT_MOST);
    let mut end = n;
    for cut in cuts.chunks(n + 1).rev() {
        end = cut[end];
        starts.push(end);
    }
    starts.reverse();
    starts
}

/// Bayesian information criterion of a mixture of normal times, hard assignment.
fn criterion(prefix: &Prefix, starts: &[usize], n: usize, total: f64, floor: f64) -> f64 {
    let ends = starts.iter().skip(1).copied().chain([n]);
    let log_likelihood: f64 = starts
        .iter()
        .zip(ends)
        .map(|(&start, end)| {
            let weight = prefix.weight[end] - prefix.weight[start];
            let variance = prefix.cost(start, end) / weight + floor * floor;
            weight
                * ((weight / total).ln()
                    - 0.5 * (std::f64::consts::TAU * variance).ln()
                    - 0.5 * (variance - floor * floor) / variance)
        })
        .sum();
    let parameters = (3 * starts.len() - 1) as f64;
    parameters * total.ln() - 2.0 * log_likelihood
}

/// Joins neighbours that no clear gap parts: `SEPARATION` times the wider half-spread, and more
/// than a few scans.
fn join_unseparated<'a>(
    sorted: &'a [f64],
    starts: &[usize],
    resolution_s: f64,
) -> impl Iterator<Item = &'a [f64]> {
    let mut runs: Vec<&[f64]> = Vec::new();
    for (i, &start) in starts.iter().enumerate() {
        let end = starts.get(i + 1).copied().unwrap_or(sorted.len());
        let run = &sorted[start..end];
        match runs.last_mut() {
            Some(left) if !separated(left, run, resolution_s) => {
                *left = &sorted[start - left.len()..end];
            }
            _ => runs.push(run),
        }
    }
    runs.into_iter()
}

fn separated(left: &[f64], right: &[f64], resolution_s: f64) -> bool {
    let (Some(&first), Some(&left_last)) = (left.first(), left.last()) else {
        return false;
    };
    let (Some(&right_first), Some(&last)) = (right.first(), right.last()) else {
        return false;
    };
    let gap = right_first - left_last;
    let spread = half_scales(left).1.max(half_scales(right).0);
    let by_chance = chance_of_gap(left.len() + right.len(), gap / (last - first));
    gap > SEPARATION * spread.max(resolution_s) && by_chance <= CHANCE_GAP
}

/// Gini coefficient of the distances from the median; ½ where there is none to measure.
fn tail_gini(run: &[f64]) -> f64 {
    let n = run.len();
    let median = run[n / 2];
    // Distances in ascending order: the two halves, merged from the middle outwards.
    let (mut below, mut above) =
        (run[..n / 2].iter().rev().peekable(), run[n / 2..].iter().peekable());
    let (mut total, mut weighted) = (0.0, 0.0);
    for rank in 1..=n {
        let distance = match (below.peek(), above.peek()) {
            (Some(&&b), Some(&&a)) if median - b < a - median => {
                below.next();
                median - b
            }
            (Some(&&b), None) => {
                below.next();
                median - b
            }
            (_, Some(&&a)) => {
                above.next();
                a - median
            }
            (None, None) => break,
        };
        total += distance;
        weighted += rank as f64 * distance;
    }
    if total > 0.0 {
        2.0 * weighted / (n as f64 * total) - (n as f64 + 1.0) / n as f64
    } else {
        0.5
    }
}

fn deviation(run: &[f64], mean: f64) -> f64 {
    (run.iter().map(|time| (time - mean).powi(2)).sum::<f64>() / run.len() as f64).sqrt()
}

/// Mean distance of the lower and of the upper half from the median.
fn half_scales(run: &[f64]) -> (f64, f64) {
    let half = run.len() / 2;
    if half == 0 {
        return (0.0, 0.0);
    }
    let median = if run.len() % 2 == 1 { run[half] } else { run[half - 1].midpoint(run[half]) };
    let lower = &run[..half];
    let upper = &run[run.len() - half..];
    let scale = |side: &[f64]| side.iter().map(|t| (t - median).abs()).sum::<f64>() / half as f64;
    (scale(lower), scale(upper))
}
