// SPDX-License-Identifier: Apache-2.0
#include "eval/extractors/extractor_study.h"

#include <gtest/gtest.h>

namespace sextant::test {
namespace {

TEST(ExtractorStudy, TheSameSeedGivesTheSameFigures) {
  const ExtractorStudyOptions options{
      .models = {"vlp16"}, .trials = 4, .placements = 4, .rooms = 2, .seed = 7};
  const auto first = StudyExtractors(options);
  const auto second = StudyExtractors(options);
  ASSERT_TRUE(first) << first.error().message;
  ASSERT_TRUE(second);
  EXPECT_EQ(FormatExtractorStudy(*first, false), FormatExtractorStudy(*second, false));
  ASSERT_EQ(first->size(), 1U);
  EXPECT_EQ(first->front().extractors.front().boards, 8);
}

TEST(ExtractorStudy, ReportsAnUnknownLidar) {
  const auto rows = StudyExtractors({.models = {"vlp61"}});
  ASSERT_FALSE(rows);
  EXPECT_EQ(rows.error().code, ErrorCode::kUnknownName);
}

}  // namespace
}  // namespace sextant::test
