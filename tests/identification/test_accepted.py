"""Accepted names in `symbols.csv`: one row changes, the rest stays."""

from pathlib import Path

import pytest

from runglight.errors import InputError
from runglight.identification.accepted import accept

NAMING = "{group}-{device}-{signal}"


def test_a_table_is_made_where_there_is_none(tmp_path: Path) -> None:
    table = tmp_path / "symbols.csv"
    assert accept(table, "%MW74.0", "Line1-Conveyor-Running", NAMING, "BOOL") is None
    assert table.read_text(encoding="utf-8").splitlines() == [
        "address,group,device,signal,class,type,description",
        "%MW74.0,Line1,Conveyor,Running,,BOOL,",
    ]


def test_one_row_changes_and_the_rest_stays(tmp_path: Path) -> None:
    table = tmp_path / "symbols.csv"
    table.write_text(
        'Description;Address;Signal;Device\n"a; b";%M1;Open;Gate\nbelt;%MW74.0;Old;Belt\n',
        encoding="utf-8",
    )
    assert accept(table, "%MW74.0", "Line1-Conveyor-Running", NAMING, "BOOL") == "Belt-Old"
    assert table.read_text(encoding="utf-8").splitlines() == [
        "Description;Address;Signal;Device;group",
        '"a; b";%M1;Open;Gate;',
        "belt;%MW74.0;Running;Conveyor;Line1",
    ]


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("Running", "--name: 'Running' does not fit the naming rule"),
        ("Line1-Gate-Open", "Line1-Gate-Open is the name of %M1 already"),
    ],
)
def test_a_name_that_cannot_be_is_refused(tmp_path: Path, name: str, sentence: str) -> None:
    table = tmp_path / "symbols.csv"
    table.write_text("address,group,device,signal\n%M1,Line1,Gate,Open\n", encoding="utf-8")
    before = table.read_bytes()
    with pytest.raises(InputError) as raised:
        accept(table, "%MW74.0", name, NAMING)
    assert sentence in str(raised.value)
    assert table.read_bytes() == before
