# SPDX-License-Identifier: Apache-2.0
# Images and scans of boards -> cam_from_lidar. Usage: 02_calibrate.py SESSION [RESULT.yaml]
import sys

import sextant

if len(sys.argv) < 2:
    sys.exit("usage: 02_calibrate.py SESSION [RESULT.yaml]")
try:
    # A session file, a folder with one, a folder of `sextant simulate`, or a recording of ROS.
    calibration = sextant.calibrate(sys.argv[1])
except sextant.Error as error:
    sys.exit(str(error))

for view, board, status, why in calibration.boards:
    print(f"view {view}, board {board}: {status} {why}")
print(calibration.matrix.round(6))
print(f"{calibration.verdict}: {calibration.reason} {calibration.next}")
if len(sys.argv) > 2:
    calibration.save(sys.argv[2])

# The same from arrays, as a driver would give them.
session = sextant.read_session(sys.argv[1])
again = sextant.calibrate(
    images=[sextant.read_image(path) for path in session.images],
    clouds=[sextant.read_cloud(path) for path in session.clouds],
    boards=session.boards, camera=session.camera, bootstrap=0)
print(again.closing)
