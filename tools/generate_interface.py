"""Write the C++ struct of the uniform block: generate_interface.py INTERFACE_TOML HEADER."""

import importlib.util
import sys
from pathlib import Path


def main():
    source = Path(__file__).resolve().parent.parent / "addon" / "mesoshell" / "core" / "interface.py"
    spec = importlib.util.spec_from_file_location("interface", source)
    interface = importlib.util.module_from_spec(spec)
    sys.modules["interface"] = interface
    spec.loader.exec_module(interface)
    Path(sys.argv[2]).write_text(interface.load(sys.argv[1]).cpp_header(), encoding="utf-8")


main()
