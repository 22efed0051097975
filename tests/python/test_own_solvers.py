# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
import sextant
import sextant.testing

from scenes import CAMERA, TRUTH, kabsch, pairs


def refusal_of(f, **needs):
    in_lidar, in_cam = pairs()
    sextant.register(f, "refused", **needs)
    with pytest.raises(sextant.Error) as raised:
        sextant.solve(in_lidar, in_cam, solver="refused")
    return raised.value


def test_a_function_is_a_solver_alone_and_in_every_combinator():
    in_lidar, in_cam = pairs(20, noise_m=0.002)
    in_cam[::5] += 0.5
    sextant.register(kabsch, "own_kabsch")
    for spec in ("ransac(own_kabsch)", "gnc(own_kabsch)", "drop_worst(own_kabsch,keep=16)",
                 "refine(ransac(own_kabsch))"):
        answer = sextant.solve(in_lidar, in_cam, sigma_m=0.002, solver=spec)
        assert np.allclose(answer.matrix, TRUTH, atol=0.02), spec
        assert 16 == len(answer.inliers), spec
    comparison = sextant.compare(in_lidar, in_cam, solvers=["kabsch", kabsch])
    assert comparison.from_first[1].max() < 1e-9
    assert {"name": "own_kabsch"}.items() <= [s for s in sextant.solvers()
                                              if s["name"] == "own_kabsch"][0].items()


def test_options_are_keyword_parameters():
    seen = []

    def shifted(problem, *, by=0.0, rounds=1, mode="plain", quick=False):
        seen.append((by, rounds, mode, quick))
        matrix = np.eye(4)
        matrix[0, 3] = by
        return matrix

    in_lidar, _ = pairs()
    in_cam = in_lidar + [0.5, 0, 0]
    sextant.register(shifted)
    answer = sextant.solve(in_lidar, in_cam, solver="shifted(by=0.5,rounds=3,mode=fast,quick=true)")
    assert seen[-1] == (0.5, 3, "fast", True)
    assert answer.solver == "shifted(by=0.5,rounds=3,mode=fast,quick=true)"
    for spec, text in [("shifted(by=x)", "by: expected float, got 'x'"),
                       ("shifted(quick=2)", "quick: expected true or false"),
                       ("shifted(bye=1)", "has no option 'bye'")]:
        with pytest.raises(sextant.Error, match=None) as raised:
            sextant.solve(in_lidar, in_cam, solver=spec)
        assert text in str(raised.value)


def test_an_estimate_states_covariance_inliers_and_alternatives():
    in_lidar, in_cam = pairs(noise_m=0.002)
    covariance = np.diag([1e-6] * 3 + [1e-5] * 3)

    @sextant.solver("with_covariance")
    def f(problem):
        return sextant.Estimate(kabsch(problem), covariance=covariance, inliers=[2, 0, 1],
                                warnings=["a note"], iterations=7)

    answer = sextant.solve(in_lidar, in_cam, sigma_m=0.002, solver=f)
    assert answer.solver == "with_covariance"
    assert answer.inliers.tolist() == [0, 1, 2]
    assert answer.iterations == 7 and "a note" in answer.warnings
    # Moved from the data's middle, where solvers work, to the LiDAR's origin.
    assert np.allclose(answer.covariance[:3, :3], covariance[:3, :3])


def test_a_solution_is_an_answer_too():
    @sextant.solver("delegate", pairs_2d3d=4)
    def delegate(problem):
        return sextant.solve(problem, solver="refine(epnp)")

    in_lidar, _ = pairs(12)
    pixels = sextant.project(in_lidar, TRUTH, CAMERA)
    answer = sextant.solve(in_lidar, pixels=pixels, camera=CAMERA, solver=delegate)
    assert np.allclose(answer.matrix, TRUTH, atol=1e-6)
    assert answer.covariance is not None


def test_nonsense_is_refused_with_its_reason():
    for answer, text in [(np.full((4, 4), np.nan), "NaN or infinite"),
                         (np.eye(3), "expected a matrix of shape (4, 4) or (3, 4), got (3, 3)"),
                         (np.diag([1, 1, -1, 1.0]), "a reflection"),
                         (np.diag([2, 2, 2, 1.0]), "not a rotation"),
                         (np.ones((4, 4)), "expected 0 0 0 1"),
                         ("text", "expected an array of numbers, got str"),
                         ({}, "expected an array of numbers, got dict")]:
        error = refusal_of(lambda problem, answer=answer: answer)
        assert error.code == "invalid_input"
        assert text in str(error) and "refused" in str(error)
    assert refusal_of(lambda problem: None).code == "no_consensus"
    for arguments, text in [(dict(covariance=-np.eye(6)), "covariance: expected a symmetric"),
                            (dict(covariance=np.eye(3)), "covariance: expected an array of shape"),
                            (dict(inliers=[8]), "expected numbers of pairs from 0 to 7, got 8"),
                            (dict(alternatives=[np.zeros((4, 4))]), "alternatives")]:
        error = refusal_of(lambda problem, a=arguments: sextant.Estimate(np.eye(4), **a))
        assert text in str(error)


def test_exceptions_become_refusals_with_text_and_place():
    def broken(problem):
        return problem.points_in_lidra

    error = refusal_of(broken)
    assert "AttributeError" in str(error) and "points_in_lidra" in str(error)
    assert "test_own_solvers.py:" in str(error)

    class Unprintable(Exception):
        def __str__(self):
            raise RuntimeError

    def unprintable(problem):
        raise Unprintable

    assert "an exception whose text raises another" in str(refusal_of(unprintable))

    def degenerate(problem):
        raise sextant.Error("all points on a line", code="degenerate")

    error = refusal_of(degenerate)
    assert error.code == "degenerate"
    assert str(error) == "no answer of refused: refused: all points on a line"
    assert refusal_of(lambda p: np.linalg.inv(np.zeros((3, 3)))).code == "degenerate"


def test_too_little_data_is_refused_before_the_call():
    def never(problem):
        raise AssertionError

    in_lidar, in_cam = pairs(4)
    sextant.register(never, pairs_3d3d=5)
    with pytest.raises(sextant.Error, match="never needs at least 5 3D-3D pairs, got 4"):
        sextant.solve(in_lidar, in_cam, solver="never")
    sextant.register(never, pairs_2d3d=5)
    with pytest.raises(sextant.Error, match="never needs 2D-3D pairs, and the problem has none"):
        sextant.solve(in_lidar, in_cam, solver="never")


def test_names_are_checked():
    for name, text in [("kabsch", "kabsch is a solver of sextant"), ("a b", "cannot name a solver"),
                       ("f(g)", "cannot name a solver")]:
        with pytest.raises(sextant.Error) as raised:
            sextant.register(kabsch, name)
        assert text in str(raised.value)
    in_lidar, in_cam = pairs()
    with pytest.raises(sextant.Error, match="cannot name a solver"):
        sextant.solve(in_lidar, in_cam, solver=lambda problem: np.eye(4))


def test_a_name_may_be_given_again():
    in_lidar, _ = pairs()
    for shift in (0.0, 1.0):
        def again(problem, shift=shift):
            return np.c_[np.eye(3), [shift, 0, 0]]

        sextant.register(again)
        answer = sextant.solve(in_lidar, in_lidar + [shift, 0, 0], solver="again")
        assert answer.matrix[0, 3] == shift


def test_the_contract_holds_or_names_what_is_lacking():
    sextant.register(kabsch, "kabsch_by_contract")  # kabsch is a solver of sextant's own.
    held = sextant.testing.check_solver(kabsch)
    assert len(held) == 11

    def refined(problem):
        return sextant.solve(problem, solver="refine(kabsch)")

    assert sextant.testing.check_solver(refined) == held

    def of_pixels(problem):
        return sextant.solve(problem, solver="sqpnp")

    assert len(sextant.testing.check_solver(of_pixels, pairs_2d3d=3)) == 11

    calls = []

    def careless(problem):  # Answers for points on a line, and never twice the same.
        calls.append(1)
        a, b = problem.points_in_lidar, problem.points_in_cam
        u, _, vt = np.linalg.svd((b - b.mean(0)).T @ (a - a.mean(0)))
        turn = u @ np.diag([1, 1, np.linalg.det(u @ vt)]) @ vt
        return np.c_[turn, b.mean(0) - turn @ a.mean(0) + 1e-9 * len(calls)]

    with pytest.raises(AssertionError) as raised:
        sextant.testing.check_solver(careless)
    assert "refuses collinear and coincident points" in str(raised.value)
    assert "same problem same bits" in str(raised.value)
    assert "lacks 2 of 11" in str(raised.value)
