// SPDX-License-Identifier: Apache-2.0
#include "solvers/opencv/opencv_solvers.h"

#include "solvers/opencv/opencv_pnp.h"

namespace sextant {
namespace {

SolverEntry Entry(const std::string& name, DataNeeds needs, std::string needs_in_words,
                  std::string summary, std::string reference, PnpKernel kernel,
                  PnpCovariance covariance) {
  return {
      .name = name,
      .summary = std::move(summary),
      .needs = std::move(needs_in_words),
      .reference = std::move(reference),
      .example = name,
      .make = [needs, kernel = std::move(kernel),
               covariance](const SolverArguments& arguments) -> Expected<SolverPtr> {
        return std::make_shared<PnpSolver>(SolverSpec{.name = arguments.name, .needs = needs},
                                           kernel, covariance);
      },
  };
}

PnpKernel OnAllPairs(OpenCvPnp method) {
  return [method](const PnpInput& input) { return SolveOpenCvPnp(input, method); };
}

using RansacFunction = Expected<PnpPoses> (*)(const PnpInput&, const OpenCvRansacOptions&);

SolverEntry RansacEntry(const std::string& name, std::string summary, std::string reference,
                        RansacFunction run) {
  const OptionSet<OpenCvRansacOptions> options =
      OptionSet<OpenCvRansacOptions>()
          .Count("max_iterations", &OpenCvRansacOptions::max_iterations, 1, 1000000,
                 "maximum number of samples")
          .Real("threshold_px", &OpenCvRansacOptions::threshold_px, "px", 1e-6, 1e6,
                "largest reprojection error of an inlier")
          .Real("confidence", &OpenCvRansacOptions::confidence, "1", 0.01, 0.999999,
                "probability of having drawn a sample without outliers when the search stops");
  return {
      .name = name,
      .summary = std::move(summary),
      .needs = "4 or more 2D-3D pairs",
      .reference = std::move(reference),
      .example = name,
      .options = options.Describe(),
      .make = [options, run](const SolverArguments& arguments) -> Expected<SolverPtr> {
        SEXTANT_ASSIGN_OR_RETURN(const OpenCvRansacOptions parsed,
                                 options.Parse(arguments.options));
        return std::make_shared<PnpSolver>(
            SolverSpec{.name = arguments.name, .needs = {.pairs_2d3d = 4}},
            [run, ransac = parsed](const PnpInput& input) { return run(input, ransac); },
            PnpCovariance::kLeastSquares);
      },
  };
}

}  // namespace

void AddOpenCvSolvers(SolverRegistry& registry) {
  const std::string four = "4 or more 2D-3D pairs, not on one line";
  registry.Add(Entry(
      "opencv.epnp", {.pairs_2d3d = 4}, four, "OpenCV's EPnP; fails on planes and on 4 pairs",
      "Lepetit et al. 2009; cv::solvePnP", OnAllPairs(OpenCvPnp::kEpnp), PnpCovariance::kMoments));
  registry.Add(Entry("opencv.sqpnp", {.pairs_2d3d = 3}, "3 or more 2D-3D pairs, not on one line",
                     "OpenCV's SQPnP: global least squares in object space",
                     "Terzakis and Lourakis 2020; cv::solvePnP", OnAllPairs(OpenCvPnp::kSqpnp),
                     PnpCovariance::kObjectSpace));
  registry.Add(Entry("opencv.ippe", {.pairs_2d3d = 4, .points_on_plane = true},
                     "4 or more 2D-3D pairs on one plane, not on one line",
                     "OpenCV's pose from the derivative of a homography, both solutions",
                     "Collins and Bartoli 2014; cv::solvePnPGeneric", OnAllPairs(OpenCvPnp::kIppe),
                     PnpCovariance::kMoments));
  registry.Add(Entry(
      "opencv.p3p", {.pairs_2d3d = 3}, "3 or more 2D-3D pairs, not on one line",
      "OpenCV's P3P on the widest triangle of the first four points; all pairs choose the pose",
      "Gao et al. 2003; cv::solveP3P", SolveOpenCvP3p, PnpCovariance::kTriple));
  registry.Add(Entry("opencv.iterative", {.pairs_2d3d = 4}, four,
                     "OpenCV's Levenberg-Marquardt on the reprojection error, from a DLT",
                     "cv::solvePnP", OnAllPairs(OpenCvPnp::kIterative),
                     PnpCovariance::kLeastSquares));
  registry.Add(RansacEntry("opencv.ransac_epnp",
                           "OpenCV's RANSAC on samples of five, then EPnP on the inliers",
                           "Fischler and Bolles 1981; cv::solvePnPRansac", SolveOpenCvRansacEpnp));
  registry.Add(RansacEntry("opencv.magsac", "OpenCV's USAC with MAGSAC++ scores and refinement",
                           "Barath et al. 2020; cv::solvePnPRansac", SolveOpenCvMagsac));
}

}  // namespace sextant
