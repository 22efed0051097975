// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solvers/core/registry.h"

namespace sextant {

/// Whether specs may start programs: those that a user types, but not those of a file, unless the
/// user consents.
enum class Commands { kRefused, kAllowed };

/// `command("python3 my_solver.py")`: a program that reads a problem file (io/problems/
/// problem_yaml.h) from its standard input, and writes its answer (io/results/pose_answer.h) to
/// standard output. The text is split at blanks; single quotes hold blanks. No shell is involved.
///
/// The problem is in coordinates near the data, like that of every solver, and has no truth. A
/// covariance that the program does not state stays unknown. Errors: kInvalidOption where commands
/// are refused; kMissingData where there is no such program; kIo where it fails, is killed or does
/// not end in time; those of ParsePoseAnswer.
SolverEntry CommandEntry(Commands commands);

}  // namespace sextant
