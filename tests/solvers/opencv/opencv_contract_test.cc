// SPDX-License-Identifier: Apache-2.0
// OpenCV's solvers under the contract of ours. What they fail is excused by name, with the reason.
#include <map>
#include <utility>

#include "solvers/opencv/opencv_solvers.h"
#include "support/under_contract.h"

namespace sextant {

SolverRegistry RegistryUnderContract() {
  SolverRegistry registry;
  AddOpenCvSolvers(registry);
  return registry;
}

std::vector<std::string> SpecsUnderContract() {
  std::vector<std::string> specs;
  const SolverRegistry registry = RegistryUnderContract();
  for (const SolverEntry& entry : registry.entries()) specs.push_back(entry.name);
  return specs;
}

std::string ExcuseFrom(const std::string& promise, const std::string& spec) {
  const std::string three = "solves three of the first four pairs, however they lie";
  const std::string samples = "ends with the inliers of its samples, not with a minimum over them";
  const std::map<std::pair<std::string, std::string>, std::string> excuses = {
      {{"RecoversExactData", "opencv.p3p"}, three + ", and leaves them 1e-6 off"},
      {{"OrderOfThePairsDoesNotMatter", "opencv.p3p"}, three},
      {{"CovarianceIsHonest", "opencv.p3p"},
       three + "; first order says little of a flat triangle"},
      {{"RecoversExactData", "opencv.ransac_epnp"}, "its EPnP leaves 3e-7 m"},
      {{"CovarianceIsHonest", "opencv.ransac_epnp"},
       "ends with EPnP, which errs more than the least squares whose covariance it is given"},
      {{"RecoversExactData", "opencv.magsac"}, samples},
      {{"AnswerMovesWithTheLidarFrame", "opencv.magsac"}, samples},
  };
  const auto found = excuses.find({promise, spec});
  return found == excuses.end() ? std::string() : found->second;
}

}  // namespace sextant
