# SPDX-License-Identifier: Apache-2.0
"""The contract of solvers, for solvers of your own: the properties that sextant's own are held to."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np

from . import _core
from ._error import Error
from ._own import needs_of, spec_of

_CAMERA = dict(fx=800, fy=800, cx=639.5, cy=479.5, width=1280, height=960)
_NOISE_M, _NOISE_PX = 0.005, 0.5
_TRIALS = 200


class _Scene:
    """Points 2 to 6 m in front of the camera, seen by both sensors, with the true pose."""

    def __init__(self, needs, rng, pairs=12, noise=0.0, on_line=None):
        self.needs = needs
        self.camera = _core.Camera(**_CAMERA)
        small = needs["initial_pose"]
        self.truth = _random_pose(rng, 0.1 if small else np.pi)
        in_cam = np.c_[rng.uniform(-1, 1, (pairs, 2)), np.ones(pairs)] * rng.uniform(2, 6, (pairs, 1))
        in_cam[:, :2] *= 0.5
        if on_line is not None:
            in_cam = np.array([0.0, 0.2, 3.0]) + np.linspace(0, on_line, pairs)[:, None] * [1, 0, 0]
        self.in_lidar = (in_cam - self.truth[:3, 3]) @ self.truth[:3, :3]
        self.pixels = self.camera.project(in_cam) + noise * _NOISE_PX * rng.normal(size=(pairs, 2))
        self.in_cam = in_cam + noise * _NOISE_M * rng.normal(size=(pairs, 3))
        self.sigma = noise

    def problem(self, order=slice(None), **changes):
        data = dict(in_lidar=self.in_lidar, in_cam=self.in_cam, pixels=self.pixels,
                    sigma_m=self.sigma * _NOISE_M, sigma_px=self.sigma * _NOISE_PX,
                    initial=self.truth)
        data.update(changes)
        arguments = dict(camera=self.camera)
        if self.needs["pairs_2d3d"]:
            arguments.update(pixels=data["pixels"][order], sigma_px=data["sigma_px"])
        if self.needs["pairs_3d3d"]:
            arguments.update(points_in_cam=data["in_cam"][order], sigma_m=data["sigma_m"])
        if self.needs["points_per_set"]:
            arguments.update(set_in_lidar=data["in_lidar"][order], set_in_cam=data["in_cam"])
        if self.needs["initial_pose"]:
            arguments.update(initial=data["initial"])
        return _core.Problem(data["in_lidar"][order], **arguments)


def _random_pose(rng, max_angle):
    axis = rng.normal(size=3)
    angle = rng.uniform(0, max_angle)
    pose = np.eye(4)
    pose[:3, :3] = _exp(axis / np.linalg.norm(axis) * angle)
    pose[:3, 3] = rng.uniform(-0.5, 0.5, 3)
    return pose


def _exp(phi):
    angle = np.linalg.norm(phi)
    if angle < 1e-12:
        return np.eye(3)
    x, y, z = phi / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def pose_difference(matrix, reference):
    """(dphi [rad], dt [m]), (6,): R = Exp(dphi) R_ref, t = t_ref + dt, as covariances have it."""
    turn = matrix[:3, :3] @ reference[:3, :3].T
    axis = 0.5 * np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    sine, cosine = np.linalg.norm(axis), 0.5 * (np.trace(turn) - 1)
    phi = axis if sine < 1e-12 else axis / sine * np.arctan2(sine, cosine)
    return np.r_[phi, matrix[:3, 3] - reference[:3, 3]]


class _Contract:
    """One method per property; each returns nothing, or raises AssertionError."""

    def __init__(self, spec, needs):
        self.spec = spec
        self.needs = needs

    def solve(self, problem):
        return _core.solve_problem(problem, self.spec)

    def scene(self, seed, **options):
        return _Scene(self.needs, np.random.default_rng(seed), **options)

    def same_pose(self, a, b, tolerance, what):
        off = np.abs(pose_difference(a, b)).max()
        assert off < tolerance, f"{what}: the poses differ by {off:.2g} rad or m"

    def refuses(self, problem, codes, what):
        try:
            self.solve(problem)
        except Error as error:
            assert error.code in codes, (
                f"{what}: expected the error {' or '.join(codes)}, got {error.code}: {error}")
            return
        raise AssertionError(f"{what}: expected the error {' or '.join(codes)}, got an answer")

    def check_recovers_exact_data(self):
        for seed in range(20):
            scene = self.scene(seed)
            self.same_pose(self.solve(scene.problem()).matrix, scene.truth, 1e-6, f"scene {seed}")

    def check_answer_moves_with_the_lidar_frame(self):
        scene = self.scene(2, noise=1.0)
        other_from_lidar = np.eye(4)
        other_from_lidar[:3, 3] = [0.3, -0.2, 0.1]
        if not self.needs["initial_pose"]:
            other_from_lidar[:3, :3] = _exp(np.array([0.4, -1.1, 0.7]))
        moved = scene.in_lidar @ other_from_lidar[:3, :3].T + other_from_lidar[:3, 3]
        there = self.solve(scene.problem(in_lidar=moved,
                                         initial=scene.truth @ np.linalg.inv(other_from_lidar)))
        self.same_pose(there.matrix @ other_from_lidar, self.solve(scene.problem()).matrix, 1e-5,
                       "another mounting of the LiDAR")

    def check_order_of_the_pairs_does_not_matter(self):
        scene = self.scene(4, noise=1.0)
        backward = self.solve(scene.problem(order=slice(None, None, -1)))
        self.same_pose(backward.matrix, self.solve(scene.problem()).matrix, 1e-5, "pairs reversed")

    def check_same_problem_same_bits(self):
        problem = self.scene(5, noise=1.0).problem()
        first = self.solve(problem).matrix
        assert np.array_equal(first, self.solve(problem).matrix), "the second answer differs"
        with ThreadPoolExecutor(4) as threads:
            for other in threads.map(lambda _: self.solve(problem).matrix, range(4)):
                assert np.array_equal(first, other), "the answer differs on another thread"

    def check_names_missing_data(self):
        self.refuses(_core.Problem(camera=_core.Camera(**_CAMERA)), ["missing_data"], "no data")

    def check_refuses_too_few_pairs(self):
        fewest = max(self.needs["pairs_3d3d"], self.needs["pairs_2d3d"], self.needs["points_per_set"])
        if fewest > 1:
            self.refuses(self.scene(9, pairs=fewest - 1).problem(), ["too_few_pairs"],
                         f"{fewest - 1} pairs")

    def check_refuses_numbers_that_are_not_finite(self):
        for bad in (np.nan, np.inf):
            scene = self.scene(10)
            scene.in_cam[5, 1] = scene.pixels[5, 1] = bad
            self.refuses(scene.problem(), ["non_finite"], f"a number that is {bad}")

    def check_refuses_collinear_and_coincident_points(self):
        for length in (1.0, 0.0):
            self.refuses(self.scene(12, on_line=length).problem(), ["degenerate", "no_consensus"],
                         "points on a line" if length else "the same point twelve times")

    def check_never_answers_with_numbers_that_are_not_finite(self):
        for scale in (1e-200, 1e-12, 1e12, 1e150):
            scene = self.scene(13)
            with np.errstate(all="ignore"):
                try:
                    answer = self.solve(scene.problem(in_lidar=scene.in_lidar * scale,
                                                      in_cam=scene.in_cam * scale))
                except Error:
                    continue
            assert np.isfinite(answer.matrix).all(), f"coordinates times {scale}"

    def check_stated_covariance_is_consistent(self):
        total = 0.0
        for seed in range(_TRIALS):
            scene = self.scene(1000 + seed, pairs=20, noise=1.0)
            answer = self.solve(scene.problem())
            if answer.covariance is None:
                return
            error = pose_difference(answer.matrix, scene.truth)
            total += error @ np.linalg.solve(answer.covariance, error) / 6.0
        # Five standard errors, and 5 percent for what a first-order covariance neglects.
        allowed = 5.0 * np.sqrt(2.0 / (6.0 * _TRIALS)) + 0.05
        mean = total / _TRIALS
        assert abs(mean - 1.0) < allowed, (
            f"errors squared over the stated covariance average {mean:.2f}, expected 1")

    def check_combinators_make_it_robust(self):
        if self.needs["initial_pose"] or self.needs["points_per_set"]:
            return
        scene = self.scene(14, pairs=30, noise=1.0)
        scene.in_cam[::5] += 0.8
        scene.pixels[::5] += 90.0
        answer = _core.solve_problem(scene.problem(), f"ransac({self.spec})")
        self.same_pose(answer.matrix, scene.truth, 0.05, "ransac with every fifth pair wrong")


def check_solver(f, **needs):
    """Holds a solver to the contract: AssertionError with every property that it lacks.

    f: a function, which is registered with the given needs (see register), or the spec of a
    solver that Python registered. Returns the names of the properties that hold. The covariance is
    only checked where the solver states one.
    """
    if needs or not isinstance(f, str):
        from ._own import register

        name = register(f, **needs) if needs else spec_of(f)
    else:
        name = f
    contract = _Contract(name, needs_of(name.split("(")[0]))
    held, lacking = [], []
    for attribute in sorted(vars(_Contract)):
        if not attribute.startswith("check_"):
            continue
        title = attribute[len("check_"):].replace("_", " ")
        try:
            getattr(contract, attribute)()
            held.append(title)
        except (AssertionError, Error) as problem:
            lacking.append(f"{title}: {problem}")
    if lacking:
        raise AssertionError(f"{name} lacks {len(lacking)} of {len(held) + len(lacking)} "
                             "properties of the contract:\n  " + "\n  ".join(lacking))
    return held
