// SPDX-License-Identifier: Apache-2.0
#pragma once

// The commands reach AllSolvers() through this header until each includes the library's own.
#include "solvers/all/all_solvers.h"
