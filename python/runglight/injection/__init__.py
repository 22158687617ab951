"""Faults put into a change log, simulated or real, with the truth about each as a label."""

from runglight.injection.distribution import Distribution, distribution
from runglight.injection.inject import Injected, inject, inject_with
from runglight.injection.kinds import InjectionKind
from runglight.injection.labels import InjectionLabel, read_labels, write_labels
from runglight.injection.plan import InjectionPlan
from runglight.injection.score import KindScore, Score, score

__all__ = [
    "Distribution",
    "Injected",
    "InjectionKind",
    "InjectionLabel",
    "InjectionPlan",
    "KindScore",
    "Score",
    "distribution",
    "inject",
    "inject_with",
    "read_labels",
    "score",
    "write_labels",
]
