# SPDX-License-Identifier: Apache-2.0
"""Correspondences to poses: solve, compare, project."""

import os

import numpy as np

from . import _core
from ._error import Error
from ._own import spec_of


def _problem(points_in_lidar, points_in_cam, data):
    if isinstance(points_in_lidar, _core.Problem):
        return points_in_lidar
    if isinstance(points_in_lidar, (str, os.PathLike)):
        return _core.Problem.read(os.fspath(points_in_lidar), camera=data.get("camera"))
    return _core.Problem(points_in_lidar, points_in_cam, **data)


def solve(points_in_lidar, points_in_cam=None, *, solver="", **data):
    """The answer of one solver, with its uncertainty: a Solution.

    points_in_lidar: (N, 3) [m]; with points_in_cam (N, 3) [m], or with pixels=(N, 2) and camera=.
    Further keywords are those of Problem: sigma_m, sigma_px, initial, views, boards, corners.
    Instead of points: a Problem, or the path of a file of correspondences (points.txt, CSV, YAML).

    solver: as in `sextant list solvers`, such as "refine(ransac(p3p))", or a function (register).
    By default kabsch for 3D-3D pairs and refine(sqpnp) for 2D-3D pairs, or robust(kabsch) and
    refine(ransac(p3p)) where there are outliers.

    Raises Error with the message that `sextant solve` prints.
    """
    return _core.solve_problem(_problem(points_in_lidar, points_in_cam, data),
                               solver if type(solver) is str else spec_of(solver))


def compare(points_in_lidar, points_in_cam=None, *, solvers=(), **data):
    """Many solvers on the same data: a Comparison. The data is given as to solve().

    solvers: a list of specs and functions; by default every solver whose needs the data meets.
    """
    specs = [spec_of(item) for item in ([solvers] if isinstance(solvers, str) else solvers)]
    return _core.compare_solvers(_problem(points_in_lidar, points_in_cam, data), specs)


def project(points_in_lidar, cam_from_lidar, camera):
    """Pixels (N, 2) of LiDAR points (N, 3) [m]; NaN where a point is outside the camera's model.

    cam_from_lidar: (4, 4), or anything with a `matrix`. The image's size does not limit the pixels.
    """
    matrix = np.asarray(getattr(cam_from_lidar, "matrix", cam_from_lidar), dtype=float)
    _core.check_pose(matrix, "cam_from_lidar")
    points = np.asarray(points_in_lidar, dtype=float)
    if points.ndim != 2 or points.shape[1] < 3:
        raise Error(f"points_in_lidar: expected shape (N, 3), got {points.shape}")
    return camera.project(points[:, :3] @ matrix[:3, :3].T + matrix[:3, 3])
