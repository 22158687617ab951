import pytest

from runglight.taps.modbus_names import Area, signal_at


@pytest.mark.parametrize(
    ("names", "area", "number", "name"),
    [
        ("modbus", Area.COILS, 0, "00001"),
        ("modbus", Area.INPUTS, 0, "10001"),
        ("modbus", Area.INPUT_REGISTERS, 0, "30001"),
        ("modbus", Area.HOLDING, 0, "40001"),
        ("modbus", Area.HOLDING, 9_998, "49999"),
        ("modbus", Area.HOLDING, 9_999, "410000"),
        ("modbus", Area.COILS, 9_999, "010000"),
        ("modbus", Area.HOLDING, 65_535, "465536"),
        ("iec", Area.COILS, 0, "%M0"),
        ("iec", Area.INPUTS, 17, "%I17"),
        ("iec", Area.INPUT_REGISTERS, 2, "%IW2"),
        ("iec", Area.HOLDING, 33, "%MW33"),
        ("openplc", Area.COILS, 0, "%QX0.0"),
        ("openplc", Area.COILS, 15, "%QX1.7"),
        ("openplc", Area.INPUTS, 9, "%IX1.1"),
        ("openplc", Area.INPUT_REGISTERS, 3, "%IW3"),
        ("openplc", Area.HOLDING, 0, "%QW0"),
        ("openplc", Area.HOLDING, 1_023, "%QW1023"),
        ("openplc", Area.HOLDING, 1_024, "%MW0"),
        ("openplc", Area.HOLDING, 1_026, "%MW2"),
    ],
)
def test_names(names: str, area: Area, number: int, name: str) -> None:
    signal = signal_at(area, number, names)
    assert signal.name == signal.address == name


@pytest.mark.parametrize("names", ["modbus", "iec", "openplc"])
def test_every_address_has_a_name_of_its_own_and_inputs_come_first(names: str) -> None:
    signals = [signal_at(area, number, names) for area in Area for number in range(12_000)]
    assert len({signal.name for signal in signals}) == len(signals)
    order = {"input": 0, "output": 1, "memory": 2}
    classes = [order[signal.signal_class] for signal in signals]
    assert classes == sorted(classes)
    assert {signal.type for signal in signals} == {"BOOL", "UINT"}
