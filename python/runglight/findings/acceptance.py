"""Which findings an operator may accept into the model."""

from runglight.errors import InputError
from runglight.findings.finding import Finding
from runglight.findings.schema import CONFIRMABLE_KINDS


def refuse_without_path(finding: Finding) -> None:
    """InputError for a finding that has no path to accept."""
    if finding.kind not in CONFIRMABLE_KINDS:
        kinds = " and ".join(CONFIRMABLE_KINDS)
        raise InputError(
            f"{finding.id} is of kind {finding.kind} and has no path to accept; "
            f"only {kinds} findings can be confirmed"
        )
    if not finding.path:
        raise InputError(
            f"{finding.id} has no path: {finding.place} did not come back to known transitions; "
            "confirm it once a watched log shows that it does"
        )


def may_be_accepted(finding: Finding) -> bool:
    """Whether it has a path to accept."""
    return finding.kind in CONFIRMABLE_KINDS and bool(finding.path)
