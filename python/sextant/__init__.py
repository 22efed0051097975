# SPDX-License-Identifier: Apache-2.0
"""Rigid transform between a LiDAR and a camera: found, refined, compared and proved.

point_in_cam = cam_from_lidar @ point_in_lidar. Camera: x right, y down, z forward; LiDAR: x
forward, y left, z up. Metres and radians, unless a name states another unit. A covariance (6, 6)
is of (dphi [rad], dt [m]) with R = Exp(dphi) R_hat, t = t_hat + dt.
"""

from ._error import Error
from ._core import (Board, Calibration, Camera, Comparison, Estimate, PoseCheck, Problem, Session,
                    Solution, __version__, parse_boards, solvers)
from ._experiment import ExperimentResult, run
from ._own import register, solver
from ._sensors import (Found, boards, calibrate, check, detect, read_boards, read_cloud, read_image,
                       read_session, simulate)
from ._solving import compare, project, solve

__all__ = [
    "Board", "Calibration", "Camera", "Comparison", "Error", "Estimate", "ExperimentResult",
    "Found", "PoseCheck", "Problem", "Session", "Solution", "boards", "calibrate", "check",
    "compare", "detect", "parse_boards", "project", "read_boards", "read_cloud", "read_image",
    "read_session", "register", "run", "simulate", "solve", "solver", "solvers",
]
