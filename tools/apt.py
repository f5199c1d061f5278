"""What this machine's apt is told, for use in a Debian root: the mirror and the way to it."""

from __future__ import annotations

import re
from pathlib import Path

from common import output

DEFAULT_MIRROR = "http://deb.debian.org/debian"

# Settings of Acquire that say how to reach a mirror. Programs for proxy detection stay behind: a root lacks them.
SETTINGS = re.compile(r"Acquire::(https?::|ftp::|Check-Valid-Until |Check-Date |Retries |ForceIPv[46] )", re.IGNORECASE)


def sources(etc_apt: Path = Path("/etc/apt")) -> list[tuple[str, str]]:
    """(URI, suite) of every binary source in sources.list and sources.list.d, in both of apt's formats."""
    found = []
    folder = etc_apt / "sources.list.d"
    for path in [etc_apt / "sources.list", *sorted(folder.glob("*.list")), *sorted(folder.glob("*.sources"))]:
        if not path.is_file():
            continue
        if path.suffix == ".sources":
            for stanza in re.split(r"\n\s*\n", path.read_text()):
                lines = [line for line in stanza.splitlines() if not line.startswith("#")]
                fields = dict(re.findall(r"^(\S+):[ \t]*(.*(?:\n[ \t]+.*)*)", "\n".join(lines), re.MULTILINE))
                fields = {k.lower(): v.split() for k, v in fields.items()}
                if "deb" in fields.get("types", []) and fields.get("enabled", ["yes"]) != ["no"]:
                    found += [(uri, suite) for uri in fields.get("uris", []) for suite in fields.get("suites", [])]
        else:
            for line in path.read_text().splitlines():
                if match := re.match(r"\s*deb\s+(?:\[[^]]*\]\s+)?(\S+)\s+(\S+)", line):
                    found.append((match[1], match[2]))
    return found


def mirror(etc_apt: Path = Path("/etc/apt"), codename: str | None = None) -> str:
    """The URI from which this machine gets Debian itself: that of its own release's suite."""
    if codename is None:
        release = Path("/etc/os-release").read_text()
        codename = (re.findall(r"^VERSION_CODENAME=(\w+)", release, re.MULTILINE) or [""])[0]
    for uri, suite in sources(etc_apt):
        # Other repositories may use the same suite name; a mirror of Debian has `debian` in its path.
        if suite in (codename, "stable") and "debian" in uri and "security" not in uri and uri.startswith("http"):
            return uri.rstrip("/")
    return DEFAULT_MIRROR


def settings() -> str:
    """Lines for apt.conf that reach the mirror as this machine does: proxy, retries, checks of dates."""
    lines = [line for line in output(["apt-config", "dump", "Acquire"]).splitlines()
             if SETTINGS.match(line) and "Auto-Detect" not in line and not line.endswith('"";')]
    return "\n".join([*lines, ""])


def proxy_environment() -> dict[str, str]:
    """The same for programs that are not apt, such as debootstrap's wget."""
    found = dict(re.findall(r'^Acquire::(https?)::Proxy "(.+)";', settings(), re.MULTILINE | re.IGNORECASE))
    return {f"{scheme}_proxy": uri for scheme, uri in found.items() if uri != "DIRECT"}
