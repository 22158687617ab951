"""What runglight raises.

RunglightError          base of all; its text is one sentence for the user
├── InputError          a log, table, parameter or path cannot be used: what, where, the mend
└── ModelError          a model directory is missing, too old, or damaged

They are defined in the compiled engine, so that an error raised there and one raised here are
the same class.
"""

from runglight._engine import InputError, ModelError, RunglightError

__all__ = ["InputError", "ModelError", "RunglightError"]
