"""The tank of Theis 2019 under its counting program, as a log and as the net of its runs."""

from pathlib import Path

import pyarrow as pa

from runglight.log.changelog import Log

RESET = "%IX0.1=0"

FULL, LOW, MIDDLE, INLET, OUTLET = "%IX0.0", "%IX0.1", "%IX0.2", "%QX0.0", "%QX0.1"

SECOND = 1_000_000_000

Change = tuple[str, int]

FILL: list[Change] = [(INLET, 1), (OUTLET, 0)]
DRAIN: list[Change] = [(INLET, 0), (OUTLET, 1)]


def changes(runs: int, fillings: int = 3) -> list[tuple[float, list[Change]]]:
    """What changes when: filled to the top, drained to the middle, `fillings` times; then emptied.

    Seconds for gallons at 9 a second.
    """
    now = 0.0
    happened: list[tuple[float, list[Change]]] = []

    def after(seconds: float, what: list[Change]) -> None:
        nonlocal now
        now += seconds
        happened.append((now, what))

    after(0.0, [(FULL, 0), (LOW, 1), (MIDDLE, 0), (INLET, 0), (OUTLET, 1)])
    for _ in range(runs):
        after(4.4, [(LOW, 0)])
        after(0.1, FILL)
        after(0.1, [(LOW, 1)])
        for filling in range(fillings):
            if filling > 0:
                after(0.1, FILL)
            after(0.1 if filling else 4.4, [(MIDDLE, 1)])
            after(4.4, [(FULL, 1)])
            after(0.1, DRAIN)
            after(0.1, [(FULL, 0)])
            after(4.4, [(MIDDLE, 0)])
    after(4.4, [(LOW, 0)])
    return happened


def log_of(happened: list[tuple[float, list[Change]]]) -> Log:
    """The change log of what happened."""
    rows = [(round(t * 10) * SECOND // 10, s, v) for t, what in happened for s, v in what]
    times, signals, values = zip(*rows, strict=True)
    return Log.from_arrow(
        pa.table(
            {
                "time": pa.array(times, pa.timestamp("ns", "UTC")),
                "signal": pa.array(signals, pa.string()).dictionary_encode(),
                "value": pa.array(values, pa.int64()),
            }
        )
    )


def write_net(path: Path, *, without: str | None = None) -> Path:
    """PNML: a run opens, and then fills and drains any number of times."""
    arcs = [
        ("%IX0.1=0", 0, 1),
        (None, 1, 2),
        ("%QX0.0=1 & %QX0.1=0", 2, 3),
        ("%IX0.1=1", 3, 4),
        (None, 3, 4),
        ("%IX0.2=1", 4, 5),
        ("%IX0.0=1", 5, 6),
        ("%QX0.0=0 & %QX0.1=1", 6, 7),
        ("%IX0.0=0", 7, 8),
        ("%IX0.2=0", 8, 9),
        (None, 9, 2),
    ]
    lines = ['<pnml><net id="tank" type="http://www.pnml.org/version-2009/grammar/pnmlcoremodel">']
    lines.append('<page id="page">')
    for place in range(10):
        token = "<initialMarking><text>1</text></initialMarking>" if place == 0 else ""
        lines.append(f'<place id="p{place}">{token}</place>')
    for number, (label, source, target) in enumerate(arcs):
        if label is not None and label == without:
            continue
        name = "" if label is None else f"<name><text>{label.replace('&', '&amp;')}</text></name>"
        tool = (
            '<toolspecific tool="ProM" version="6.4" activity="$invisible$"/>'
            if label is None
            else ""
        )
        lines.append(f'<transition id="t{number}">{name}{tool}</transition>')
        lines.append(f'<arc id="i{number}" source="p{source}" target="t{number}"/>')
        lines.append(f'<arc id="o{number}" source="t{number}" target="p{target}"/>')
    lines.append("</page><finalmarkings><marking>")
    lines.append('<place idref="p9"><text>1</text></place>')
    lines.append("</marking></finalmarkings></net></pnml>")
    path.write_text("".join(lines), encoding="utf-8")
    return path
