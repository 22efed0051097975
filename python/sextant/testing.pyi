# SPDX-License-Identifier: Apache-2.0
from typing import Any

from numpy.typing import ArrayLike

from . import Array, Solver

def check_solver(f: Solver, **needs: Any) -> list[str]: ...
def pose_difference(matrix: ArrayLike, reference: ArrayLike) -> Array: ...
