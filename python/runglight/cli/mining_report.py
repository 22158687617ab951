"""What mining found, for people."""

from __future__ import annotations

from typing import TYPE_CHECKING

from runglight.cli.counted import counted

if TYPE_CHECKING:
    from rich.console import Console

    from runglight.process.event_log import EventLog
    from runglight.process.petri_net import PetriNet, Quality, Soundness


def print_report(console: Console, events: EventLog, net: PetriNet, quality: Quality) -> None:
    """Runs, activities, the net, whether it is sound, fitness and precision."""
    soundness, fitness, precision = quality
    silent = sum(transition.label is None for transition in net.transitions)
    lines = [
        f"Runs        {counted(events.traces, 'trace')} of {counted(len(events), 'event')}, "
        f"{_activities(len(events.activities))}",
        f"Net         {counted(len(net.places), 'place')}, "
        f"{counted(len(net.transitions), 'transition')}, {silent} of them silent",
        f"Sound       {_sound(soundness)}",
        *(f"            {problem}" for problem in soundness.problems),
        f"Fitness     {fitness.fitness:.4f}, {fitness.fitting:,} of "
        f"{counted(fitness.traces, 'trace')} fit",
        f"Precision   {precision:.4f}",
    ]
    for line in lines:
        console.print(line, markup=False, soft_wrap=True)


def _activities(count: int) -> str:
    return "1 activity" if count == 1 else f"{count:,} activities"


def _sound(soundness: Soundness) -> str:
    if soundness.sound is None:
        return f"not known: more than {soundness.markings:,} markings"
    return "yes" if soundness.sound else "no"
