# SPDX-License-Identifier: Apache-2.0
"""Whether a pose is still valid, by real scenes; and what wrong input causes."""

import json
import os
from pathlib import Path

import numpy as np
import pytest
import sextant
from scenes import CAMERA, SOURCE, TRUTH


def kitti():
    data = Path(os.environ.get("SEXTANT_DATA", SOURCE.parent / "shared" / "data"))
    folder = data / "field" / "kitti"
    if not folder.exists():
        pytest.skip("REAL DATA ABSENT: field/kitti")
    return folder


def test_a_moved_pose_is_no_valid_one():
    folder = kitti()
    images = sorted((folder / "img").glob("*.png"))
    clouds = sorted((folder / "pcd").glob("*.pcd"))
    camera = sextant.Camera.read(str(folder / "gt.json"))
    text = json.loads((folder / "gt.json").read_text())
    angle = np.radians(1.0)
    turn = np.eye(4)
    turn[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    # tests/calibrate/scene has what is still valid.
    moved = sextant.check(turn @ given_pose(text), images, clouds, camera)
    assert moved.state == "moved", moved.reason
    assert moved.change.shape == (6,) and moved.sigma.shape == (6,)
    assert abs(moved.change[2]) > 0.5 * angle


def given_pose(text):
    """cam_from_lidar (4, 4) of gt.json: rotation w x y z, and translation."""
    w, x, y, z = text["extrinsics"]["rotation"]
    rotation = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    pose = np.eye(4)
    pose[:3, :3] = rotation
    pose[:3, 3] = text["extrinsics"]["translation"]
    return pose


def test_wrong_input_is_named():
    image = np.zeros((480, 640), np.uint8)
    cloud = np.random.default_rng(1).normal(size=(100, 3))
    with pytest.raises(sextant.Error, match="as many images as clouds"):
        sextant.check(TRUTH, [image], [], CAMERA)
    with pytest.raises(sextant.Error, match="640 x 480; got 320 x 240"):
        sextant.check(TRUTH, [image[:240, :320]], [cloud], CAMERA)
    with pytest.raises(sextant.Error, match="pose"):
        sextant.check(np.ones((4, 4)), [image], [cloud], CAMERA)
