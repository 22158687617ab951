import pytest

from runglight.errors import InputError
from runglight.taps.url import parse_source


def test_numbered_options_are_taken_by_their_pattern() -> None:
    assert parse_source("s7://plc?db1=0-9&db20=4").options == {"db1": "0-9", "db20": "4"}


@pytest.mark.parametrize("option", ["db", "dba", "db*", "db1x", "xdb1", "db²"])
def test_what_only_looks_like_a_numbered_option_is_refused(option: str) -> None:
    with pytest.raises(InputError, match="unknown option"):
        parse_source(f"s7://plc?{option}=0-9")


def test_options_follow_a_topic_filter_that_ends_in_a_hash() -> None:
    url = parse_source("mqtt://user:a%23b@host/line/#?timeout=1s")
    assert (url.path, url.options, url.password) == ("line/#", {"timeout": "1s"}, "a#b")
    assert url.text == "mqtt://host/line/#?timeout=1s"
    assert parse_source("mqtt://host/line/#").path == "line/#"
