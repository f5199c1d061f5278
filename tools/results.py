"""Test results: read from junit files of pytest and CTest, merged, printed, counted."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, field
from pathlib import Path

PASSED, FAILED, SKIPPED = "passed", "failed", "skipped"

# Failures of a layer that are printed at length; of the others only the last line.
SHOWN = 8


@dataclass
class Case:
    """One test."""
    name: str
    status: str
    message: str = ""
    seconds: float = 0.0


@dataclass
class Layer:
    """The tests of one run: of one program in one mode."""
    name: str
    cases: list[Case] = field(default_factory=list)
    seconds: float = 0.0

    def count(self, status: str) -> int:
        return sum(c.status == status for c in self.cases)

    def add(self, name: str, ok: bool, message: str = "", seconds: float = 0.0) -> bool:
        """Adds a test that is no test function, such as "the package installs"; gives `ok` back."""
        self.cases.append(Case(name, PASSED if ok else FAILED, "" if ok else message, seconds))
        return ok


def tail(path: Path, lines: int = 40) -> str:
    """The end of a log."""
    try:
        text = path.read_text(errors="replace").splitlines()
    except OSError:
        return f"(no log at {path})"
    return "\n".join(text[-lines:])


def from_junit(path: Path) -> list[Case]:
    """The cases of a junit file; empty where there is no file or a broken one."""
    try:
        root = ElementTree.parse(path).getroot()
    except (OSError, ElementTree.ParseError):
        return []
    return [_case(node) for node in root.iter("testcase")]


def _case(node: ElementTree.Element) -> Case:
    name = node.get("name", "")
    if node.get("classname") not in (None, "", name):
        name = f"{node.get('classname')}.{name}"
    seconds = float(node.get("time") or 0.0)
    for child in node:
        text = (child.get("message") or "") if child.text is None else child.text
        if child.tag in ("failure", "error"):
            return Case(name, FAILED, text.strip() or _output(node), seconds)
        if child.tag == "skipped":
            # pytest has the reason in `message`; CTest says there only that a pattern matched, the reason is in the output.
            reason = child.get("message") or text
            if reason.startswith("SKIP_REGULAR_EXPRESSION"):
                reason = _gtest_skip_reason(_output(node))
            return Case(name, SKIPPED, reason.strip(), seconds)
    if node.get("status") in ("fail", "notrun", "disabled"):  # CTest
        status = FAILED if node.get("status") != "disabled" else SKIPPED
        return Case(name, status, _output(node) or f"CTest says: {node.get('status')}", seconds)
    return Case(name, PASSED, "", seconds)


def _output(node: ElementTree.Element) -> str:
    return "\n".join((node.findtext(tag) or "").strip() for tag in ("system-out", "system-err")).strip()


def _gtest_skip_reason(text: str) -> str:
    match = re.search(r"Skipped\n(.*?)\n", text, re.DOTALL)
    return match[1] if match else text[-300:]


def summary(layers: list[Layer]) -> str:
    """The line that everything ends with."""
    return ", ".join(f"{sum(x.count(s) for x in layers)} {s}" for s in (PASSED, FAILED, SKIPPED))


def print_layers(layers: list[Layer]) -> None:
    """A table of the layers, the reason of each skip, the message of each failure."""
    width = max([len(x.name) for x in layers] + [5])
    print(f"\n{'layer':<{width}}  passed  failed  skipped  seconds")
    for x in layers:
        print(f"{x.name:<{width}}  {x.count(PASSED):6}  {x.count(FAILED):6}  {x.count(SKIPPED):7}  {x.seconds:7.1f}")
    skipped: dict[tuple[str, str], list[str]] = {}
    for x in layers:
        for case in x.cases:
            if case.status == SKIPPED:
                skipped.setdefault((x.name, case.message.splitlines()[0] if case.message else "no reason given"),
                                   []).append(case.name)
    for (layer, reason), names in skipped.items():
        shown = ", ".join(names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")
        print(f"\nskipped in {layer}: {shown}\n    {reason}")
    for x in layers:
        failed = [c for c in x.cases if c.status == FAILED]
        for number, case in enumerate(failed):
            lines = case.message.strip().splitlines() or ["no message"]
            if number >= SHOWN:
                lines = lines[-1:]
            elif len(lines) > 60:
                lines = [*lines[:20], f"… {len(lines) - 60} lines left out …", *lines[-40:]]
            print(f"\nFAILED in {x.name}: {case.name}")
            print("\n".join(f"    {line}" for line in lines))
    print()
