"""The nets of Theis 2019, figures 5 and 7, as a miner finds them."""

from pathlib import Path

from runglight._engine import PetriNet

FILL = "%QX0.0=1 & %QX0.1=0"
EMPTY = "%QX0.0=0 & %QX0.1=1"
Arc = tuple[str, str, str]
"""Label (empty for a silent transition), place before, place behind."""

_RUN = ("%IX0.1=0", FILL, "%IX0.1=1", "%IX0.2=1", "%IX0.0=1", EMPTY, "%IX0.0=0", "%IX0.2=0")
FIGURE_5: list[Arc] = [(label, f"p{n}", f"p{n + 1}") for n, label in enumerate(_RUN)]
FIGURE_7: list[Arc] = [*FIGURE_5, ("", "p8", "p1"), ("", "p8", "p9"), ("", "p2", "p3")]


def pnml(arcs: list[Arc], last: str) -> str:
    """The text of a net that begins at `p0` and ends at `last`."""
    places = sorted({place for _, *both in arcs for place in both})
    grammar = "http://www.pnml.org/version-2009/grammar"
    lines = [
        f'<pnml xmlns="{grammar}/pnml"><net id="n" type="{grammar}/ptnet">',
        '<name><text>tank</text></name><page id="g">',
    ]
    for place in places:
        mark = "<initialMarking><text>1</text></initialMarking>" if place == "p0" else ""
        lines.append(f'<place id="{place}">{mark}</place>')
    for number, (label, before, behind) in enumerate(arcs):
        name = label.replace("&", "&amp;")
        silent = "" if label else '<toolspecific tool="ProM" version="6.4" activity="$invisible$"/>'
        lines.append(
            f'<transition id="t{number}"><name><text>{name}</text></name>{silent}</transition>'
            f'<arc id="a{number}" source="{before}" target="t{number}"/>'
            f'<arc id="b{number}" source="t{number}" target="{behind}"/>'
        )
    lines.append(
        f'</page><finalmarkings><marking><place idref="{last}"><text>1</text></place></marking>'
        "</finalmarkings></net></pnml>"
    )
    return "\n".join(lines)


def write_net(path: Path, arcs: list[Arc], last: str) -> Path:
    """Writes the net as PNML."""
    path.write_text(pnml(arcs, last), encoding="utf-8")
    return path


def net(directory: Path, arcs: list[Arc], last: str) -> PetriNet:
    """The net, read from a file as a user's is."""
    return PetriNet.read_pnml(str(write_net(directory / f"{last}.pnml", arcs, last)))
