"""The Blender session that the tests run in: how the add-on is enabled, and what this session can do."""

import importlib
import os
import sys
from pathlib import Path

import addon_utils
import bpy

ROOT = Path(__file__).resolve().parents[2]
INSTALLED = ("bl_ext.user_default.mesoshell", "mesoshell")

package = None  # "source" or "installed"
mode = None  # "background" or "window"
module_name = None  # "mesoshell" or "bl_ext.user_default.mesoshell"
gpu_problem = None  # why `gpu` tests can not run, or None


def start(chosen_package, chosen_mode):
    """Enables the add-on; raises RuntimeError if that fails or if it is not the one asked for."""
    global package, mode, module_name, gpu_problem
    package, mode = chosen_package, chosen_mode
    module_name = enable(package)
    gpu_problem = _start_gpu() if mode == "background" else None
    print(f"Blender {bpy.app.version_string}, Python {sys.version.split()[0]}, {mode}, {module_name} from "
          f"{addon().__file__}", flush=True)


def enable(chosen_package):
    """Enables the add-on and returns its module's name."""
    if chosen_package == "source":
        sys.path.insert(0, str(ROOT / "addon"))
        name = _enable(("mesoshell",))
    else:
        name = _enable(INSTALLED if bpy.app.version >= (4, 2, 0) else INSTALLED[1:])
    inside = ROOT / "addon" in Path(sys.modules[name].__file__).resolve().parents
    if inside != (chosen_package == "source"):
        raise RuntimeError(f"{name} is {sys.modules[name].__file__}, which is not the add-on to be tested")
    return name


def addon():
    return importlib.import_module(module_name)


def part(name):
    """A module of the add-on, whichever package it is in: part("host.shells")."""
    return importlib.import_module(f"{module_name}.{name}")


def _enable(names):
    for name in names:
        if addon_utils.check(name)[1] or addon_utils.enable(name, default_set=False) is not None:
            return name
    raise RuntimeError(f"The add-on could not be enabled as {' or '.join(names)}; the lines above say why")


def _start_gpu():
    if bpy.app.version < (5, 2, 0):
        return "Blender before 5.2 has no GPU in the background"
    import gpu
    gpu.init()
    print(f"gpu.init(): {gpu.platform.backend_type_get()}, {gpu.platform.renderer_get()}", flush=True)
    return None


def blender_arguments():
    """The start of a command line for another Blender like this one (without the mode)."""
    arguments = [bpy.app.binary_path]
    if package == "source":
        arguments.append("--factory-startup")
    backend = next((sys.argv[i + 1] for i, word in enumerate(sys.argv[:-1]) if word == "--gpu-backend"), None)
    return arguments + (["--gpu-backend", backend] if backend else [])


def blender_environment():
    """For another Blender: the same add-on, and no bytecode left beside the tests."""
    return os.environ | {"PYTHONDONTWRITEBYTECODE": "1", "MESOSHELL_TEST_PACKAGE": package}
