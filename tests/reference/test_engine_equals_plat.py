"""`learn --timing plat` equals the straight-line reference, rule by rule, on random logs."""

import math

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from runglight import _engine
from runglight.configuration import SignalState
from tests.reference import plat

SIGNALS = ["G1-A-X", "G1-A-Y", "G1-A-STEP", "G1-B-X", "G2-A-X", "G2-C-RUN"]
COLUMNS = ["average_s", "minimum_s", "maximum_s", "time_probability", "transition_probability"]

# Times on a 10 ms grid that fall into a few groups, as a machine's do, and some that do not.
STEPS_MS = st.one_of(
    st.sampled_from([0, 10, 20, 1000, 1010, 1020, 5000, 5010, 30000, 30010, 60000]),
    st.integers(0, 90_000).map(lambda ms: ms // 10 * 10),
)
ROWS = st.lists(
    st.tuples(STEPS_MS, st.integers(0, len(SIGNALS) - 1), st.integers(0, 3)),
    min_size=1,
    max_size=160,
)


def rows_of(steps: list[tuple[int, int, int]]) -> list[plat.Row]:
    """Rows in time order; only STEP is a word."""
    time_ns, rows = 0, []
    for step_ms, signal, value in steps:
        time_ns += step_ms * 1_000_000
        rows.append((time_ns, SIGNALS[signal], value if signal == 2 else value % 2))
    return rows


def engine_rules(rows: list[plat.Row], parameters: plat.Parameters) -> list[dict[str, object]]:
    names = list(dict.fromkeys(name for _, name, _ in rows))
    log = _engine.log_from_columns(
        np.array([row[0] for row in rows], dtype=np.int64),
        np.array([names.index(row[1]) for row in rows], dtype=np.uint32),
        np.array([row[2] for row in rows], dtype=np.int64),
        names,
    )
    options = SignalState(
        timing="plat",
        k=parameters.k,
        epsilon=parameters.epsilon,
        single_cluster_span_s=parameters.span_s,
        merge_distance_s=parameters.merge_s,
        minimum_support=parameters.support,
    )
    model = _engine.learn([log], None, msgspec.json.encode(options).decode())
    rules: list[dict[str, object]] = msgspec.json.decode(model.rules_json())
    return rules


def key(rule: dict[str, object]) -> tuple[object, ...]:
    names = ("model", "group", "device", "current", "next", "cluster")
    return tuple(rule[name] or "" for name in names)


@settings(max_examples=400, deadline=None)
@given(
    steps=ROWS,
    parameters=st.builds(
        plat.Parameters,
        k=st.integers(2, 8),
        epsilon=st.sampled_from([1.0, 20.0]),
        span_s=st.sampled_from([0.5, 3.0]),
        merge_s=st.sampled_from([0.0, 2.0, 3.0]),
        support=st.sampled_from([0.0, 0.08, 0.3]),
    ),
)
def test_equal_rule_by_rule(steps: list[tuple[int, int, int]], parameters: plat.Parameters) -> None:
    rows = rows_of(steps)
    expected = [dict(rule) for rule in plat.learn(rows, parameters)]
    if not plat.events(rows):
        with pytest.raises(_engine.InputError, match="nothing to learn"):
            engine_rules(rows, parameters)
        return
    found = {key(rule): rule for rule in engine_rules(rows, parameters)}
    assert set(found) == {key(rule) for rule in expected}
    for rule in expected:
        other = found[key(rule)]
        assert (other["count"], other["position"]) == (rule["count"], rule["position"])
        for column in COLUMNS:
            assert math.isclose(other[column], rule[column], rel_tol=1e-12, abs_tol=1e-12), (  # type: ignore[arg-type]
                column,
                rule,
                other,
            )


@settings(max_examples=300, deadline=None)
@given(
    steps_ms=st.lists(STEPS_MS, min_size=10, max_size=200),
    k=st.integers(2, 8),
    support=st.sampled_from([0.0, 0.08]),
)
def test_equal_where_one_transition_has_many_times(
    steps_ms: list[int], k: int, support: float
) -> None:
    parameters = plat.Parameters(k=k, support=support)
    # At least 10 ms apart: a value 0 at the very first time would make an image of it.
    rows = rows_of([(max(step, 10), 0, (i + 1) % 2) for i, step in enumerate(steps_ms)])
    found = {key(rule): rule for rule in engine_rules(rows, parameters)}
    expected = {key(dict(rule)): rule for rule in plat.learn(rows, parameters)}
    assert set(found) == set(expected)
    for place, rule in expected.items():
        for column in COLUMNS:
            assert math.isclose(found[place][column], rule[column], rel_tol=1e-12, abs_tol=1e-12)  # type: ignore[arg-type,literal-required]
