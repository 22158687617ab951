"""Secrets of a configuration: hidden, and put back."""

import pytest

from runglight.errors import InputError
from runglight.server.secrets_in_text import HIDDEN, hidden, restored

TEXT = """[source]
url = "mqtt://ann:s3cret@broker/topic/#"
[watch]
store = "postgresql://bob:pass word@db/x"
[notify]
webhook = "https://hook.example/x?token=abcdef&y=1"
password = 'p w'
"""


def test_nothing_secret_is_left() -> None:
    shown = hidden(TEXT)
    for secret in ("s3cret", "abcdef", "p w'"):
        assert secret not in shown
    assert "mqtt://ann:" in shown
    assert "&y=1" in shown


def test_what_was_hidden_comes_back() -> None:
    assert restored(hidden(TEXT), TEXT) == TEXT


def test_a_new_secret_is_taken() -> None:
    changed = hidden(TEXT).replace(f"ann:{HIDDEN}@", "ann:new@")
    assert "ann:new@broker" in restored(changed, TEXT)


def test_a_secret_that_was_moved_is_not_lost_in_silence() -> None:
    with pytest.raises(InputError, match="line 1"):
        restored(f'url = "mqtt://eve:{HIDDEN}@broker"', TEXT)
