"""Runs the Blender tests inside Blender, in a window or in the background.

    blender [--background] --factory-startup --python tests/blender/run.py -- \\
        --package source|installed --mode background|window --junit FILE [pytest arguments]

source     the add-on from this source tree; MESOSHELL_NATIVE_PATH is the folder of the compiled module
installed  the add-on that is installed in this Blender; nothing may come from the source tree then

The exit status is pytest's; the JUnit file is written even when the add-on can not be enabled.
"""

import argparse
import os
import sys
import traceback
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

import bpy

HERE = Path(__file__).resolve().parent
sys.dont_write_bytecode = True
sys.path.insert(0, str(HERE))

import session  # noqa: E402  (it lies beside this file)


def main():
    options, pytest_arguments = parse(sys.argv[sys.argv.index("--") + 1:])
    status = 2
    try:
        if bpy.app.background != (options.mode == "background"):
            raise RuntimeError(f"--mode {options.mode} does not fit how this Blender was started")
        session.start(options.package, options.mode)
        status = run_pytest(options.junit, pytest_arguments)
    except BaseException:
        traceback.print_exc()
        write_failure(options.junit, traceback.format_exc())
    finally:
        # Not sys.exit: in a timer Blender only prints SystemExit, and in the background it goes on to its own exit code.
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(int(status))


def parse(arguments):
    parser = argparse.ArgumentParser(prog="run.py")
    parser.add_argument("--package", choices=("source", "installed"), required=True)
    parser.add_argument("--mode", choices=("background", "window"), required=True)
    parser.add_argument("--junit", type=Path, required=True)
    return parser.parse_known_args(arguments)


def run_pytest(junit, arguments):
    try:
        import pytest
    except ModuleNotFoundError as error:
        raise RuntimeError(f"Blender's Python {sys.version.split()[0]} has no pytest: install python3-pytest") from error
    junit.parent.mkdir(parents=True, exist_ok=True)
    named = any(not argument.startswith("-") and Path(argument.split("::")[0]).exists() for argument in arguments)
    return pytest.main(["-p", "no:cacheprovider", "--rootdir", str(HERE), "-c", os.devnull, "-ra",
                        f"--junitxml={junit}", *arguments, *([] if named else [str(HERE)])])


def write_failure(junit, text):
    junit.parent.mkdir(parents=True, exist_ok=True)
    message = quoteattr(text.strip().splitlines()[-1])
    junit.write_text('<?xml version="1.0" encoding="utf-8"?>\n<testsuites><testsuite name="pytest" errors="1" failures="0" '
                     'skipped="0" tests="1"><testcase classname="run" name="the session starts">'
                     f'<error message={message}>{escape(text)}</error></testcase></testsuite></testsuites>\n')


if bpy.app.background:
    main()
else:
    # From a timer, because only the event loop gives a window, a redraw and an undo stack. The splash would take the events.
    bpy.context.preferences.view.show_splash = False
    bpy.app.timers.register(main, first_interval=0.5)
