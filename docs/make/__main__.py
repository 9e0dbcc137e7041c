"""Run a script that makes a page or pictures: python docs/make NAME [ARGUMENTS]; without a name it lists them."""

import ast
import runpy
import sys
from pathlib import Path

ROOMS = sorted(path for path in Path(__file__).parent.iterdir() if path.is_dir() and path.name[0].isalpha())
SCRIPTS = {path.stem.removeprefix("make_"): path for room in ROOMS for path in sorted(room.glob("make_*.py"))}

#: Beginning of the sentence in a docstring that tells after which changes a script is run.
AFTER = "After a change of"


def described(name: str, script: Path) -> str:
    """Say what a script does, and after which changes it is run, if its docstring tells."""
    lines = (ast.get_docstring(ast.parse(script.read_text(encoding="utf-8"))) or "").splitlines()
    return "\n".join([f"{name:24}{lines[0]}", *(f"{'':24}{line}" for line in lines if line.startswith(AFTER))])


def main() -> None:
    """Run the script that is named; scripts of all rooms import each other by name."""
    if len(sys.argv) < 2 or sys.argv[1] not in SCRIPTS:
        sys.exit("\n".join(described(name, path) for name, path in SCRIPTS.items()))
    sys.path[:0] = [str(Path(__file__).parent), *map(str, ROOMS)]
    name = sys.argv.pop(1)
    runpy.run_path(str(SCRIPTS[name]), run_name="__main__")


if __name__ == "__main__":
    main()
