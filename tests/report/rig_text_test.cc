// SPDX-License-Identifier: Apache-2.0
#include "report/rig_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sextant {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

RigResult TwoOfThreeSensors() {
  RigResult rig{.version = "1", .root = "top"};
  rig.sensors = {{.name = "top", .root_from_sensor = Rigid3d{}},
                 {.name = "left", .root_from_sensor = Rigid3d{}},
                 {.name = "rear"}};
  rig.pairs = {{.a = "top", .b = "left", .alone_sigmas = 0.5}};
  return rig;
}

TEST(RigText, ASensorWithoutAPoseDoesNotMakeTheOthersUnusable) {
  RigResult rig = TwoOfThreeSensors();
  rig.unconnected = {"'rear' shares no board with another sensor"};
  EXPECT_THAT(UnconnectedFindings(rig),
              ElementsAre("'rear' shares no board with another sensor. The poses of the connected "
                          "sensors are usable"));
  EXPECT_THAT(DescribeRig(rig), HasSubstr("warning: 'rear' shares no board"));
  EXPECT_THAT(DescribeRig(rig), Not(HasSubstr("NOT USABLE")));
  rig.refutations = {"the print is small"};
  EXPECT_THAT(UnconnectedFindings(rig), ElementsAre(rig.unconnected[0]));
  EXPECT_THAT(DescribeRig(rig), HasSubstr("NOT USABLE: the print is small"));
}

TEST(RigText, PairsThatDisagreeWithAllSensorsAreNamed) {
  RigResult rig = TwoOfThreeSensors();
  EXPECT_THAT(LoopFindings(rig), IsEmpty());
  rig.pairs[0].alone_sigmas = 3.5;
  EXPECT_THAT(LoopFindings(rig), ElementsAre(HasSubstr("by 3.5 sigmas")));
  EXPECT_THAT(DescribeRig(rig), HasSubstr("another board size"));
}

}  // namespace
}  // namespace sextant
