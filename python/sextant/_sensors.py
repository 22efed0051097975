# SPDX-License-Identifier: Apache-2.0
"""Images and scans: files to arrays, boards in both, and the calibration."""

import json
import os

import numpy as np

from . import _core
from ._error import Error
from ._own import spec_of


def _is_path(value):
    return isinstance(value, (str, os.PathLike))


def _boards_of(boards):
    if boards is None:
        return []
    if _is_path(boards):
        return _core.read_boards(os.fspath(boards))
    return [boards] if isinstance(boards, _core.Board) else list(boards)


def _camera_of(camera):
    return _core.Camera.read(os.fspath(camera)) if _is_path(camera) else camera


def read_boards(path):
    """The boards of a board file (YAML, or marker_coordinates.txt): a list of Board."""
    return _core.read_boards(os.fspath(path))


def read_cloud(path):
    """A scan (PCD, PLY, LAS, npy, KITTI .bin, or a table) as (N, 3) to (N, 6).

    Columns: x y z [m] in the LiDAR frame, intensity, ring (0 the lowest), time [s]; as many as the
    file has, NaN for one that is missing before another. Rays without a return have NaN points.
    """
    return _core.read_cloud(os.fspath(path))


def read_image(path):
    """An image as (H, W) or (H, W, 3) BGR, uint8 or uint16, turned as its Exif data says."""
    return _core.read_image(os.fspath(path))


class Found:
    """What detect() or boards() found. `data` is the JSON of the program's command as dicts
    (docs/formats.md), with the corners of `boards` as arrays."""

    def __init__(self, answer, key):
        text, self._text = answer
        self.data = json.loads(text)[key][0]
        self.boards = self.data["boards"]

    def to_json(self):
        return json.dumps(self.data, indent=2)

    def __repr__(self):
        return self._text

    def _repr_html_(self):
        from ._notebook import preformatted

        return preformatted(self._text)


def detect(image, boards=None, camera=None, *, detector=""):
    """Tags and boards in an image, as `sextant detect` finds them: Found.

    image: a path, or an array (H, W) or (H, W, 3) BGR. boards: a board file or a list of Board;
    without, all tags that the detector knows. camera: for poses and corners in the camera frame.
    Found.boards: dicts with id, tags, missing, pose, and corners_in_cam (4, 3) [m], or None.
    Found.tags: dicts with family, id and corners (4, 2) [px], of all tags that are on no board.
    """
    path = os.fspath(image) if _is_path(image) else ""
    found = Found(_core.detect_in_image(None if path else image, path, _boards_of(boards),
                                        _camera_of(camera), detector), "images")
    for board in found.boards:
        corners = board["corners_in_cam_m"]
        board["corners_in_cam"] = np.array(corners) if corners else None
    found.tags = [dict(tag, corners=np.array(tag["corners_px"])) for tag in found.data["other_tags"]]
    return found


def boards(scan, boards, *, extractor="rectangle", seed=1):
    """Boards in a scan, with their corners, as `sextant boards` finds them: Found.

    scan: a path, or an array (N, 3) to (N, 6) as read_cloud gives it. boards: a board file or a
    list of Board. extractor: rectangle, plane_lines, lines3d or lines3d_raw.
    Found.boards: dicts with board (its id), corners (4, 3) [m] and covariance (12, 12) [m^2] of
    those found.
    """
    path = os.fspath(scan) if _is_path(scan) else ""
    found = Found(_core.boards_in_scan(None if path else scan, path, _boards_of(boards), extractor,
                                       seed), "scans")
    for board in found.boards:
        if "in_lidar_m" in (board.get("corners") or {}):
            board["covariance"] = np.array(board["corners"]["covariance_m2"])
            board["corners"] = np.array(board["corners"]["in_lidar_m"])
    return found


def calibrate(session=None, *, images=None, clouds=None, boards=None, camera=None, solvers=(),
              initial=None, need=(10.0, 0.1), bootstrap=100, detector="", extractor="rectangle",
              camera_name=""):
    """cam_from_lidar of images and scans of boards, with its uncertainty: a Calibration.

    session: a session file, a folder with one or of simulate(), or a recording of ROS.
    Or images and clouds in memory, one of each per moment: arrays (H, W) or (H, W, 3), and (N, 3)
    to (N, 6) as read_cloud gives them; then boards and camera are needed.
    boards: a board file or a list of Board; camera: a Camera or a file; instead of the session's.
    solvers: specs or functions; the first gives the answer. initial: rough cam_from_lidar (4, 4).
    need: the accuracy for the verdict, (mm, degrees) of the least certain direction, 1 sigma.
    bootstrap: samples over the views; 0 for neither bootstrap nor cross-validation. camera_name: of
    a simulated session with several cameras, by default the first.

    Raises Error with the message that `sextant calibrate` prints. A result whose verdict is NOT
    USABLE is returned: look at `verdict` and `reason`.
    """
    specs = [spec_of(item) for item in ([solvers] if isinstance(solvers, str) else solvers)]
    request = _core.CalibrateRequest(specs, _boards_of(boards), _camera_of(camera), initial,
                                     detector, extractor, float(need[0]), float(need[1]), bootstrap)
    if session is not None:
        if images is not None or clouds is not None:
            raise Error("expected a session, or images and clouds, not both")
        return _core.calibrate_session(os.fspath(session), camera_name, request)
    return _core.calibrate_arrays(list(() if images is None else images),
                                  list(() if clouds is None else clouds), request)


def check(pose, images, clouds, camera, *, detect=(80.0, 0.5)):
    """Whether a pose is still valid, by everyday scenes without a board, as `sextant check`.

    pose: cam_from_lidar (4, 4). images and clouds: one of each per moment, paths or arrays (H, W)
    or (H, W, 3), and (N, 3) to (N, 6) as read_cloud gives them. camera: a Camera or a file.
    detect: (mm, degrees); "still valid" only if a change of this size would have been seen.

    Returns a PoseCheck: state ("still valid", "moved", "cannot tell"), reason, change (6,) and its
    sigma (6,), or None where it is unknown.
    """
    images = [read_image(item) if _is_path(item) else item for item in images]
    clouds = [read_cloud(item) if _is_path(item) else item for item in clouds]
    return _core.check_arrays(pose, images, clouds, _camera_of(camera), float(detect[0]),
                              float(detect[1]))


def simulate(scene, out, *, scans=1, seed=1, level="full", interval_s=1.0, ideal=False):
    """Simulates a session of a scene file into the folder `out`, as `sextant simulate`: a Session.

    The same scene and seed give the same bytes. level: full (points and images), corners or pairs.
    """
    _core.simulate_session(os.fspath(scene), os.fspath(out), scans=scans, seed=seed, level=level,
                           interval_s=interval_s, ideal=ideal)
    return _core.Session.read(os.fspath(out)) if level == "full" else None


def read_session(path, camera_name=""):
    """The files of a session, paired: a Session with images, clouds, boards, camera (paths)."""
    return _core.Session.read(os.fspath(path), camera_name)
