"""Results: what a junit file says is what is counted; a run that ends badly is a failure of its own."""

import blender_job
from results import FAILED, PASSED, SKIPPED, Case, Layer, from_junit, summary

PYTEST = """<testsuites><testsuite name="pytest">
<testcase classname="test_a" name="test_one" time="0.5"/>
<testcase classname="test_a" name="test_two"><failure message="assert 1 == 2">long text</failure></testcase>
<testcase classname="test_a" name="test_three"><error message="broken fixture">its text</error></testcase>
<testcase classname="test_a" name="test_four"><skipped message="no GPU">a.py:3: no GPU</skipped></testcase>
</testsuite></testsuites>"""

CTEST = """<testsuite name="Linux-c++" tests="3">
<testcase name="Bake.Slab" classname="Bake.Slab" time="0.01" status="run"><system-out>ok</system-out></testcase>
<testcase name="Bake.Plane" classname="Bake.Plane" time="0.01" status="fail"><failure message=""/>
<system-out>expected 1, got 2</system-out></testcase>
<testcase name="Bake.Later" classname="Bake.Later" time="0" status="notrun">
<skipped message="SKIP_REGULAR_EXPRESSION_MATCHED"/>
<system-out>[ RUN      ] Bake.Later
a.cpp:7: Skipped
needs AVX2

[  SKIPPED ] Bake.Later (0 ms)</system-out></testcase>
</testsuite>"""


def read(tmp_path, text):
    path = tmp_path / "junit.xml"
    path.write_text(text)
    return from_junit(path)


def test_pytest_report(tmp_path):
    cases = read(tmp_path, PYTEST)
    assert [c.status for c in cases] == [PASSED, FAILED, FAILED, SKIPPED]
    assert cases[0].name == "test_a.test_one" and cases[0].seconds == 0.5
    assert cases[1].message == "long text" and cases[3].message == "no GPU"


def test_ctest_report(tmp_path):
    cases = read(tmp_path, CTEST)
    assert [c.status for c in cases] == [PASSED, FAILED, SKIPPED]
    assert cases[1].message == "expected 1, got 2"
    assert cases[2].message == "needs AVX2"
    assert cases[0].name == "Bake.Slab"


def test_missing_and_broken_reports_have_no_cases(tmp_path):
    assert from_junit(tmp_path / "nothing.xml") == []
    assert read(tmp_path, "<testsuites><testsuite>") == []


def judged(status, *cases, tmp_path):
    layer = Layer("window", list(cases))
    blender_job.judge(layer, status, tmp_path / "log", 3.0)
    return layer


def test_a_run_without_tests_fails(tmp_path):
    assert judged(0, tmp_path=tmp_path).count(FAILED) == 1


def test_a_crash_and_a_hang_fail_whatever_was_reported(tmp_path):
    assert judged(-11, Case("a", PASSED), tmp_path=tmp_path).count(FAILED) == 1
    assert judged(None, Case("a", PASSED), tmp_path=tmp_path).count(FAILED) == 1


def test_a_failed_test_is_counted_once(tmp_path):
    assert judged(1, Case("a", FAILED), Case("b", PASSED), tmp_path=tmp_path).count(FAILED) == 1


def test_skipping_everything_fails(tmp_path):
    assert judged(0, Case("a", SKIPPED), tmp_path=tmp_path).count(FAILED) == 1


def test_summary_line():
    layers = [Layer("a", [Case("x", PASSED), Case("y", SKIPPED)]), Layer("b", [Case("z", PASSED)])]
    assert summary(layers) == "2 passed, 0 failed, 1 skipped"
