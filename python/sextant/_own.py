# SPDX-License-Identifier: Apache-2.0
"""Solvers of your own: functions that get names."""

import functools
import inspect

from . import _core
from ._error import Error

_registered = {}


def register(f, name=None, *, pairs_3d3d=0, pairs_2d3d=0, points_per_set=0, initial_pose=False):
    """Makes f(problem) a solver by name, in this process, for every combinator and experiment.

    f gets a Problem and returns cam_from_lidar as a matrix (4, 4) or (3, 4), an Estimate, or None
    for no pose. Its keyword-only parameters with defaults are options of the solver:
    `def f(problem, *, rounds=3)` is also "f(rounds=5)". The same problem must give the same answer,
    and any thread may call it, one at a time.

    pairs_3d3d, pairs_2d3d (which need a camera), points_per_set: the smallest numbers that it
    works with; a problem with fewer is refused before f is called. By default 3 3D-3D pairs.
    initial_pose: it needs problem.initial, and finds only the answer near it.

    Returns the name. A name that Python registered before is replaced.
    """
    name = name or getattr(f, "__name__", "")
    if not (pairs_3d3d or pairs_2d3d or points_per_set):
        pairs_3d3d = 3
    needs = {"pairs_3d3d": pairs_3d3d, "pairs_2d3d": pairs_2d3d, "points_per_set": points_per_set,
             "initial_pose": initial_pose}
    options = _options_of(f)
    summary = (inspect.getdoc(f) or "a solver in Python").splitlines()[0]
    _core.register_function(
        name, functools.partial(_bind, f, options), summary,
        [(key, str(value)) for key, value in options.items()], **needs)
    _registered[name] = (f, needs)
    return name


def solver(name=None, **needs):
    """register() as a decorator: `@sextant.solver(pairs_2d3d=6)`. The function stays as it is."""

    def decorate(f):
        register(f, name, **needs)
        return f

    return decorate


def spec_of(item):
    """The spec of a solver that is given as text or as a function."""
    if isinstance(item, str):
        return item
    if not callable(item):
        raise Error(f"expected a solver as text or a function, got {type(item).__name__}")
    for name, (f, _) in _registered.items():
        if f is item:
            return name
    return register(item)


def needs_of(name):
    """The needs with which a solver of Python was registered."""
    return _registered[name][1]


def _options_of(f):
    try:
        parameters = inspect.signature(f).parameters.values()
    except (TypeError, ValueError):  # Functions of C have no signature.
        return {}
    return {p.name: p.default for p in parameters
            if p.kind is p.KEYWORD_ONLY and p.default is not p.empty}


def _bind(f, defaults, texts):
    """f with its options set; each is converted to the type of its default."""
    if not texts:
        return f
    values = {}
    for key, text in texts.items():
        kind = type(defaults[key])
        if kind is bool:
            if text not in ("true", "false"):
                raise ValueError(f"{key}: expected true or false, got '{text}'")
            values[key] = text == "true"
            continue
        try:
            values[key] = text if defaults[key] is None else kind(text)
        except (TypeError, ValueError):
            raise ValueError(f"{key}: expected {kind.__name__}, got '{text}'") from None
    return functools.partial(f, **values)
