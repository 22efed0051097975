// SPDX-License-Identifier: Apache-2.0
#include "report/collect/page_next.h"

#include <fmt/core.h>

#include "base/units.h"
#include "calibrate/advise/advise.h"
#include "calibrate/trust/information.h"
#include "io/images/image_codec.h"
#include "report/advice_picture.h"

namespace sextant {
namespace {

std::string SigmaWords(const Matrix6d& covariance) {
  const Vector6d variance = covariance.diagonal();
  return fmt::format("{:.2g} mm and {:.2g} deg over all axes, weakest {}",
                     1e3 * std::sqrt(variance.tail<3>().sum()),
                     kDegPerRad * std::sqrt(variance.head<3>().sum()),
                     DescribeWeakest(WeakestOf(covariance)));
}

}  // namespace

PageNext NextOf(const CalibrationResult& result) {
  if (!result.camera || !result.lidar) {
    return {.sentences = {"No proposal: the result does not have both sensors' models."}};
  }
  const SensorPair sensors{
      .camera = *result.camera, .lidar = *result.lidar, .cam_from_lidar = result.cam_from_lidar};
  const Expected<Advice> advice = Advise(result, sensors);
  if (!advice) return {.sentences = {"No proposal: " + advice.error().message + "."}};
  const BoardProposal& proposal = advice->proposal;
  PageNext next{.sentences = {proposal.sentence}};
  if (advice->covariance) {
    next.sentences.push_back(
        fmt::format("Predicted 1 sigma now: {}.", SigmaWords(*advice->covariance)));
  }
  next.sentences.push_back(
      fmt::format("Predicted 1 sigma with that view: {}; {} rings would cross "
                  "the board.",
                  SigmaWords(proposal.covariance), proposal.rings));
  const Expected<std::string> png = EncodeImage(".png", DrawAdvice(result, sensors, {proposal}));
  if (png) next.png = *png;
  return next;
}

}  // namespace sextant
