"""What `spark-submit` is given.

    spark-submit [ITS OPTIONS] $(python -m runglight.scale.submit) watch …

It takes a file, not a module or a command; run as a module, this one says where it is.
"""

import sys


def main() -> int:
    """Runs `runglight spark` with the arguments `spark-submit` passes on."""
    from runglight.cli import main as command_line  # noqa: PLC0415

    return command_line(["spark", *sys.argv[1:]])


if __name__ == "__main__":
    if __spec__ is not None:
        print(__file__)
    else:
        sys.exit(main())
