# SPDX-License-Identifier: Apache-2.0
import json
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
import sextant
import sextant.testing

from scenes import PROGRAM, SOURCE

SCENE = (SOURCE / "tests" / "examples" / "swinging_board.yaml").read_text()


@pytest.fixture(scope="module")
def session(tmp_path_factory):
    folder = tmp_path_factory.mktemp("session")
    (folder / "scene.yaml").write_text(SCENE)
    return sextant.simulate(folder / "scene.yaml", folder / "out", scans=4, interval_s=60.0)


def folder_of(session):
    return session.boards.rpartition("/")[0]


@pytest.fixture(scope="module")
def calibration(session):
    return sextant.calibrate(folder_of(session), bootstrap=5)


def arrays_of(session):
    return ([sextant.read_image(path) for path in session.images],
            [sextant.read_cloud(path) for path in session.clouds])


def assert_near_truth(calibration, session):
    error = sextant.testing.pose_difference(calibration.matrix, session.true_matrix)
    # 99.9 percent of chi2(6), with the first-order covariance taken as it is.
    assert error @ np.linalg.solve(calibration.covariance, error) < 22.5


def test_a_session_gives_what_the_program_gives(session, calibration):
    assert_near_truth(calibration, session)
    run = subprocess.run([PROGRAM, "calibrate", folder_of(session), "--out",
                          folder_of(session) + "/result.yaml", "--bootstrap", "5",
                          "--json", "-"],
                         capture_output=True, text=True, check=False)
    theirs, ours = json.loads(run.stdout), json.loads(calibration.to_json())
    for key in ("cam_from_lidar", "covariance", "verdict", "closing", "views"):
        assert theirs[key] == ours[key], key
    assert calibration.verdict in ("GOOD", "USABLE WITH CARE", "NOT USABLE")
    assert calibration.verdict in repr(calibration)
    assert "<table>" in calibration._repr_html_()
    assert [view["kept"] for view in calibration.views] == [True] * 4
    assert calibration.boards[0][1:3] == (0, "kept")


def test_arrays_give_what_the_files_give(session, calibration):
    images, clouds = arrays_of(session)
    assert images[0].shape == (600, 960) and images[0].dtype == np.uint8
    assert clouds[0].ndim == 2 and clouds[0].shape[1] >= 5
    boards = sextant.read_boards(session.boards)
    camera = sextant.Camera.read(session.camera)
    arrays = sextant.calibrate(images=images, clouds=clouds, boards=boards, camera=camera,
                               bootstrap=0)
    assert np.array_equal(arrays.matrix, calibration.matrix)
    plain = sextant.calibrate(images=images, clouds=[cloud[:, :3] for cloud in clouds],
                              boards=boards, camera=camera, bootstrap=0)
    assert_near_truth(plain, session)


def test_boards_are_named_by_their_ids(session):
    with open(session.boards) as file:
        boards = sextant.parse_boards(file.read().replace("id: 0", "id: 7", 1))
    assert [board.id for board in boards] == [7]
    calibration = sextant.calibrate(folder_of(session), boards=boards, bootstrap=0)
    assert {row[1] for row in calibration.boards} == {7}


def test_an_own_solver_calibrates(session):
    def through_kabsch(problem):
        return sextant.solve(problem, solver="kabsch")

    calibration = sextant.calibrate(folder_of(session), solvers=[through_kabsch, "kabsch"],
                                    bootstrap=5)
    assert calibration.solver == "through_kabsch"
    pairs = calibration.problem
    assert pairs.points_in_lidar.shape == (16, 3)
    assert np.allclose(sextant.solve(pairs, solver="kabsch").matrix, calibration.matrix, atol=1e-9)


def test_results_are_saved_for_the_program(calibration, tmp_path):
    calibration.save(str(tmp_path / "result.yaml"))
    calibration.save(str(tmp_path / "result.yaml"))
    run = subprocess.run([PROGRAM, "export", tmp_path / "result.yaml", "--to", "ros2", "--force"],
                         capture_output=True, text=True, check=False, cwd=tmp_path)
    assert run.returncode == 0, run.stderr


def test_boards_are_found_in_images_and_scans(session):
    images, clouds = arrays_of(session)
    boards = sextant.read_boards(session.boards)
    in_image = sextant.detect(images[0], boards, session.camera)
    in_scan = sextant.boards(clouds[0], boards)
    assert in_image.boards[0]["corners_in_cam"].shape == (4, 3)
    corners = in_scan.boards[0]["corners"]
    assert corners.shape == (4, 3) and in_scan.boards[0]["covariance"].shape == (12, 12)
    truth = session.true_matrix
    moved = corners @ truth[:3, :3].T + truth[:3, 3]
    # The numbering of a scan may begin at another corner.
    gaps = np.linalg.norm(moved[:, None] - in_image.boards[0]["corners_in_cam"][None], axis=2)
    assert gaps.min(axis=1).max() < 0.05
    assert "board" in repr(in_image) and "board" in repr(in_scan)
    tags = sextant.detect(session.images[0], detector="aruco(dictionary=original)").tags
    assert [tag["id"] for tag in tags] == [26] and tags[0]["corners"].shape == (4, 2)


def test_wrong_input_is_named(session):
    images, clouds = arrays_of(session)
    boards = sextant.read_boards(session.boards)
    camera = sextant.Camera.read(session.camera)
    for arguments, text in [
            (dict(images=images, clouds=clouds[:2]), "as many images as clouds"),
            (dict(images=images, clouds=[c[:, :2] for c in clouds]), "clouds[0]: expected an array"),
            (dict(images=[i.astype(float) for i in images], clouds=clouds), "images[0]: expected"),
            (dict(images=images, clouds=[c * [1, 1, 1, 1, 0.5] for c in
                                         [np.c_[x[:, :4], x[:, 4]] for x in clouds]]), "has ring"),
            (dict(session="nowhere.yaml"), "nowhere.yaml"),
            (dict(session="x", images=images), "not both"),
            (dict(images=images, clouds=clouds, solvers="kabsh"), "did you mean 'kabsch'?")]:
        with pytest.raises(sextant.Error) as raised:
            sextant.calibrate(boards=boards, camera=camera, **arguments)
        assert text in str(raised.value)
    blank = [np.zeros_like(image) for image in images]
    with pytest.raises(sextant.Error) as raised:
        sextant.calibrate(images=blank, clouds=clouds, boards=boards, camera=camera)
    assert raised.value.code == "missing_data"
    with pytest.raises(sextant.Error, match="rectangel"):
        sextant.boards(clouds[0], boards, extractor="rectangel")


def test_the_example_of_a_session_runs(session, tmp_path):
    out = subprocess.run([sys.executable, SOURCE / "examples" / "02_calibrate.py",
                          folder_of(session), tmp_path / "result.yaml"],
                         capture_output=True, text=True, check=True).stdout
    assert "view 003, board 0: kept" in out
    assert out.count("It rests on 4 boards in 4 of 4 views") >= 1
    assert (tmp_path / "result.yaml").exists()


def test_an_interrupt_ends_a_calibration(session):
    # A process that a shell started in the background ignores interrupts.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT))
    began = time.monotonic()
    timer.start()
    try:
        # It would take minutes, and then raise the interrupt too.
        with pytest.raises(KeyboardInterrupt):
            sextant.calibrate(folder_of(session), bootstrap=100000)
        assert time.monotonic() - began < 20.0
    finally:
        timer.join()
        signal.signal(signal.SIGINT, before)
