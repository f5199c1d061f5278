"""apt: the mirror of this machine is found in both formats, and nothing else is taken for it."""

import apt

DEB822 = """Types: deb
# a comment in a stanza
URIs: http://mirror.example.org/debian/
Suites: bookworm bookworm-updates
Components: main
Signed-By: /usr/share/keyrings/debian-archive-keyring.gpg

Types: deb
URIs: http://mirror.example.org/debian-security
Suites: bookworm-security
Components: main

Enabled: no
Types: deb
URIs: http://other.example.org/debian
Suites: bookworm
"""


def etc_apt(tmp_path, **files):
    (tmp_path / "sources.list.d").mkdir()
    for name, text in files.items():
        path = tmp_path / "sources.list" if name == "sources" else tmp_path / "sources.list.d" / name.replace("_", ".")
        path.write_text(text)
    return tmp_path


def test_deb822(tmp_path):
    folder = etc_apt(tmp_path, debian_sources=DEB822)
    assert apt.mirror(folder, "bookworm") == "http://mirror.example.org/debian"
    assert ("http://other.example.org/debian", "bookworm") not in apt.sources(folder)


def test_one_line_format(tmp_path):
    folder = etc_apt(tmp_path, sources="# none\n"
                     "deb [arch=amd64 signed-by=/x.gpg] http://a.example.org/debian bookworm main\n")
    assert apt.mirror(folder, "bookworm") == "http://a.example.org/debian"


def test_other_repositories_and_security_are_no_mirrors(tmp_path):
    folder = etc_apt(tmp_path, sources="deb http://x.example.org/apt bookworm main\n"
                                       "deb-src http://y.example.org/debian bookworm main\n"
                                       "deb http://z.example.org/debian-security bookworm main\n")
    assert apt.mirror(folder, "bookworm") == apt.DEFAULT_MIRROR


def test_nothing_at_all(tmp_path):
    assert apt.mirror(tmp_path, "bookworm") == apt.DEFAULT_MIRROR
