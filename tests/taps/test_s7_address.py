import pytest
from hypothesis import given
from hypothesis import strategies as st

from runglight.errors import InputError
from runglight.taps.s7_address import MOST_BYTE, MOST_DB, S7Address, S7Area, parse_s7_address


@st.composite
def addresses(draw: st.DrawFn) -> S7Address:
    area = draw(st.sampled_from(S7Area))
    bits = draw(st.sampled_from([1, 8, 16, 32]))
    return S7Address(
        area,
        byte=draw(st.integers(0, MOST_BYTE - (bits - 1) // 8)),
        bit=draw(st.integers(0, 7)) if bits == 1 else 0,
        bits=bits,
        db=draw(st.integers(1, MOST_DB)) if area is S7Area.DATA else 0,
    )


@given(addresses())
def test_what_is_printed_is_read_back(address: S7Address) -> None:
    assert parse_s7_address(str(address)) == address


@given(addresses())
def test_german_and_tia_spellings_mean_the_same(address: S7Address) -> None:
    german = str(address)
    if address.area is not S7Area.DATA:
        german = german.replace("I", "E", 1).replace("Q", "A", 1)
    assert parse_s7_address(german.lower()) == address
    assert parse_s7_address(f" %{address} ") == address


@pytest.mark.parametrize(
    ("written", "printed"),
    [
        ("I5.0", "I5.0"),
        ("E5.0", "I5.0"),
        ("A1.2", "Q1.2"),
        ("IX5.0", "I5.0"),
        ("EB5", "IB5"),
        ("IW4", "IW4"),
        ("ID4", "ID4"),
        ("AW2", "QW2"),
        ("MB10", "MB10"),
        ("md8", "MD8"),
        ("M10.3", "M10.3"),
        ("DB1.DBX0.0", "DB1.DBX0.0"),
        ("DB1.DBB2", "DB1.DBB2"),
        ("db12.dbw2", "DB12.DBW2"),
        ("DB1.DBD4", "DB1.DBD4"),
    ],
)
def test_spellings(written: str, printed: str) -> None:
    assert str(parse_s7_address(written)) == printed


@pytest.mark.parametrize(
    "written",
    [
        "", "5.0", "I5", "I5.8", "I5.0.0", "IB5.0", "DB1.DBX0", "DB1.DBW2.1", "DB0.DBB0",
        "DB1.I0.0", "M-1.0", "I99999.0", "IW65535", "X1.0", "DB1", "I٣.0", "I5.0\n5",
        "DB99999.DBB0",
    ],
)  # fmt: skip
def test_anything_else_is_refused_in_one_sentence(written: str) -> None:
    with pytest.raises(InputError, match="is no S7 address; write for example I5"):
        parse_s7_address(written)


@given(st.text(max_size=20))
def test_any_text_is_an_address_or_refused(written: str) -> None:
    try:
        address = parse_s7_address(written)
    except InputError:
        return
    assert parse_s7_address(str(address)) == address
