"""Nothing is written unless it was asked for, and nowhere it was not."""

import pytest

from runglight.control.permission import check_permission, is_loopback
from runglight.errors import InputError

HERE = ("modbus://127.0.0.1:502", "127.0.0.1")
THERE = ("modbus://192.0.2.7:502", "192.0.2.7")


def test_writing_has_to_be_asked_for() -> None:
    for machinery in (False, True):
        with pytest.raises(InputError, match="add --allow-writes, or --shadow"):
            check_permission(*HERE, allow_writes=False, moves_machinery=machinery)
    check_permission(*HERE, allow_writes=True, moves_machinery=False)


def test_other_computers_need_a_second_word() -> None:
    with pytest.raises(InputError, match="--i-know-this-moves-machinery"):
        check_permission(*THERE, allow_writes=True, moves_machinery=False)
    check_permission(*THERE, allow_writes=True, moves_machinery=True)


def test_loopback_is_an_address_not_a_name_that_looks_like_one() -> None:
    assert is_loopback("127.0.0.1")
    assert is_loopback("127.8.0.1")
    assert is_loopback("::1")
    assert not is_loopback("0.0.0.0")
    assert not is_loopback("192.0.2.7")
    assert not is_loopback("no host has spaces")
