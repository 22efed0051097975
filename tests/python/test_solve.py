# SPDX-License-Identifier: Apache-2.0
import json
import subprocess
import threading
import time

import numpy as np
import pytest
import sextant

from scenes import CAMERA, PROGRAM, TRUTH, pairs


def test_pairs_of_points_give_the_pose_with_its_uncertainty():
    in_lidar, in_cam = pairs(20, noise_m=0.005)
    answer = sextant.solve(in_lidar, in_cam, sigma_m=0.005)
    assert answer.solver == "kabsch"
    difference = sextant.testing.pose_difference(answer.matrix, TRUTH)
    assert difference @ np.linalg.solve(answer.covariance, difference) < 22.5  # 99.9 % of chi2(6)
    assert np.allclose(answer.sigma, np.sqrt(np.diag(answer.covariance)))
    assert np.allclose(answer.inverse @ answer.matrix, np.eye(4), atol=1e-12)
    residuals = np.linalg.norm(in_cam - in_lidar @ answer.matrix[:3, :3].T - answer.matrix[:3, 3],
                               axis=1)
    assert np.allclose(answer.residuals_m, residuals, atol=1e-12)
    assert np.isclose(answer.rmse_m, np.sqrt(np.mean(residuals**2)))
    assert answer.inliers.tolist() == list(range(20))


def test_pixels_give_the_pose():
    in_lidar, _ = pairs(12)
    pixels = sextant.project(in_lidar, TRUTH, CAMERA)
    answer = sextant.solve(in_lidar, pixels=pixels, camera=CAMERA, solver="refine(ransac(p3p))")
    assert np.allclose(answer.matrix, TRUTH, atol=1e-6)
    assert answer.rmse_px < 1e-5 and answer.rmse_m is None


def test_two_poses_of_one_board_are_both_given():
    # A square seen head-on from far away: the mirrored tilt explains its pixels, too.
    square = np.array([[8, 0.2, 0.2], [8.01, -0.2, 0.2], [8.01, -0.2, -0.2], [8, 0.2, -0.2]])
    rng = np.random.default_rng(3)
    pixels = sextant.project(square, TRUTH, CAMERA) + rng.normal(0, 0.5, (4, 2))
    answer = sextant.solve(square, pixels=pixels, camera=CAMERA, sigma_px=0.5, solver="refine(ippe)")
    assert answer.alternatives.shape == (1, 4, 4)


def test_a_file_gives_what_the_program_prints(tmp_path):
    in_lidar, in_cam = pairs(8, noise_m=0.005)
    path = tmp_path / "points.txt"
    rows = [" ".join(f"{value:.6f}" for value in row) for row in np.r_[in_lidar, in_cam]]
    path.write_text("8\n" + "\n".join(rows) + "\n")
    answer = sextant.solve(path, solver="gnc(kabsch)")
    run = subprocess.run([PROGRAM, "solve", path, "--solver", "gnc(kabsch)", "--json", "-"],
                         capture_output=True, text=True, check=True)
    theirs, ours = json.loads(run.stdout), json.loads(answer.to_json())
    for one in (theirs, ours):
        for result in one["results"]:
            result.pop("wall_time_us", None)
            for stage in result.get("stages", []):
                stage.pop("wall_time_us", None)
    assert ours == theirs


def test_errors_have_the_message_of_the_program(tmp_path):
    path = tmp_path / "points.txt"
    path.write_text("2\n1 0 0\n0 1 0\n1 0 0\n0 1 0\n")
    run = subprocess.run([PROGRAM, "solve", path], capture_output=True, text=True, check=False)
    with pytest.raises(sextant.Error) as raised:
        sextant.solve(path)
    assert run.stderr.strip() == f"sextant solve: {raised.value}"
    assert raised.value.code == "too_few_pairs"


def test_wrong_arguments_are_named():
    in_lidar, in_cam = pairs()
    for arguments, text in [
            (dict(points_in_cam=in_cam[:, :2]), "points_in_cam: expected an array of shape (N, 3)"),
            (dict(points_in_cam=in_cam[:5]), "one row for each of the 8 LiDAR points, got 5"),
            (dict(points_in_cam="x"), "points_in_cam: expected an array of numbers"),
            (dict(points_in_cam=in_cam, sigma_m=[1, 2]), "sigma_m: expected a number or an array"),
            (dict(points_in_cam=in_cam, initial=np.diag([1, 1, -1, 1])), "initial: its 3x3 part"),
            (dict(points_in_cam=in_cam, views=[0.5] * 8), "views: expected whole numbers, got 0.5"),
            (dict(points_in_cam=in_cam, solver="kabsh"), "did you mean 'kabsch'?"),
            (dict(points_in_cam=in_cam, solver=3), "expected a solver as text or a function")]:
        with pytest.raises(sextant.Error) as raised:
            sextant.solve(in_lidar, **arguments)
        assert text in str(raised.value)


def test_any_numbers_are_taken():
    in_lidar, in_cam = pairs()
    for change in (lambda a: a.tolist(), lambda a: a.astype(np.float32), np.asfortranarray,
                   lambda a: np.repeat(a, 2, axis=0)[::2]):
        answer = sextant.solve(change(in_lidar), change(in_cam))
        assert np.allclose(answer.matrix, TRUTH, atol=1e-5)


def test_compare_lists_every_solver_with_reasons():
    in_lidar, in_cam = pairs(12, noise_m=0.005)
    comparison = sextant.compare(in_lidar, in_cam, solvers=["kabsch", "gnc(kabsch)", "p3p"])
    assert comparison.solvers == ["kabsch", "gnc(kabsch)", "p3p"]
    assert comparison.solutions[2] is None
    assert "2D-3D pairs" in comparison.failures["p3p"]
    assert comparison.from_first.shape == (3, 2)
    assert np.isnan(comparison.from_first[2]).all()
    assert "gnc(kabsch)" in repr(comparison)
    assert len(json.loads(comparison.to_json())["results"]) == 3
    assert len(sextant.compare(in_lidar, in_cam).solvers) > 5


def test_results_show_themselves():
    in_lidar, in_cam = pairs()
    answer = sextant.solve(in_lidar, in_cam)
    assert "cam_from_lidar" in repr(answer)
    assert "<table>" in answer._repr_html_()
    assert "<table>" in sextant.compare(in_lidar, in_cam, solvers=["kabsch", "p3p"])._repr_html_()


def test_projection_and_rays_are_inverse():
    in_lidar, in_cam = pairs()
    for camera in (CAMERA, sextant.Camera(600, 600, 320, 240, distortion=[-0.2, 0.05, 0, 0]),
                   sextant.Camera(300, 300, 320, 240, model="equidistant")):
        pixels = camera.project(in_cam)
        rays = camera.unproject(pixels)
        assert np.allclose(rays, in_cam / np.linalg.norm(in_cam, axis=1)[:, None], atol=1e-9)
    assert np.isnan(CAMERA.project([[0, 0, -1.0]])).all()
    with pytest.raises(sextant.Error, match="unknown camera model 'pinole'"):
        sextant.Camera(600, 600, 320, 240, model="pinole")


def test_other_threads_run_while_a_solver_computes():
    rng = np.random.default_rng(5)
    cloud = rng.uniform(-1, 1, (1500, 3)) + [4, 0, 0]
    problem = sextant.Problem(set_in_lidar=cloud, set_in_cam=cloud @ TRUTH[:3, :3].T + TRUTH[:3, 3],
                              initial=TRUTH)
    running = threading.Event()
    ticks = []

    def tick():
        while running.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0)

    running.set()
    thread = threading.Thread(target=tick)
    thread.start()
    start = time.perf_counter()
    for _ in range(20):
        sextant.solve(problem, solver="icp")
    end = time.perf_counter()
    running.clear()
    thread.join()
    # With the GIL held, the thread would tick between the calls alone, if at all.
    assert sum(start < t < end for t in ticks) > 60


def test_what_is_no_transform_or_has_hidden_values_is_refused():
    in_lidar, in_cam = pairs(8)
    for wrong in (np.diag([-1.0, 1, 1, 1]), np.diag([2.0, 2, 1, 1]), np.eye(3)):
        with pytest.raises(sextant.Error, match="cam_from_lidar"):
            sextant.project(in_lidar, wrong, CAMERA)
    with pytest.raises(sextant.Error, match="mask"):
        sextant.solve(np.ma.masked_array(in_lidar, mask=in_lidar > 3), in_cam)
    with pytest.raises(sextant.Error, match="real numbers"):
        sextant.solve(in_lidar + 1j, in_cam)
