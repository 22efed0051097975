// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "base/units.h"
#include "eval/diagnostics/order_diagnostics.h"
#include "geometry/so3.h"

namespace sextant {
namespace {

std::string Rmse(double rmse, bool in_pixels) {
  return in_pixels ? fmt::format("RMSE {:.3f} px", rmse) : fmt::format("RMSE {:.4f} m", rmse);
}

std::string RmseAsGiven(const OrderDiagnosis& order) {
  if (!order.rmse_as_given) return "no pose fits as given";
  return Rmse(*order.rmse_as_given, order.in_pixels) + " as given";
}

std::string Facing(const OrderDiagnosis& order) {
  if (!order.faces_as_given) return "";
  return ", with the sensors facing each other through the boards, as if one sensor lists corners "
         "clockwise and the other counter-clockwise";
}

// The order itself where it is short enough to be read: that of the LiDAR's points, and that of the
// camera's for those who correct the other list, where the two differ.
std::string IndicesOf(const OrderFinding& order) {
  constexpr std::size_t kMaxShown = 24;
  const std::vector<int>& lidar = order.lidar_index;
  if (lidar.size() > kMaxShown) return "";
  std::vector<int> cam(lidar.size());
  for (std::size_t i = 0; i < lidar.size(); ++i) {
    cam[static_cast<std::size_t>(lidar[i])] = static_cast<int>(i);
  }
  const std::string of_cam =
      cam == lidar ? "" : fmt::format(", or camera order [{}]", fmt::join(cam, ","));
  return fmt::format(", LiDAR order [{}]{} (counted from 0)", fmt::join(lidar, ","), of_cam);
}

std::string PoseText(const Rigid3d& pose) {
  const Eigen::Vector3d& t = pose.translation;
  const EulerZyx euler = ToEulerZyx(pose.rotation);
  return fmt::format("t {:.3f} {:.3f} {:.3f} m, yaw pitch roll {:.1f} {:.1f} {:.1f} deg", t.x(),
                     t.y(), t.z(), euler.yaw * kDegPerRad, euler.pitch * kDegPerRad,
                     euler.roll * kDegPerRad);
}

std::string DescribeUnlikely(const OrderDiagnosis& order) {
  const OrderFinding& better = *order.better;
  return fmt::format(
      "order: the pairs are of a board at one place, and its corners turned by {} deg fit about as "
      "well ({}, {}, {}{}). The pairs do not tell which corner is first, but {}; --reorder uses it",
      better.turned_deg, RmseAsGiven(order), Rmse(better.rmse, better.in_pixels),
      PoseText(better.cam_from_lidar), IndicesOf(better), order.unlikely_as_given);
}

std::string DescribeTurned(const OrderDiagnosis& order) {
  std::string angles;
  std::string poses;
  for (std::size_t i = 0; i < order.turned.size(); ++i) {
    const OrderFinding& turned = order.turned[i];
    angles += fmt::format("{}{}", i == 0 ? "" : " or ", turned.turned_deg);
    poses += fmt::format("{}{} with {}", i == 0 ? "" : "; ", Rmse(turned.rmse, turned.in_pixels),
                         PoseText(turned.cam_from_lidar));
  }
  return fmt::format(
      "order: the pairs are of a board at one place, and its corners turned by {} deg fit about as "
      "well ({}; {}): nothing in the pairs tells which corner is first. Compare the answer with "
      "how the sensors are mounted, or add the board at another place",
      angles, RmseAsGiven(order), poses);
}

// The pairs as a list where they are exchanged two by two.
std::string DescribeExchanged(const OrderDiagnosis& order,
                              std::span<const RepeatedPairs> repeated) {
  const OrderFinding& better = *order.better;
  std::string pairs;
  for (const auto& [first, second] : ExchangedPairs(better)) {
    pairs += fmt::format("{}{} and {}", pairs.empty() ? "" : ", ",
                         PlaceInFile(first, better.in_pixels, repeated),
                         PlaceInFile(second, better.in_pixels, repeated));
  }
  return fmt::format(
      "order: the LiDAR points of pairs {} are exchanged: {}, {} when they are exchanged back; "
      "--reorder does so",
      pairs, RmseAsGiven(order), Rmse(better.rmse, better.in_pixels));
}

std::string DescribeBetter(const OrderDiagnosis& order) {
  const OrderFinding& better = *order.better;
  return fmt::format(
      "order: another order of the LiDAR's points{} fits {}: {}{}, {} with {} of {} pairs "
      "changed{}; --reorder uses it",
      better.boards_swapped ? " and boards" : "", order.faces_as_given ? "them" : "far better",
      RmseAsGiven(order), Facing(order), Rmse(better.rmse, better.in_pixels), better.moved.size(),
      better.lidar_index.size(), IndicesOf(better));
}

std::string DescribeRivals(const OrderDiagnosis& order) {
  constexpr std::size_t kMaxListed = 4;
  std::string text = fmt::format(
      "order: {}{}; {} other orders of the LiDAR's points fit about equally well, so that none is "
      "taken:",
      RmseAsGiven(order), Facing(order), order.rivals.size());
  for (std::size_t i = 0; i < order.rivals.size() && i < kMaxListed; ++i) {
    const OrderFinding& rival = order.rivals[i];
    text += fmt::format("{} {}{}", i == 0 ? "" : ";", Rmse(rival.rmse, rival.in_pixels),
                        IndicesOf(rival));
  }
  return text + "; list the points of both sensors in the same order, or add points or a view";
}

}  // namespace

std::vector<std::string> Describe(const OrderDiagnosis& order,
                                  std::span<const RepeatedPairs> repeated) {
  const bool is_exchange =
      order.better && !order.faces_as_given && !ExchangedPairs(*order.better).empty();
  if (order.better && !order.unlikely_as_given.empty()) return {DescribeUnlikely(order)};
  if (is_exchange) return {DescribeExchanged(order, repeated)};
  if (order.better) return {DescribeBetter(order)};
  if (!order.rivals.empty()) return {DescribeRivals(order)};
  if (!order.turned.empty()) return {DescribeTurned(order)};
  if (!order.faces_as_given) return {};
  return {fmt::format("order: {}{}; no other order fits", RmseAsGiven(order), Facing(order))};
}

std::string DescribeReordering(const OrderDiagnosis& order) {
  if (order.better) return "the order above was taken, because of --reorder";
  if (!order.rivals.empty()) {
    return "--reorder keeps the given order, because the data does not determine another one";
  }
  if (!order.turned.empty()) {
    return "--reorder keeps the given order, because nothing tells which corner is first";
  }
  if (!order.not_searched.empty()) {
    return "--reorder keeps the given order: " + order.not_searched;
  }
  return fmt::format("--reorder keeps the given order ({}): no other order fits twice as well",
                     RmseAsGiven(order));
}

}  // namespace sextant
