"""Runs benches: tests/bench/NAME.py writes build/bench/NAME.json; without a name, all of them.

A bench gets the path of its file as `--out PATH`, after `--`, and then all from the first argument on that begins with `-`.
One whose first line holds `# runs in Blender` runs inside `blender --background`, the others in Debian's Python. The file is
JSON with a list `goals` of {"name", "value", "goal", "holds"}; a goal that does not hold makes the run fail.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

from common import ADDON, BUILD, PYTHON, REPO, STAGE, Problem, guard

BENCHES = REPO / "tests" / "bench"
OUT = BUILD / "bench"


def run(name: str, options: list[str]) -> bool:
    """Runs one bench and prints its goals; True if they all hold."""
    script = BENCHES / f"{name}.py"
    if not script.is_file():
        known = ", ".join(sorted(p.stem for p in BENCHES.glob("*.py") if p.stem != "conftest"))
        raise Problem(f"there is no bench {name}; there are: {known or 'none yet'}")
    path = OUT / f"{name}.json"
    OUT.mkdir(parents=True, exist_ok=True)
    path.unlink(missing_ok=True)
    env = os.environ | {"MESOSHELL_NATIVE_PATH": str(STAGE), "PYTHONPATH": f"{STAGE}:{ADDON.parent}",
                        "PYTHONDONTWRITEBYTECODE": "1"}
    inside = "# runs in Blender" in script.read_text().split("\n", 1)[0]
    start = ["blender", "--background", "--factory-startup", "--python-exit-code", "1", "--python", script] if inside \
        else [PYTHON, script]
    status = subprocess.run([*map(str, start), "--", "--out", str(path), *options], env=env, cwd=REPO).returncode
    if status or not path.is_file():
        raise Problem(f"the bench {name} ended with status {status}"
                      + ("" if path.is_file() else f" and wrote no {path.relative_to(REPO)}") + "; see above")
    goals = json.loads(path.read_text()).get("goals")
    if goals is None:
        raise Problem(f"{path.relative_to(REPO)} has no list `goals`; the bench must write one, if only an empty one")
    for goal in goals:
        print(f"{'holds' if goal['holds'] else 'FAILS'}  {goal['name']}: {goal['value']} (goal: {goal['goal']})")
    print(f"{path.relative_to(REPO)}")
    return all(goal["holds"] for goal in goals)


def main() -> int:
    given = sys.argv[1:]
    first = next((i for i, word in enumerate(given) if word.startswith("-")), len(given))
    names, options = given[:first] or sorted(p.stem for p in BENCHES.glob("*.py")), given[first:]
    if not names:
        raise Problem("tests/bench has no bench yet")
    return 0 if all([run(name, options) for name in names]) else 1


if __name__ == "__main__":
    sys.dont_write_bytecode = True
    guard(main)
