"""The contract of every monitor, kept by the cycle machine: cuts, saved states, gaps, manual."""

import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from runglight.configuration import Cycle, Modes, Parameters, cycle_json
from runglight.cycle_model import CycleModel
from runglight.errors import InputError
from runglight.log.changelog import Log
from runglight.model import NominalModel, learn_cycle, learn_with, load_model
from runglight.plants.press import FAILURES, FAULTS, MODES, REGIONS, SYMBOLS, simulate_press
from runglight.plants.symbols import symbols_csv, write_symbols

QUICKLY = settings(
    max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
BROKEN = (1, 8, 11, 19)


def pressed(cycles: int | None = None, seed: int = 1, fault: tuple[int, ...] = ()) -> Log:
    run = simulate_press(cycles, seed=seed, fault=fault or None)
    return Log.from_columns(run.time_ns, run.signal_index, run.value, run.signals)


@pytest.fixture(scope="module")
def nominal_log() -> Log:
    return pressed(60)


@pytest.fixture(scope="module")
def faulty_log() -> Log:
    return pressed(20, seed=2, fault=BROKEN)


@pytest.fixture(scope="module")
def symbols(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("press") / "symbols.csv"
    write_symbols(SYMBOLS, path)
    return path


@pytest.fixture(scope="module", params=["word", "element"])
def model(request: pytest.FixtureRequest, nominal_log: Log, symbols: Path) -> CycleModel:
    return learn_cycle(nominal_log, MODES, REGIONS, symbols=symbols, mode=request.param)


@pytest.fixture(scope="module")
def joint(nominal_log: Log) -> NominalModel:
    return learn_with([nominal_log], symbols_csv(SYMBOLS), Parameters(), settings_of())


def settings_of(**cycle: Any) -> str:
    return cycle_json(Modes(**MODES), REGIONS, Cycle(**cycle))


def whole(model: CycleModel | NominalModel, log: Log) -> list[str]:
    monitor = model.monitor()
    return monitor.observe(log).json_lines() + monitor.finish().json_lines()


@QUICKLY
@given(data=st.data())
def test_any_split_and_any_restore(model: CycleModel, faulty_log: Log, data: st.DataObject) -> None:
    split_anywhere(model, faulty_log, data)


@QUICKLY
@given(data=st.data())
def test_any_split_of_both_models_together(
    joint: NominalModel, faulty_log: Log, data: st.DataObject
) -> None:
    split_anywhere(joint, faulty_log, data)


def split_anywhere(model: CycleModel | NominalModel, log: Log, data: st.DataObject) -> None:
    cuts = sorted(data.draw(st.sets(st.integers(0, len(log)), max_size=6)))
    monitor = model.monitor()
    lines: list[str] = []
    for start, end in zip([0, *cuts], [*cuts, len(log)], strict=True):
        lines += monitor.observe(log.slice(start, end - start)).json_lines()
        if data.draw(st.booleans()):
            monitor = model.monitor(state=monitor.state())
    lines += monitor.finish().json_lines()
    assert lines == whole(model, log)
    assert any(json.loads(line)["model"] == "cycle" for line in lines)


def test_a_sound_log_has_no_class_1_or_2(model: CycleModel) -> None:
    findings = [json.loads(line) for line in whole(model, pressed(30, seed=7))]
    assert not [finding for finding in findings if finding["rank"] in (1, 2)]


def test_a_gap_resynchronises_instead_of_alarming(model: CycleModel, nominal_log: Log) -> None:
    """Rows are lost in the middle of a motion; what was learned itself has no finding."""
    monitor = model.monitor()
    time_ns = nominal_log.columns()[0].tolist()
    last = len(nominal_log) // 2
    first = next(row for row in range(last + 37, len(time_ns)) if time_ns[row] > time_ns[row - 1])
    lines = monitor.observe(nominal_log.slice(0, last)).json_lines()
    lines += monitor.gap(time_ns[last - 1], time_ns[first] - 1).json_lines()
    lines += monitor.observe(nominal_log.slice(first)).json_lines()
    lines += monitor.finish().json_lines()
    assert whole(model, nominal_log) == [] or model.summary()["mode"] == "word"
    assert [line for line in lines if json.loads(line)["rank"] in (1, 2)] == []


def test_a_state_of_another_model_is_refused(
    model: CycleModel, nominal_log: Log, symbols: Path
) -> None:
    other = learn_cycle(nominal_log, MODES, {"one": "I12"}, symbols=symbols)
    with pytest.raises(InputError, match="another model"):
        model.monitor(state=other.monitor().state())
    with pytest.raises(InputError, match="damaged"):
        model.monitor(state=b"not a state at all")


def test_the_failing_address_stands_first(nominal_log: Log, symbols: Path, faulty_log: Log) -> None:
    model = learn_cycle(nominal_log, MODES, REGIONS, symbols=symbols)
    findings = [json.loads(line) for line in whole(model, faulty_log)]
    ones = [finding for finding in findings if finding["rank"] == 1]
    assert len(ones) == len(BROKEN)
    for finding, number in zip(ones, BROKEN, strict=True):
        named = finding["suspects"][0]["signal"].partition("-")[2]
        assert named in FAILURES[number].shows, FAULTS[number].name
        assert (finding["severity"], finding["state"]) == ("fault", "confirmed")


def test_one_event_is_one_incident_with_two_witnesses(joint: NominalModel, faulty_log: Log) -> None:
    findings = [json.loads(line) for line in whole(joint, faulty_log)]
    incidents: dict[str, set[str]] = {}
    for finding in findings:
        incidents.setdefault(finding["incident"], set()).add(finding["model"])
    ones = [finding for finding in findings if finding["rank"] == 1]
    assert ones
    together = [one for one in ones if incidents[one["incident"]] & {"device", "group"}]
    assert together, "no failure was witnessed by both models"
    # Every line of a finding stays in its incident.
    for finding in findings:
        lines = [each for each in findings if each["id"] == finding["id"]]
        assert len({each["incident"] for each in lines}) == 1


def test_a_model_survives_saving(joint: NominalModel, faulty_log: Log, tmp_path: Path) -> None:
    joint.save(tmp_path / "press.model")
    again = load_model(tmp_path / "press.model")
    assert again.cycle is not None
    assert joint.cycle is not None
    assert again.cycle.summary() == joint.cycle.summary()
    assert whole(again, faulty_log) == whole(joint, faulty_log)


@pytest.mark.parametrize(
    ("damage", "sentence"),
    [
        (lambda text: text[: len(text) // 2], "cycles.json"),
        (lambda text: text.replace('"weight":', '"wait":', 1), "cycles.json"),
        (lambda _: "", "cycles.json"),
    ],
)
def test_a_damaged_file_is_refused(
    joint: NominalModel, tmp_path: Path, damage: Any, sentence: str
) -> None:
    joint.save(tmp_path / "press.model")
    file = tmp_path / "press.model" / "cycles.json"
    file.write_text(damage(file.read_text(encoding="utf-8")), encoding="utf-8")
    with pytest.raises(Exception, match=sentence) as refusal:
        load_model(tmp_path / "press.model")
    assert "\n" not in str(refusal.value)
    file.unlink()
    with pytest.raises(Exception, match=r"cycles\.json is missing"):
        load_model(tmp_path / "press.model")


def test_proposed_regions_cover_the_inputs(nominal_log: Log, symbols: Path) -> None:
    regions = learn_cycle(nominal_log, MODES, symbols=symbols).summary()["regions"]
    bits = [bit for region in regions for bit in region["bits"]]
    assert len(bits) == len(set(bits)) == 216
    assert max(len(region["bits"]) for region in regions) <= 8
    together = next(region["bits"] for region in regions if "I12.0" in region["bits"])
    # Clamps 1 to 4 close side by side.
    assert {"I12.0", "I12.2", "I12.4", "I12.6"} <= set(together)


@pytest.mark.parametrize(
    ("modes", "regions", "sentence"),
    [
        (
            {"work_complete": "M9.9"},
            REGIONS,
            r"work_complete: no log has a signal 'M9.9'",
        ),
        (MODES, {"x": "I99-I100"}, r"\[regions\] x: 'I99-I100' names no bits of the logs"),
        (MODES, {"x": ["I0.0", "Q77.1"]}, r"\[regions\] x: no log has a signal 'Q77.1'"),
        (MODES, {"x": "I0-I26"}, r"\[regions\] x has 216 bits; expected 1 to 128"),
        ({"manual": "M0.1"}, REGIONS, "work_complete is missing"),
    ],
)
def test_settings_are_refused_with_a_sentence(
    nominal_log: Log, symbols: Path, modes: Any, regions: Any, sentence: str
) -> None:
    with pytest.raises(InputError, match=sentence):
        learn_cycle(nominal_log, modes, regions, symbols=symbols)


def test_nothing_to_learn_from_one_cycle(symbols: Path) -> None:
    with pytest.raises(InputError, match="no whole cycle to learn"):
        learn_cycle(pressed(1), MODES, REGIONS, symbols=symbols)
