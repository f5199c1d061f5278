"""Makes the Debian roots that compat.py tests in, or brings them up to date, so that it finds them ready.

    make_roots.py [trixie|sid …]     default: both
"""

from __future__ import annotations

import sys

import roots
from common import guard


def main() -> int:
    missing = False
    for name in sys.argv[1:] or ["trixie", "sid"]:
        try:
            with roots.locked(name):
                roots.ensure(name)
        except roots.RootMissing as problem:
            missing = True
            print(f"{name} could not be made: {problem}", flush=True)
        else:
            print(f"{name} is ready", flush=True)
    return 1 if missing else 0


if __name__ == "__main__":
    sys.dont_write_bytecode = True
    guard(main)
