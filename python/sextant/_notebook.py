# SPDX-License-Identifier: Apache-2.0
"""HTML of results, for notebooks."""

import html

import numpy as np


def preformatted(text):
    return f"<pre>{html.escape(text)}</pre>"


def table(rows, heads=()):
    def line(cells, tag):
        return "<tr>" + "".join(f"<{tag}>{html.escape(str(c))}</{tag}>" for c in cells) + "</tr>"

    head = line(heads, "th") if heads else ""
    return "<table>" + head + "".join(line(row, "td") for row in rows) + "</table>"


def matrix(array):
    return table([[f"{value:.6f}" for value in row] for row in array])


def sigma_lines(sigma):
    if sigma is None:
        return [("1 sigma", "uncertainty unavailable")]
    turn = " ".join(f"{value:.4f}" for value in np.degrees(sigma[:3]))
    shift = " ".join(f"{value:.2f}" for value in sigma[3:] * 1e3)
    return [("1 sigma about x y z", turn + " deg"), ("1 sigma along x y z", shift + " mm")]


def solution_html(solution):
    lines = sigma_lines(solution.sigma)
    if solution.rmse_m is not None:
        lines.append(("RMSE", f"{solution.rmse_m * 1e3:.2f} mm"))
    if solution.rmse_px is not None:
        lines.append(("reprojection RMSE", f"{solution.rmse_px:.3f} px"))
    if len(solution.alternatives):
        lines.append(("other poses that explain the data", len(solution.alternatives)))
    lines += [("note", warning) for warning in solution.warnings]
    return (f"<p><b>cam_from_lidar</b> by {html.escape(solution.solver)}</p>"
            + matrix(solution.matrix) + table(lines))


def comparison_html(comparison):
    rows = []
    for name, solution, (turn, shift) in zip(comparison.solvers, comparison.solutions,
                                             comparison.from_first):
        if solution is None:
            rows.append((name, comparison.failures[name], "", "", ""))
            continue
        error = solution.rmse_m if solution.rmse_m is not None else solution.rmse_px
        unit = "mm" if solution.rmse_m is not None else "px"
        scale = 1e3 if unit == "mm" else 1.0
        rmse = "" if error is None else f"{error * scale:.3f} {unit}"
        rows.append((name, rmse, f"{np.degrees(turn):.4f}", f"{shift * 1e3:.2f}",
                     f"{solution.wall_time_us:.0f}"))
    return table(rows, ("solver", "RMSE", "from first [deg]", "from first [mm]", "time [us]"))


def calibration_html(calibration):
    lines = [("verdict", f"{calibration.verdict}: {calibration.reason}"),
             ("next", calibration.next)] + sigma_lines(calibration.sigma)
    lines += [("note", warning) for warning in calibration.warnings]
    views = [(view["name"], "yes" if view["kept"] else view["reason"],
              "" if view["rmse_m"] is None else f"{view['rmse_m'] * 1e3:.2f}",
              "" if view["rmse_px"] is None else f"{view['rmse_px']:.3f}")
             for view in calibration.views]
    return (f"<p><b>cam_from_lidar</b> by {html.escape(calibration.solver)}</p>"
            + matrix(calibration.matrix) + table(lines)
            + table(views, ("view", "used", "RMSE [mm]", "RMSE [px]")))
