# SPDX-License-Identifier: Apache-2.0
"""Experiments: run a file, with solvers of your own, and get tables."""

import json
import os
import tempfile
import warnings

import numpy as np

from . import _core
from ._own import spec_of


class ExperimentResult:
    """The rows of an experiment, and the tables of its report.

    rows: structured numpy array with the fields condition, the axes of the grid, subject, trial,
    index (of a step), and every metric of the file (units in the names; NaN where there is none).
    markdown: the report. summary: all statistics, as summary.json has them.
    """

    def __init__(self, columns):
        self.name = columns["name"]
        self.markdown = columns["markdown"]
        self.summary = json.loads(columns["summary"])
        self._plain = columns["plain"]
        self.rows = _rows_of(columns)

    def to_dataframe(self):
        """The rows as a pandas DataFrame."""
        import pandas

        return pandas.DataFrame({name: self.rows[name] for name in self.rows.dtype.names})

    def __repr__(self):
        return self._plain

    def _repr_html_(self):
        from ._notebook import preformatted

        return preformatted(self._plain)


def run(path, solvers=(), *, trials=0, seed=None, quick=False, threads=0, out=None, resume=False):
    """Runs an experiment file as `sextant run` does: an ExperimentResult.

    solvers: specs and functions, instead of the file's; conditions without data for them are left
    out. trials, seed: instead of the file's. quick: its quick_trials. threads: 0 for all cores;
    functions of Python run one at a time. out: a folder for rows, tables and plots. resume: keep
    the rows of an earlier run in `out`; by default they are computed again, as the code of a
    function may have changed.

    Raises Error with the message that `sextant run` prints. Warns where a function raised anything
    but Error, or returned something that is no pose.
    """
    specs = [spec_of(item) for item in ([solvers] if isinstance(solvers, str) else solvers)]
    seed = None if seed is None else int(seed)

    def run_in(folder, is_kept):
        return ExperimentResult(_core.run_experiment(
            os.fspath(path), specs, trials, seed, quick, threads, folder, is_kept, resume))

    _core.take_faults()
    if out is not None:
        result = run_in(os.fspath(out), True)
    else:
        with tempfile.TemporaryDirectory(prefix="sextant-") as folder:
            result = run_in(folder, False)
    for name, (count, first) in _core.take_faults().items():
        warnings.warn(f"{name} failed in {count} calls, which count as not answered; the first: "
                      f"{first}", stacklevel=2)
    return result


def _rows_of(columns):
    conditions = columns["conditions"]
    condition = columns["condition"]
    fields = {"condition": np.array([c[0] for c in conditions], dtype=str)[condition]}
    for i, axis in enumerate(columns["axes"]):
        fields[axis] = np.array([c[1][i] for c in conditions], dtype=str)[condition]
    most = max(len(c[2]) for c in conditions)
    subjects = np.array([c[2] + [""] * (most - len(c[2])) for c in conditions], dtype=str)
    fields["subject"] = subjects[condition, columns["subject"]]
    fields["trial"] = columns["trial"]
    fields["index"] = columns["index"]
    fields.update(columns["metrics"])
    rows = np.empty(len(condition), dtype=[(name, v.dtype) for name, v in fields.items()])
    for name, values in fields.items():
        rows[name] = values
    return rows
