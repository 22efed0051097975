# SPDX-License-Identifier: Apache-2.0
"""The package as a whole: its names, its documentation, its types, its examples, its page."""
import ast
import inspect
import pickle
import subprocess
import sys
import zipfile

import sextant

from scenes import PROGRAM, SOURCE

PACKAGE = SOURCE / "python" / "sextant"
EXAMPLES = ("01_solve.py", "02_calibrate.py", "03_own_solver.py")


def definitions(body):
    return {node.name: node for node in body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}


def parameters(node):
    a = node.args
    return [x.arg for x in a.posonlyargs + a.args + a.kwonlyargs]


def test_everything_public_is_documented():
    for name in sextant.__all__:
        assert inspect.getdoc(getattr(sextant, name)), name


def test_the_types_name_everything_public_and_nothing_else():
    stub = definitions(ast.parse((PACKAGE / "__init__.pyi").read_text()).body)
    assert set(stub) == set(sextant.__all__)
    for name, node in stub.items():
        thing = getattr(sextant, name)
        if isinstance(node, ast.FunctionDef):
            if inspect.isfunction(thing):
                assert parameters(node) == [p for p, x in inspect.signature(thing).parameters.items()
                                            if x.kind is not x.VAR_KEYWORD], name
            continue
        described = {n for n in definitions(node.body) if not n.startswith("_")}
        described |= {n.target.id for n in node.body if isinstance(n, ast.AnnAssign)}
        public = {n for n in vars(thing) if not n.startswith("_")}
        if thing.__module__ == "sextant._core":
            assert described == public, name
        else:
            assert public <= described, name


def test_the_version_is_the_programs():
    run = subprocess.run([PROGRAM, "--version"], capture_output=True, text=True, check=True)
    assert sextant.__version__ in run.stdout


def test_errors_survive_pickling():
    error = pickle.loads(pickle.dumps(sextant.Error("text", "degenerate")))
    assert (str(error), error.code) == ("text", "degenerate")


def run_example(name, *arguments):
    return subprocess.run([sys.executable, SOURCE / "examples" / name, *arguments],
                          capture_output=True, text=True, check=True).stdout


def test_the_example_of_pairs_runs():
    assert "1 sigma along x y z" in run_example(EXAMPLES[0])


def test_the_example_of_an_own_solver_runs_and_is_robust():
    out = run_example(EXAMPLES[2])
    assert "ransac(my_solver)  [0.1 0.2 0.3] m" in out
    assert "gnc(my_solver)     [0.1 0.2 0.3] m" in out


def test_the_page_shows_the_examples_as_they_are():
    page = (SOURCE / "docs" / "python.md").read_text()
    for name in EXAMPLES:
        lines = (SOURCE / "examples" / name).read_text().splitlines(keepends=True)
        assert len(lines) < 60
        assert "```python\n" + "".join(lines[1:]) + "```\n" in page, f"copy {name} into the page"


def test_a_wheel_is_made_without_a_network(tmp_path):
    sys.path.insert(0, str(SOURCE / "python"))
    import wheel_backend

    # The build of these tests, so that nothing is compiled again.
    build = PROGRAM.rpartition("/bin/")[0]
    name = wheel_backend.build_wheel(str(tmp_path), {"build-dir": build})
    with zipfile.ZipFile(tmp_path / name) as wheel:
        names = wheel.namelist()
        wheel.extractall(tmp_path / "site")
    assert any(n.startswith("sextant/_core") for n in names)
    assert {"sextant/py.typed", "sextant/__init__.pyi", "sextant/testing.py"} <= set(names)
    code = "import sextant; print(sextant.__file__, sextant.__version__)"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True,
                         env={"PYTHONPATH": str(tmp_path / "site")}).stdout
    assert str(tmp_path) in out and sextant.__version__ in out
