# SPDX-License-Identifier: Apache-2.0
"""Runs the tests of this folder by pytest behind the options of a gtest binary, so that scripts/test
lists and counts them like all others: --gtest_list_tests and --gtest_output=xml:FILE."""

import sys
from pathlib import Path
from xml.sax.saxutils import quoteattr

import pytest


class GtestReport:
    """One line for each test, in gtest's form."""

    def __init__(self, output):
        self.output = output
        self.outcomes = {}

    def pytest_runtest_logreport(self, report):
        failed, reason = self.outcomes.get(report.nodeid, (False, None))
        if report.skipped:
            reason = str(report.longrepr[2] if isinstance(report.longrepr, tuple) else report.longrepr)
        self.outcomes[report.nodeid] = (failed or report.failed, reason)

    def pytest_sessionfinish(self):
        if not self.output:
            return
        lines = [self.line(node, *outcome) for node, outcome in self.outcomes.items()]
        Path(self.output).write_text("<testsuites>\n" + "".join(lines) + "</testsuites>\n")

    @staticmethod
    def line(node, failed, reason):
        suite, name = suite_and_name(node)
        result = "skipped" if reason is not None else "completed"
        head = (f"<testcase name={quoteattr(name)} classname={quoteattr(suite)} status=\"run\" "
                f"result=\"{result}\">\n")
        inner = "<failure message=\"see the output\"/>\n" if failed else ""
        if reason is not None:
            inner += f"<skipped message={quoteattr(reason)}/>\n"
        return head + inner + "</testcase>\n"


class GtestList:
    def pytest_collection_finish(self, session):
        last = None
        for item in session.items:
            suite, name = suite_and_name(item.nodeid)
            if suite != last:
                print(f"{suite}.")
            last = suite
            print(f"  {name}")


def suite_and_name(node):
    path, name = node.split("::", 1)
    return Path(path).stem, name


def main(arguments):
    options = ["-q", "-p", "no:cacheprovider", "--rootdir", str(Path(__file__).parent)]
    if "--gtest_list_tests" in arguments:
        return pytest.main(options + ["--collect-only", "-qqq", str(Path(__file__).parent)],
                           plugins=[GtestList()])
    prefix = "--gtest_output=xml:"
    output = next((a[len(prefix):] for a in arguments if a.startswith(prefix)), None)
    others = [a for a in arguments if not a.startswith("--gtest_")]
    return pytest.main(options + others + [str(Path(__file__).parent)],
                       plugins=[GtestReport(output)])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
