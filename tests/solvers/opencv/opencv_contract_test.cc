// SPDX-License-Identifier: Apache-2.0
// The contract tests for OpenCV's solvers. The properties that they lack are listed with reasons.
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

std::string ExcuseFrom(const std::string& property, const std::string& spec) {
  const std::string three = "uses three of the first four pairs, whatever their geometry";
  const std::string samples =
      "ends with a pose of its samples, not with a minimum over the inliers";
  const std::map<std::pair<std::string, std::string>, std::string> excuses = {
      {{"RecoversExactData", "opencv.p3p"}, three + ", with errors of 1e-6"},
      {{"OrderOfThePairsDoesNotMatter", "opencv.p3p"}, three},
      {{"CovarianceIsConsistent", "opencv.p3p"},
       three + "; a first-order covariance is poor for a flat triangle"},
      {{"RecoversExactData", "opencv.ransac_epnp"}, "its EPnP has errors of 3e-7 m"},
      {{"CovarianceIsConsistent", "opencv.ransac_epnp"},
       "ends with EPnP, whose errors exceed those of the least squares that the covariance "
       "assumes"},
      {{"RecoversExactData", "opencv.magsac"}, samples},
      {{"AnswerMovesWithTheLidarFrame", "opencv.magsac"}, samples},
  };
  const auto found = excuses.find({property, spec});
  return found == excuses.end() ? std::string() : found->second;
}

}  // namespace sextant
