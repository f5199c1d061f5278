"""Finds and loads the compiled module `mesoshell_native`, on first use.

Everything else writes `from ..core import native` and calls `native.module()`.
"""

import importlib
import importlib.machinery
import importlib.util
import os
import sys

NAME = "mesoshell_native"
ENVIRONMENT = "MESOSHELL_NATIVE_PATH"


class NativeMissing(RuntimeError):
    """The compiled module can not be loaded; the text is one sentence that says why and what to do."""


_module = None
_problem = None


def module():
    """The module `mesoshell_native`; raises NativeMissing.

    Looked for in the folder that MESOSHELL_NATIVE_PATH names (and then nowhere else), in the add-on's own `native`
    folder, and among the installed packages (an extension's wheel).
    """
    global _module, _problem
    if _module is not None:
        return _module
    if _problem is not None:
        raise NativeMissing(_problem)
    try:
        _module = _load()
    except NativeMissing as error:
        _problem = str(error)
        raise
    return _module


def folders():
    """The folders that are searched before the installed packages, in order."""
    chosen = os.environ.get(ENVIRONMENT)
    if chosen:
        return [chosen]
    package = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    return [os.path.join(package, "native")]


def _load():
    searched = folders()
    for folder in searched:
        spec = importlib.machinery.PathFinder.find_spec(NAME, [folder])
        if spec is not None and spec.loader is not None:
            return _run(spec, folder)
    if os.environ.get(ENVIRONMENT):
        raise NativeMissing(
            f"{ENVIRONMENT} is {searched[0]}, where there is no {NAME}: build it there, or unset the variable")
    try:
        return importlib.import_module(NAME)
    except ModuleNotFoundError as error:
        raise NativeMissing(
            f"The compiled module {NAME} is not installed (searched {searched[0]} and the installed packages): "
            "install the packaged add-on again") from error
    except Exception as error:
        raise NativeMissing(_refused("the installed packages", error)) from error


def _run(spec, folder):
    loaded = None
    try:
        loaded = importlib.util.module_from_spec(spec)
        # Registered before it runs, as the import statement does, so that a plain import finds the same module.
        sys.modules[NAME] = loaded
        spec.loader.exec_module(loaded)
    except Exception as error:
        if sys.modules.get(NAME) is loaded:
            sys.modules.pop(NAME, None)
        raise NativeMissing(_refused(folder, error)) from error
    return loaded


def _refused(where, error):
    return (f"The compiled module {NAME} in {where} does not load ({error}): Mesoshell needs Linux x86-64 with "
            "glibc 2.34 or later and Python 3.11 or later")
