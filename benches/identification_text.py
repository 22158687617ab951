"""The sentences of docs/reference/identification.md."""

HEAD = """# How well addresses are identified

Cadiou 2019 reports one machine. Here is its case study on a simulated one of the same kind
([the bottling machine](bottling.md)), whose truth is known, repeated with many seeds. Everything
goes the whole way: the machine's PLC is read over Modbus TCP, 100 `%M` and 300 `%MW` once a second
for three minutes; somebody goes through the photos and declares what is to be seen on them, and
`identify` ranks all that changes, some 350 words and bits.

Whoever declares is human: an event is seen on the first photo after it (up to a second late),
declared up to another second late, and in one case of twenty not at all. What is declared is what
the machine does, never what an address does.

The computer that measured was overloaded: one recording of six lacks one to three scans, told as a
gap, because a reply took longer than the half second a tap waits.

Measured with `python -m benches.identification` and `python -m benches.proposed_identification`;
the numbers are in [identification.json](identification.json).
"""

TITLES = {
    "The two case studies": """*First* means: every address of rank 1 is right, or changes in the
same scans as a right one, so that no ranking could tell them apart.

Two orders are compared. *By score in, then score out* is how the paper orders its tables, and what
`runglight identify` prints. *By agreement* (`--order agreement`) orders what that has selected
anew: events and changes are matched one by one, all at nearly the same lag, and what finds no
partner counts against the address.""",
    "What is ranked first where it is wrong": """The scores compare numbers. With τ = 10 s a window
holds a group of three or four bottles, and whatever changes three or four times in it is as good
as the counter: the eight-second bit of a clock, a bit of the tank's level. Where an event was
missed, it is better. That it goes on ticking outside of the windows is in the score out, which is
looked at only between equals.""",
    "Events from the photos alone": """Nobody declares anything: `runglight identify --propose`
finds the events in a rectangle of the photos. For the parts it lies behind station 2, where every
bottle passes (by look, label `away`); for the conveyor on the side of the belt, whose marks move
(by motion).""",
}

TAIL = """
## What to learn from it

- Record what sets your variable apart. What the panel's buttons do, the conveyor does too while it
  is moved by hand; only that it starts by itself afterwards tells them apart. A recording with one
  such start, and that one not declared, cannot be decided by anybody. The conveyor case has about
  two.
- A wide τ merges windows. Where parts come in groups, a window holds a group, and only the numbers
  count. Take τ no wider than the delay you expect, and let `--tau sweep` suggest one.
- What means the same changes in the same scans. Four words count bottles, and `identify` says that
  they are the same; so does a measured value that is zero where a motor stands.
"""
