"""The exit codes, the same for every command."""

DONE = 0
FINDINGS = 1
"""`--fail-on` was met."""
WRONG = 2
"""Wrong use or bad input; one line on standard error says what, where and the mend."""
INTERRUPTED = 130
