// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "solvers/joint/joint_information.h"

namespace sextant {

/// The median contradiction of the views over its expectation: by how much the squared differences
/// between the sensors exceed the noise. Robust to nearly half of the views being wrong; 1 where no
/// view can be compared.
double ContradictionScale(const std::vector<ViewSums>& sums);

/// How much each view differs from the others, as the quantile of a standard normal variable: the
/// quotient of its squared difference to the expected one is taken as F-distributed. Noise that was
/// underestimated raises the expectation. 0 for views without a difference.
std::vector<double> Disagreements(const std::vector<ViewSums>& sums);

/// The views that contradict the others by more than `sigmas`, at the level of ContradictionScale.
/// The quotient of both is taken as F-distributed, so that the fewer views there are, the more one
/// must differ. Of views not in `before`, only those within a factor of two of the worst: one that
/// is wrong makes others appear so. A view in `before` returns when it is clearly within the limit.
/// None where it would be half of the views or more.
std::vector<bool> ContradictingViews(const std::vector<ViewSums>& sums,
                                     const std::vector<bool>& before, double sigmas);

}  // namespace sextant
