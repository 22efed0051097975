# SPDX-License-Identifier: Apache-2.0
import os
import signal
import sys
import threading
import time
import types
import warnings

import numpy as np
import pytest
import sextant

from scenes import SOURCE, kabsch

LEADERBOARD = SOURCE / "experiments" / "leaderboard.yaml"


def test_a_function_is_in_the_leaderboard():
    result = sextant.run(LEADERBOARD, solvers=["kabsch", kabsch_of_python, "ransac(kabsch_of_python)"],
                         trials=4)
    assert {"condition", "subject", "trial", "rotation_deg"} <= set(result.rows.dtype.names)
    own = result.rows[result.rows["subject"] == "kabsch_of_python"]
    theirs = result.rows[result.rows["subject"] == "kabsch"]
    assert len(own) == len(theirs) > 20
    # With equal noise of all pairs both minimise the same.
    plain = own["condition"] == "as described"
    assert np.allclose(own["rotation_deg"][plain], theirs["rotation_deg"][plain], atol=1e-6)
    assert "kabsch_of_python" in result.markdown
    assert result.summary["experiment"] == "leaderboard"


def kabsch_of_python(problem):
    return kabsch(problem)


def test_rows_do_not_depend_on_the_threads():
    runs = [sextant.run(LEADERBOARD, solvers=[kabsch_of_python], trials=3, threads=n) for n in (1, 4)]
    for name in runs[0].rows.dtype.names:
        a, b = (run.rows[name] for run in runs)
        assert ((a == b) | ((a != a) & (b != b))).all(), name


def test_mistakes_of_a_function_are_reported():
    def mistaken(problem):
        raise KeyError("x")

    with pytest.warns(UserWarning, match=r"mistaken failed in \d+ calls.*KeyError"):
        result = sextant.run(LEADERBOARD, solvers=[mistaken], trials=1)
    assert not result.rows["answered"].any()

    def refusing(problem):
        return None

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sextant.run(LEADERBOARD, solvers=[refusing], trials=1)


def test_a_folder_gets_what_the_program_writes(tmp_path):
    out = tmp_path / "out"
    sextant.run(LEADERBOARD, solvers=["kabsch"], trials=2, out=out)
    assert {"rows.sxtrows", "rows.csv", "summary.json", "report.md"} <= set(os.listdir(out))

    shift = [0.0]

    def changing(problem):
        return np.c_[np.eye(3), [shift[0], 0, 0]]

    first = sextant.run(LEADERBOARD, solvers=[changing], trials=1, out=tmp_path / "own")
    shift[0] = 50.0
    again = sextant.run(LEADERBOARD, solvers=[changing], trials=1, out=tmp_path / "own")
    assert not np.array_equal(first.rows["translation_mm"], again.rows["translation_mm"])
    kept = sextant.run(LEADERBOARD, solvers=[changing], trials=1, out=tmp_path / "own", resume=True)
    assert np.array_equal(kept.rows["translation_mm"], again.rows["translation_mm"])


def test_an_interrupt_ends_a_run():
    # A process that a shell started in the background ignores interrupts.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT))
    began = time.monotonic()
    timer.start()
    try:
        # It would take minutes, and then raise the interrupt too.
        with pytest.raises(KeyboardInterrupt):
            sextant.run(LEADERBOARD, solvers=[kabsch_of_python], trials=200000)
        assert time.monotonic() - began < 20.0
    finally:
        signal.signal(signal.SIGINT, before)


def test_errors_have_the_message_of_the_program(tmp_path):
    with pytest.raises(sextant.Error, match="nowhere.yaml"):
        sextant.run(tmp_path / "nowhere.yaml")
    with pytest.raises(sextant.Error, match="did you mean 'kabsch'"):
        sextant.run(LEADERBOARD, solvers=["kabsh"])


def test_pandas_gets_a_table(monkeypatch):
    # What pandas would be given, whether it is there or not.
    monkeypatch.setitem(sys.modules, "pandas", types.SimpleNamespace(DataFrame=dict))
    frame = sextant.run(LEADERBOARD, solvers=["kabsch"], trials=2).to_dataframe()
    assert {"condition", "subject", "rotation_deg"} <= set(frame)
    assert len(frame["subject"]) == len(frame["rotation_deg"])
