# SPDX-License-Identifier: Apache-2.0
"""What several test files need: pairs with a known pose, files of the source tree."""

import os
from pathlib import Path

import numpy as np
import sextant

SOURCE = Path(os.environ["SEXTANT_SOURCE"])
PROGRAM = os.environ["SEXTANT_BINARY"]

TRUTH = np.array([[0, -1, 0, 0.1], [0, 0, -1, -0.2], [1, 0, 0, 0.3], [0, 0, 0, 1.0]])
CAMERA = sextant.Camera(600, 600, 319.5, 239.5, width=640, height=480)


def pairs(count=8, noise_m=0.0, seed=1):
    """LiDAR points and camera points, (count, 3) each."""
    rng = np.random.default_rng(seed)
    in_lidar = rng.uniform(-1, 1, (count, 3)) + [4, 0, 0]
    in_cam = in_lidar @ TRUTH[:3, :3].T + TRUTH[:3, 3]
    return in_lidar, in_cam + noise_m * rng.normal(size=(count, 3))


def kabsch(problem):
    """Least squares of the 3D distances, with equal weights."""
    a, b = problem.points_in_lidar, problem.points_in_cam
    u, s, vt = np.linalg.svd((b - b.mean(0)).T @ (a - a.mean(0)))
    if s[1] < 1e-6 * s[0] or s[0] == 0.0:
        return None  # The points are on a line.
    turn = u @ np.diag([1, 1, np.linalg.det(u @ vt)]) @ vt
    return np.c_[turn, b.mean(0) - turn @ a.mean(0)]
