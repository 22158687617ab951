"""Writes the pages of docs/reference that follow from the code; `--check` fails on drift."""

import ast
import inspect
import os
import subprocess
import sys
import tempfile
from itertools import pairwise
from pathlib import Path
from typing import Any

import msgspec

from runglight import environment
from runglight.cli import exit_codes
from runglight.cli.application import COMMANDS, application
from runglight.configuration import Configuration
from runglight.findings.schema import finding_schema

README = Path(__file__).parent.parent / "README.md"
SESSION_START, SESSION_END = "<!-- session: written by make docs -->", "<!-- end of session -->"
SESSION = (
    "runglight simulate cell --log nominal.csv --symbols symbols.csv",
    "runglight learn nominal.csv --symbols symbols.csv -o cell.model",
    "runglight simulate cell --log today.csv --seed 2 --fault 10",
    "runglight watch cell.model today.csv",
)
REFERENCE = Path(__file__).parent / "reference"
NOTE = "<!-- Written by docs/generate.py; change the code, then run `make docs`. -->\n\n"


def docstrings(room: object) -> dict[str, str]:
    """The sentence below each assignment of a class, what it inherits too, or of a module."""
    inherited: dict[str, str] = {}
    for base in room.__bases__ if isinstance(room, type) else ():
        if base.__module__.startswith("runglight"):
            inherited |= docstrings(base)
    tree = ast.parse(inspect.getsource(room))  # type: ignore[arg-type]
    body = tree.body[0].body if isinstance(tree.body[0], ast.ClassDef) else tree.body
    said = inherited
    for statement, after in pairwise(body):
        if (
            isinstance(statement, ast.AnnAssign | ast.Assign)
            and isinstance(after, ast.Expr)
            and isinstance(after.value, ast.Constant)
        ):
            target = (
                statement.target if isinstance(statement, ast.AnnAssign) else statement.targets[0]
            )
            if isinstance(target, ast.Name):
                said[target.id] = " ".join(str(after.value.value).split())
    return said


REGIONS_TABLE = """
## [regions]

Bits of the cycle machine watched as one word, under names of your own: a range (`"I0.0-I7.7"`,
`"I8-I20 by byte"`), or a list of addresses or names, the first the highest bit. Without it, or with
`regions = "auto"` above all tables, regions are proposed from the log.
"""


def configuration_page() -> str:
    """Every table and key of runglight.toml."""
    page = (
        NOTE
        + "# runglight.toml\n\nOne file describes a machine. `runglight` reads `runglight.toml` "
        "of the current directory, or the file named with `-c`; options of the command line beat "
        "it. Paths are relative to the file. An unknown key is an error.\n"
    )
    for table in msgspec.structs.fields(Configuration):
        if table.name == "regions":
            page += REGIONS_TABLE
            continue
        sentence = (inspect.getdoc(table.type) or "").partition(": ")[2]
        page += f"\n## [{table.name}]\n\n{sentence[:1].upper()}{sentence[1:]}\n\n"
        page += "| key | default | meaning |\n|---|---|---|\n"
        sentences = docstrings(table.type)
        for field in msgspec.structs.fields(table.type):
            default = (
                field.default_factory()
                if field.default_factory is not msgspec.NODEFAULT
                else field.default
            )
            shown = "" if default is None else f"`{_toml(default)}`"
            page += f"| `{field.encode_name}` | {shown} | {sentences[field.name]} |\n"
    return page


def _toml(value: Any) -> str:
    return msgspec.json.encode(value).decode()


def finding_page() -> str:
    """Every key of a finding."""
    schema = finding_schema()
    page = (
        NOTE + "# Finding\n\n"
        "One finding is one JSON object, the same in JSON lines, SQLite and Python. Every key is "
        "always there; what does not apply is null or an empty list. The JSON Schema (draft "
        "2020-12) is `runglight.finding_schema()`. CSV has the keys as columns, with lists as "
        "JSON.\n\n| key | type | meaning |\n|---|---|---|\n"
    )
    for key, about in schema["properties"].items():
        page += f"| `{key}` | {_type(about)} | {about['description']} |\n"
    page += "\n`expected` holds objects:\n\n| key | type | meaning |\n|---|---|---|\n"
    for key, about in schema["properties"]["expected"]["items"]["properties"].items():
        page += f"| `{key}` | {_type(about)} | {about['description']} |\n"
    page += "\n`suspects` holds objects:\n\n| key | type | meaning |\n|---|---|---|\n"
    for key, about in schema["properties"]["suspects"]["items"]["properties"].items():
        page += f"| `{key}` | {_type(about)} | {about['description']} |\n"
    return page


def _type(about: dict[str, Any]) -> str:
    if "enum" in about:
        return ", ".join(f"`{value}`" for value in about["enum"])
    kinds = about["type"] if isinstance(about["type"], list) else [about["type"]]
    return " or ".join(kinds)


def command_page() -> str:
    """The manual of every command."""
    page = NOTE + "# Command line\n\n"
    page += "| command | what it does |\n|---|---|\n"
    for name, (_, sentence) in COMMANDS.items():
        page += f"| [`runglight {name}`](#runglight-{name}) | {sentence} |\n"
    page += (
        "\nResults go to standard output, progress and notes to standard error. Files named with "
        "`-o` appear whole or not at all.\n\n## Exit codes\n\n| code | meaning |\n|---|---|\n"
        f"| {exit_codes.DONE} | done |\n"
        f"| {exit_codes.FINDINGS} | `--fail-on` was met |\n"
        f"| {exit_codes.WRONG} | wrong use or bad input; one line on standard error says what, "
        "where and the mend |\n"
        f"| {exit_codes.INTERRUPTED} | interrupted |\n\n"
        "## Environment variables\n\n| variable | meaning |\n|---|---|\n"
    )
    for constant, sentence in docstrings(environment).items():
        page += f"| `{getattr(environment, constant)}` | {sentence} |\n"
    page += "| `NO_COLOR`, `FORCE_COLOR` | as everywhere |\n"
    manual = application().generate_docs(output_format="markdown", recursive=True)
    return page + "\n" + manual[manual.index("## runglight demo") :].strip() + "\n"


def readme_with_session() -> str:
    """The README with its session run anew; numbers of speed differ from run to run."""
    before, _, rest = README.read_text(encoding="utf-8").partition(SESSION_START)
    _, _, after = rest.partition(SESSION_END)
    shown = ""
    with tempfile.TemporaryDirectory() as directory:
        for command in SESSION:
            ended = subprocess.run(
                [sys.executable, "-m", *command.split()],
                cwd=directory,
                env=os.environ | {"COLUMNS": "118", "CI": "true"},
                stdin=subprocess.DEVNULL,
                capture_output=True,
                encoding="utf-8",
                check=False,
            )
            if ended.returncode != 0:
                raise RuntimeError(f"{command}: {ended.stderr}")
            lines = [line.rstrip() for line in ended.stdout.rstrip().splitlines()]
            shown += f"$ {command}\n" + "\n".join(lines) + "\n\n"
    return f"{before}{SESSION_START}\n```console\n{shown.rstrip()}\n```\n{SESSION_END}{after}"


def main() -> int:
    """Writes the pages, or with `--check` names those that differ."""
    pages = {
        "cli.md": command_page(),
        "configuration.md": configuration_page(),
        "finding.md": finding_page(),
    }
    if "--check" not in sys.argv[1:]:
        README.write_text(readme_with_session(), encoding="utf-8")
    drifted = []
    for name, text in pages.items():
        path = REFERENCE / name
        if "--check" not in sys.argv[1:]:
            path.write_text(text, encoding="utf-8")
        elif not path.exists() or path.read_text(encoding="utf-8") != text:
            drifted.append(str(path))
    if drifted:
        print(f"{', '.join(drifted)} differ from the code: run make docs", file=sys.stderr)
    return 1 if drifted else 0


if __name__ == "__main__":
    sys.exit(main())
