"""The main job on a real scene, in a Blender window: bakes the chain-mail tile, puts it on the torus, pictures it four ways.

tools/demo_job.py does the work inside Blender; this starts it and prints its table.
"""

from __future__ import annotations

import json
import sys

import blender_job
from common import BUILD, REPO, STAGE, Problem, guard
from machines import Here
from results import tail

OUT = BUILD / "demo"


def print_table(report: dict) -> None:
    print(f"\nBlender {report['blender']}, {report['renderer']}\n")
    print(f"{'stage':<34}{'seconds':>9}{'peak MB':>9}")
    for stage in report["stages"]:
        print(f"{stage['name']:<34}{stage['seconds']:>9.2f}{stage['peak_mb']:>9.0f}  {stage['note']}")
    print(f"\n{'picture':<22}{'against':<18}how far they differ")
    for row in report["differences"]:
        print(f"{row['picture']:<22}{row['against']:<18}{row['text']}")
    print("\n" + "\n".join(report["files"]))


def main() -> int:
    place = blender_job.Place(Here(), BUILD / "demo-run")
    place.prepare()
    log = place.folder / "demo.log"
    OUT.mkdir(parents=True, exist_ok=True)
    report = OUT / "demo.json"
    report.unlink(missing_ok=True)
    argv = ["blender", "--factory-startup", "--python-exit-code", "1", "--window-geometry", "0", "0", "1280", "800",
            REPO / "blend_samples/chain_torus.blend", "--python", REPO / "tools/demo_job.py", "--", "--out", OUT]
    print("baking and drawing blend_samples/chain_torus.blend in Blender …", flush=True)
    status, _seconds = place.run(argv, log, env={"MESOSHELL_NATIVE_PATH": str(STAGE)}, window=True)
    if status != 0 or not report.is_file():
        raise Problem(f"the job in Blender ended with status {status}; the end of {log}:\n{tail(log)}")
    print_table(json.loads(report.read_text()))
    return 0


if __name__ == "__main__":
    sys.dont_write_bytecode = True
    guard(main)
