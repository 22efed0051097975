# SPDX-License-Identifier: Apache-2.0
"""Build backend of pyproject.toml (PEP 517): CMake builds the module, this makes a wheel of it."""

import base64
import hashlib
import os
import re
import subprocess
import sys
import sysconfig
import tempfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def get_requires_for_build_wheel(config_settings=None):
    return []


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """config_settings: build-dir=FOLDER takes an existing CMake build of this source."""
    build = (config_settings or {}).get("build-dir")
    build = Path(build) if build else _configure(ROOT / "build" / "wheel")
    _run("cmake", "--build", build, "--target", "sextant_python", "-j", str(os.cpu_count() or 1))
    with tempfile.TemporaryDirectory() as staging:
        _run("cmake", "--install", build, "--component", "python", "--strip", "--prefix", staging)
        package = next(Path(staging).rglob("sextant/__init__.py")).parent
        files = {f"sextant/{path.name}": path.read_bytes() for path in sorted(package.iterdir())
                 if path.is_file()}
    return _write_wheel(Path(wheel_directory), files)


def build_sdist(sdist_directory, config_settings=None):
    raise RuntimeError("there is no source distribution of sextant; install from its repository")


def _configure(build):
    _run("cmake", "-S", ROOT, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
         "-DCMAKE_UNITY_BUILD=ON", "-DCMAKE_UNITY_BUILD_BATCH_SIZE=12", "-DBUILD_TESTING=OFF",
         "-DSEXTANT_BENCH=OFF", "-DSEXTANT_MPI=OFF", f"-DPython_EXECUTABLE={sys.executable}")
    cache = (build / "CMakeCache.txt").read_text()
    if not re.search(r"^Python_EXECUTABLE", cache, re.M) or "pybind11_DIR:PATH=/" not in cache:
        raise RuntimeError("pybind11, numpy or Python's headers were not found for this Python; on "
                           "Debian: apt-get install pybind11-dev python3-dev python3-numpy")
    return build


def _run(*command):
    subprocess.run([str(part) for part in command], check=True)


def _version():
    text = (ROOT / "CMakeLists.txt").read_text()
    return re.search(r"project\(sextant VERSION ([0-9.]+)", text).group(1)


def _write_wheel(folder, files):
    version = _version()
    python = f"cp{sys.version_info[0]}{sys.version_info[1]}"
    tag = f"{python}-{python}-{re.sub('[-.]', '_', sysconfig.get_platform())}"
    info = f"sextant-{version}.dist-info"
    files[f"{info}/METADATA"] = (
        f"Metadata-Version: 2.1\nName: sextant\nVersion: {version}\n"
        "Summary: Rigid transform between a LiDAR and a camera\nLicense: Apache-2.0\n"
        "Requires-Python: >=3.9\nRequires-Dist: numpy\n").encode()
    files[f"{info}/LICENSE"] = (ROOT / "LICENSE").read_bytes()
    files[f"{info}/WHEEL"] = (
        f"Wheel-Version: 1.0\nGenerator: sextant\nRoot-Is-Purelib: false\nTag: {tag}\n").encode()
    files[f"{info}/RECORD"] = _record(files, f"{info}/RECORD")
    name = f"sextant-{version}-{tag}.whl"
    with zipfile.ZipFile(folder / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, content in files.items():
            wheel.writestr(path, content)
    return name


def _record(files, own):
    def line(path, content):
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        return f"{path},sha256={digest},{len(content)}\n"

    return ("".join(line(*item) for item in files.items()) + f"{own},,\n").encode()
