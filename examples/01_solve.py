# SPDX-License-Identifier: Apache-2.0
# Points that both sensors measured -> cam_from_lidar with its uncertainty.
import numpy as np
import sextant

# The corners of two boards [m] in the LiDAR frame, and the same in the camera frame.
in_lidar = np.array([[1.901, 0.506, 0.341], [1.997, 0.172, 0.001], [1.912, 0.503, -0.347],
                     [1.806, 0.823, -0.012], [2.400, -0.542, 0.439], [2.280, -0.873, 0.111],
                     [2.389, -0.566, -0.239], [2.520, -0.231, 0.087]])
in_cam = np.array([[-0.501, -0.428, 1.821], [-0.178, -0.091, 1.934], [-0.511, 0.250, 1.827],
                   [-0.827, -0.099, 1.712], [0.527, -0.511, 2.353], [0.850, -0.176, 2.258],
                   [0.540, 0.165, 2.359], [0.203, -0.168, 2.464]])

# sigma_m is 1 sigma per axis of their difference; without it, it is estimated from the pairs.
answer = sextant.solve(in_lidar, in_cam, sigma_m=0.007, solver="gnc(kabsch)")
print("cam_from_lidar")
print(answer.matrix.round(6))
print("1 sigma about x y z:", np.degrees(answer.sigma[:3]).round(3), "deg")
print("1 sigma along x y z:", (answer.sigma[3:] * 1e3).round(1), "mm")
print(sextant.compare(in_lidar, in_cam, sigma_m=0.007, solvers=["kabsch", "gnc(kabsch)"]))
