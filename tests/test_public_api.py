"""The names users import. Taking one away, or adding one, is a decision, not an accident."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import runglight
from runglight import _engine
from runglight.log.changelog import Log
from tests.conftest import simulated

PUBLIC = [
    "CycleModel",
    "EventLog",
    "Findings",
    "Identification",
    "InputError",
    "Log",
    "MinedProcess",
    "ModelError",
    "Monitor",
    "NextActivity",
    "NextMonitor",
    "NominalModel",
    "Parameters",
    "PetriNet",
    "ReadOptions",
    "RunglightError",
    "TrainingSettings",
    "__version__",
    "event_log",
    "finding_schema",
    "identify",
    "learn",
    "learn_cycle",
    "load_model",
    "load_next",
    "mine",
    "read_event_log",
    "read_log",
    "read_net",
    "sweep_tau",
    "train_next",
]


def test_the_flat_names() -> None:
    assert runglight.__all__ == PUBLIC
    assert dir(runglight) == PUBLIC
    for name in PUBLIC:
        assert getattr(runglight, name) is not None


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'lern'"):
        _ = runglight.lern


def test_errors_have_one_root() -> None:
    assert issubclass(runglight.InputError, runglight.RunglightError)
    assert issubclass(runglight.ModelError, runglight.RunglightError)


def loaded_after(statement: str) -> set[str]:
    printed = subprocess.run(
        [sys.executable, "-c", f"{statement}\nimport sys; print(*sys.modules)"],
        capture_output=True,
        encoding="utf-8",
        check=True,
    )
    return set(printed.stdout.split())


def test_the_command_line_starts_without_heavy_libraries() -> None:
    loaded = loaded_after(
        "from runglight.cli import main\n"
        "import contextlib, io\n"
        "with contextlib.redirect_stdout(io.StringIO()): assert main(['--help']) == 0"
    )
    assert "runglight.cli.application" in loaded  # The scan has scanned something.
    heavy = {"numpy", "pyarrow", "polars", "pandas", "sqlite3", "sqlalchemy", "runglight.plants"}
    assert not loaded & heavy


def test_watching_a_log_loads_what_it_needs_only(
    nominal_model: runglight.NominalModel, cell: Path, tmp_path: Path
) -> None:
    nominal_model.save(tmp_path / "cell.model")
    words = ["watch", str(tmp_path / "cell.model"), str(cell / "nominal.csv")]
    loaded = loaded_after(
        "from runglight.cli import main\n"
        f"assert main([*{words!r}, '--format', 'jsonl', '-o', {str(tmp_path / 'f')!r}]) == 0"
    )
    assert "runglight.findings.store" in loaded  # It has watched.
    # A second of processor time reads two million rows: what is loaded for nothing is dear.
    heavy = {"asyncio", "numpy", "pyarrow", "polars", "pandas", "rich", "sqlalchemy"}
    only_at_times = {"difflib", "tomllib", "runglight.live.session", "runglight.recording.read"}
    other_commands = {"runglight.cli.learn", "runglight.cli.watch_live", "runglight.cli.serve"}
    assert not loaded & (heavy | only_at_times | other_commands)


def test_importing_the_package_loads_nothing_else() -> None:
    loaded = loaded_after("import runglight")
    assert "runglight" in loaded
    assert not {name for name in loaded if name.startswith("runglight.")}


def test_no_arrow_library_at_run_time(cell: Path) -> None:
    loaded = loaded_after(
        f"import runglight as rl\nmodel = rl.learn(rl.read_log({str(cell / 'nominal.csv')!r}))"
    )
    assert "runglight.model" in loaded
    assert not loaded & {"pyarrow", "polars", "pandas"}


def stub_names() -> list[str]:
    text = (Path(runglight.__file__).parent / "_engine.pyi").read_text(encoding="utf-8")
    names = []
    for node in ast.parse(text).body:
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            names.append(node.target.id)
        if isinstance(node, ast.FunctionDef):
            names.append(node.name)
        if isinstance(node, ast.ClassDef):
            names.append(node.name)
            names.extend(
                f"{node.name}.{each.name}"
                for each in node.body
                if isinstance(each, ast.FunctionDef)
            )
    return names


def test_the_stub_is_the_compiled_engine() -> None:
    assert len(stub_names()) > 30
    for name in stub_names():
        found: object = _engine
        for part in name.split("."):
            assert hasattr(found, part), f"the compiled engine has no {name}"
            found = getattr(found, part)


@pytest.mark.parametrize("library", ["pyarrow", "polars", "pandas"])
def test_logs_go_to_and_come_from_arrow_libraries(library: str) -> None:
    module = pytest.importorskip(library)
    log = simulated(cycles=2)
    table = {
        "pyarrow": lambda: module.table(log),
        "polars": lambda: module.DataFrame(log),
        "pandas": lambda: pytest.importorskip("pyarrow").table(log).to_pandas(),
    }[library]()
    again = Log.from_arrow(table)
    assert len(again) == len(log) == len(table)
    assert (again.start, again.end) == (log.start, log.end)
    assert set(again.signals) <= set(log.signals)


def test_a_table_is_read_learned_and_watched_like_a_log() -> None:
    table = pytest.importorskip("pyarrow").table(simulated(cycles=30))
    model = runglight.learn(table)
    backwards = table.sort_by([("time", "descending")])
    log = runglight.read_log(backwards, reorder_s=1e6)
    assert list(model.watch(table)) == list(model.watch(runglight.read_log(table)))
    assert len(log) == len(table)
    with pytest.raises(runglight.InputError, match="read_log: delimiter says how a file is read"):
        runglight.read_log(table, delimiter=";")


def test_what_is_no_table_is_refused() -> None:
    for take in (runglight.Log.from_arrow, runglight.read_log):
        with pytest.raises(runglight.InputError, match="of type list is no Arrow table"):
            take([1, 2, 3])


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"timeing": "plat"}, r"learn: unknown key 'timeing' \(did you mean timing\?\)"),
        ({"timing": "exact"}, "learn: timing: invalid enum value 'exact'"),
        ({"k": 1}, "learn: k: expected int >= 2"),
        ({"naming": "{group}"}, "the naming rule '{group}' must be made of"),
    ],
)
def test_parameters_are_checked(arguments: dict[str, object], sentence: str) -> None:
    with pytest.raises(runglight.InputError, match=sentence):
        runglight.learn(simulated(cycles=2), **arguments)  # type: ignore[arg-type]


def test_findings_are_dictionaries(cell: Path) -> None:
    model = runglight.load_model(cell / "cell.model")
    findings = list(model.watch(runglight.read_log(cell / "faulty.csv")))
    assert findings
    assert all(set(finding) == set(runglight.finding_schema()["required"]) for finding in findings)
