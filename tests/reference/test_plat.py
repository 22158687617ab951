"""The reference against numbers worked out by hand from the paper's algorithms."""

import doctest
import random
from itertools import pairwise

import pytest

from runglight.plants.cell import simulate_cell
from tests.reference import plat
from tests.reference.plat import Cluster, Parameters, Row, learn, time_clusters

S = 1_000_000_000


def rows_of(*changes: tuple[float, str, int]) -> list[Row]:
    return [(round(time_s * S), f"G-{signal}", value) for time_s, signal, value in changes]


def test_the_docstrings_examples_hold() -> None:
    failed, attempted = doctest.testmod(plat)
    assert (failed, attempted > 5) == (0, True)


def test_one_cluster_below_the_span_and_two_at_it() -> None:
    assert len(time_clusters([1.0, 3.9], Parameters())) == 1
    # span 3.0 is not below 3.0; centres 3.0 apart are not nearer than 3.0
    assert time_clusters([1.0, 4.0], Parameters()) == [
        Cluster(1.0, 1.0, 1.0, 0.5),
        Cluster(4.0, 4.0, 4.0, 0.5),
    ]


def test_k_shrinks_to_the_number_of_instances() -> None:
    assert [cluster.average_s for cluster in time_clusters([0.0, 10.0, 20.0], Parameters())] == [
        0.0,
        10.0,
        20.0,
    ]


def test_gaps_are_relative_so_a_gap_counts_less_among_long_times() -> None:
    # gaps with epsilon 20: 4/20 = 0.2, 36/24 = 1.5, 8/60 = 0.13; k = 3 takes the first two
    assert plat.seed_positions([0.0, 4.0, 40.0, 60.0, 68.0], 3, 20.0) == [1, 2]


def test_of_equal_gaps_the_first_slot_is_replaced_and_only_by_a_larger_gap() -> None:
    # the four zero gaps fill slots 0 to 3 with 0 to 3; 30/50 replaces slot 0; zeros replace none
    assert plat.seed_positions([30.0] * 9 + [60.0] * 10, 5, 20.0) == [1, 2, 3, 8]


def test_equal_times_do_not_glue_two_clusters_into_one() -> None:
    """Ties leave positions unreached in Algorithm 2; empty partitions keep their means."""
    assert time_clusters([30.0] * 9 + [60.0] * 10, Parameters()) == [
        Cluster(30.0, 30.0, 30.0, 9 / 19),
        Cluster(60.0, 60.0, 60.0, 10 / 19),
    ]


def test_near_centres_merge_into_their_weighted_mean() -> None:
    # k-means keeps the singletons apart; 10 and 12 merge (2 < 3), 10.667 and 20 do not
    (first, second) = time_clusters([10.0, 10.0, 12.0, 20.0], Parameters())
    assert first == Cluster((20.0 + 12.0) / 3, 10.0, 12.0, 0.75)
    assert second == Cluster(20.0, 20.0, 20.0, 0.25)


def test_outliers_go_and_the_rest_is_not_renormalised() -> None:
    times = [10.0 + 0.01 * i for i in range(19)] + [500.0]
    (cluster,) = time_clusters(times, Parameters())
    assert cluster.maximum_s == pytest.approx(10.18)
    assert cluster.probability == 0.95


def test_support_is_strict() -> None:
    times = [1.0] * 23 + [100.0] * 2
    assert len(time_clusters(times, Parameters(support=0.08))) == 1
    assert len(time_clusters(times, Parameters(support=0.0799))) == 2


def test_if_every_cluster_fails_one_of_all_instances_stays() -> None:
    times = [0.0, 10.0, 20.0, 30.0]
    assert time_clusters(times, Parameters(support=0.5)) == [Cluster(15.0, 0.0, 30.0, 1.0)]


def test_clusters_partition_what_they_keep() -> None:
    generator = random.Random(5)
    for _ in range(500):
        centres = [generator.uniform(0, 100) for _ in range(generator.randint(1, 4))]
        times = [
            round(max(0.0, generator.choice(centres) + generator.gauss(0, 1)), 2)
            for _ in range(generator.randint(1, 40))
        ]
        clusters = time_clusters(times, Parameters(support=0.0))
        assert sum(cluster.probability for cluster in clusters) == pytest.approx(1.0)
        assert clusters[0].minimum_s == min(times)
        assert clusters[-1].maximum_s == max(times)
        for cluster in clusters:
            assert cluster.minimum_s <= cluster.average_s + 1e-9
            assert cluster.average_s <= cluster.maximum_s + 1e-9
        for before, after in pairwise(clusters):
            assert before.maximum_s <= after.minimum_s
            assert after.average_s - before.average_s >= 3.0


def test_first_snapshot_of_only_ones_is_events_and_one_with_a_zero_is_an_image() -> None:
    later = [(1.0, "D-B", 1), (2.0, "D-A", 0)]
    (first, *_) = learn(rows_of((0.0, "D-A", 1), *later))
    assert (first["current"], first["next"], first["average_s"]) == ("G-D-A_ON", "G-D-B_ON", 1.0)
    (only, *_) = learn(rows_of((0.0, "D-A", 1), (0.0, "D-B", 0), *later))
    assert (only["current"], only["next"], only["average_s"]) == ("G-D-B_ON", "G-D-A_OFF", 1.0)


def test_samples_are_no_events() -> None:
    changes = [(0.0, "D-A", 1), (2.0, "D-A", 0)]
    with_sample = [changes[0], (1.0, "D-A", 1), changes[1], (9.0, "D-A", 0)]
    assert learn(rows_of(*with_sample)) == learn(rows_of(*changes))


def test_words_and_booleans() -> None:
    rules = learn(rows_of((0.0, "D-STEP", 1), (1.0, "D-STEP", 12), (2.0, "D-X", 1)))
    assert [(rule["current"], rule["next"]) for rule in rules if rule["model"] == "device"] == [
        ("G-D-STEP=1", "G-D-STEP=12"),
        ("G-D-STEP=12", "G-D-X_ON"),
    ]


def test_groups_are_chains_of_starting_signals_and_shares_are_out_of_the_state() -> None:
    rules = learn(
        rows_of(
            (0.0, "D-A", 1),
            (1.0, "E-P", 1),
            (2.0, "D-B", 1),
            (3.0, "D-A", 0),
            (4.0, "E-P", 0),
            (5.0, "D-A", 1),
            (6.0, "D-A", 0),
        )
    )
    group = [rule for rule in rules if rule["model"] == "group"]
    assert [
        (rule["current"], rule["next"], rule["count"], rule["transition_probability"])
        for rule in group
    ] == [
        ("G-D-A_ON", "G-E-P_ON", 1, 0.5),
        ("G-E-P_ON", "G-D-A_OFF", 1, 1.0),
        ("G-D-A_OFF", "G-E-P_OFF", 1, 1.0),
        ("G-E-P_OFF", "G-D-A_ON", 1, 1.0),
        ("G-D-A_ON", "G-D-A_OFF", 1, 0.5),
    ]
    assert [rule["position"] for rule in group] == [0, 1, 2, 3, 4]
    assert {rule["device"] for rule in group} == {""}
    assert {(rule["model"], rule["device"]) for rule in rules} == {
        ("device", "D"),
        ("device", "E"),
        ("group", ""),
    }


def test_an_empty_log_has_no_rules() -> None:
    assert learn([]) == []


def cell_rows(cycles: int, seed: int) -> list[Row]:
    run = simulate_cell(cycles, seed=seed)
    return [
        (time_ns, run.signals[number], value)
        for time_ns, number, value in zip(
            run.time_ns.tolist(), run.signal_index.tolist(), run.value.tolist(), strict=True
        )
    ]


def test_the_cell_teaches_the_two_times_of_the_paper() -> None:
    """Ghosh 2016, section 3.1 (merge below 2 s, support 0.10) and Table 4, row 6: 0.47, 0.52."""
    rules = learn(cell_rows(20, seed=1), Parameters(merge_s=2.0, support=0.10))
    twice = [
        rule
        for rule in rules
        if rule["current"].endswith("LDR-BACKWARD_OFF") and rule["next"].endswith("PRT_CHK_ON")
    ]
    assert [rule["time_probability"] for rule in twice] == [9 / 19, 10 / 19]
    assert [rule["average_s"] for rule in twice] == pytest.approx([30.0, 60.0], abs=0.3)
    assert {rule["count"] for rule in twice} == {19}
    first = {rule["next"]: rule for rule in rules if rule["current"] == "Group1-PrtLDR-RET_ON"}
    by_device = {name: rule for name, rule in first.items() if rule["model"] == "device"}
    assert by_device["Group1-PrtLDR-PRT_CHK_ON"]["transition_probability"] == 1 / 21
