"""Arrow tables are watched where they lie, whatever they are made of."""

import numpy as np
import pyarrow as pa
import pytest

import runglight as rl
from runglight.errors import InputError
from runglight.plants.cell import simulate_cell

LEARNED, WATCHED = 40, 12


def log_of(cycles: int, seed: int) -> rl.Log:
    run = simulate_cell(cycles=cycles, seed=seed)
    return rl.Log.from_columns(run.time_ns, run.signal_index, run.value, run.signals)


@pytest.fixture(scope="module")
def model() -> rl.NominalModel:
    return rl.learn(log_of(LEARNED, seed=1))


@pytest.fixture(scope="module")
def watched() -> pa.Table:
    """A log with lost rows, and with a signal nobody learned."""
    table = pa.table(log_of(WATCHED, seed=2))
    kept = np.random.default_rng(3).random(table.num_rows) > 0.05
    table = table.filter(pa.array(kept))
    names = table["signal"].combine_chunks().cast(pa.string()).to_pylist()
    names[len(names) // 2] = "Never-Seen-BEFORE"
    return with_signal(table, pa.array(names))


def with_signal(table: pa.Table, signal: pa.Array | pa.ChunkedArray) -> pa.Table:
    return table.set_column(table.column_names.index("signal"), "signal", signal)


def findings(model: rl.NominalModel, *batches: object) -> list[str]:
    monitor = model.monitor()
    lines = [line for batch in batches for line in monitor.observe(batch).json_lines()]
    return lines + monitor.finish().json_lines()


DICTIONARIES = [
    pa.dictionary(pa.uint32(), pa.string()),
    pa.dictionary(pa.int32(), pa.string()),
    pa.dictionary(pa.int8(), pa.string()),
    pa.dictionary(pa.int32(), pa.large_string()),
    pa.large_string(),
]


@pytest.mark.parametrize("kind", DICTIONARIES, ids=str)
def test_any_column_of_names_gives_the_same_findings(
    model: rl.NominalModel, watched: pa.Table, kind: pa.DataType
) -> None:
    expected = findings(model, rl.Log.from_arrow(watched))
    assert any("unknown_signal" in line for line in expected)
    assert len(expected) > 1
    signal = watched["signal"]
    if pa.types.is_dictionary(kind):
        signal = signal.cast(kind.value_type).dictionary_encode().cast(kind)
    else:
        signal = signal.cast(kind)
    table = with_signal(watched, signal)
    assert findings(model, table) == expected
    slices = [table.slice(offset, 37) for offset in range(0, table.num_rows, 37)]
    assert findings(model, *slices) == expected


def test_every_batch_may_have_a_dictionary_of_its_own(
    model: rl.NominalModel, watched: pa.Table
) -> None:
    batches = [
        with_signal(part, part["signal"].dictionary_encode())
        for part in (watched.slice(offset, 50) for offset in range(0, watched.num_rows, 50))
    ]
    assert len(batches) > 2
    together = pa.Table.from_batches([batch.combine_chunks().to_batches()[0] for batch in batches])
    expected = findings(model, watched)
    assert findings(model, *batches) == expected
    assert findings(model, together) == expected


def test_rows_out_of_order_are_refused_and_none_is_taken(
    model: rl.NominalModel, watched: pa.Table
) -> None:
    encoded = with_signal(watched, watched["signal"].dictionary_encode())
    order = [*range(1, encoded.num_rows), 0]
    monitor = model.monitor()
    with pytest.raises(InputError, match=f"row {encoded.num_rows} "):
        monitor.observe(encoded.take(order))
    lines = monitor.observe(encoded).json_lines() + monitor.finish().json_lines()
    assert lines == findings(model, encoded)


def test_names_that_no_row_uses_are_no_matter(model: rl.NominalModel, watched: pa.Table) -> None:
    encoded = watched["signal"].dictionary_encode().combine_chunks()
    names = pa.concat_arrays([encoded.dictionary, pa.array([None, "", "Never-Used-HERE"])])
    signal = pa.DictionaryArray.from_arrays(encoded.indices, names)
    assert findings(model, with_signal(watched, signal)) == findings(model, watched)


def test_an_empty_name_in_use_is_refused(model: rl.NominalModel, watched: pa.Table) -> None:
    names = watched["signal"].to_pylist()
    names[3] = ""
    table = with_signal(watched, pa.array(names).dictionary_encode())
    with pytest.raises(InputError, match="row 4"):
        model.monitor().observe(table)
