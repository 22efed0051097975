# SPDX-License-Identifier: Apache-2.0
# A solver of your own: held to the contract, wrapped by combinators, compared in an experiment.
# Usage: 03_own_solver.py [EXPERIMENT.yaml]
import sys

import numpy as np
import sextant
import sextant.testing


def my_solver(problem):
    """Least squares of the 3D distances, equal weights."""
    a, b = problem.points_in_lidar, problem.points_in_cam
    u, s, vt = np.linalg.svd((b - b.mean(0)).T @ (a - a.mean(0)))
    if not s[1] > 1e-6 * s[0]:
        return None  # Points on a line leave a rotation about it undetermined: no pose.
    rotation = u @ np.diag([1, 1, np.linalg.det(u @ vt)]) @ vt
    return np.c_[rotation, b.mean(0) - rotation @ a.mean(0)]


sextant.testing.check_solver(my_solver)

# A shift by (0.1, 0.2, 0.3) m; every fifth pair is wrong.
i = np.arange(20)
in_lidar = np.c_[2.0 + 0.1 * (i % 3), 0.2 * (i % 5), 0.15 * (i % 7)]
in_cam = in_lidar + np.c_[0.1 + 0 * i, np.where(i % 5, 0.2, 0.9), 0.3 + 0 * i]
for solver in (my_solver, "ransac(my_solver)", "gnc(my_solver)", "gnc(kabsch)"):
    answer = sextant.solve(in_lidar, in_cam, solver=solver)
    print(f"{answer.solver:18s}", answer.matrix[:3, 3].round(4), "m")

if len(sys.argv) > 1:
    names = ["kabsch", my_solver, "ransac(my_solver)"]
    print(sextant.run(sys.argv[1], solvers=names, quick=True))
