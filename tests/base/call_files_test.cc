// SPDX-License-Identifier: Apache-2.0
#include "base/call_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sextant {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

const FileId kFile{.device = 1, .inode = 7};
const FileId kOther{.device = 2, .inode = 7};
const FileId kNew{.device = 1, .inode = 3, .name = "new"};

TEST(CallFiles, AnOutputIsNoInput) {
  CallFiles files(false);
  EXPECT_THAT(files.AddInput(kFile), IsEmpty());
  EXPECT_THAT(files.AddInput(kFile), IsEmpty());
  EXPECT_THAT(files.ClaimOutput(kFile, {}), HasSubstr("is an input"));
  EXPECT_THAT(files.BeginOutput(kFile, {}), HasSubstr("is an input"));
  EXPECT_THAT(files.BeginOutput(kOther, {}), IsEmpty());
}

TEST(CallFiles, AnInputIsNoClaimedOutput) {
  CallFiles files(false);
  EXPECT_THAT(files.ClaimOutput(kFile, {}), IsEmpty());
  EXPECT_THAT(files.AddInput(kFile), HasSubstr("also an output"));
  EXPECT_THAT(files.BeginOutput(kFile, {}), HasSubstr("is an input")) << "it went on without it";
}

TEST(CallFiles, AClaimMayRecogniseTheFile) {
  CallFiles files(false);
  EXPECT_FALSE(files.IsRecognised(kFile));
  EXPECT_THAT(files.ClaimOutput(kFile, {.is_recognised = true}), IsEmpty());
  EXPECT_THAT(files.ClaimOutput(kOther, {}), IsEmpty());
  EXPECT_TRUE(files.IsRecognised(kFile));
  EXPECT_FALSE(files.IsRecognised(kOther));
}

TEST(CallFiles, EachOutputIsWrittenOnce) {
  CallFiles files(false);
  EXPECT_THAT(files.ClaimOutput(kNew, {}), IsEmpty());
  EXPECT_THAT(files.ClaimOutput(kNew, {}), HasSubstr("already an output"));
  EXPECT_THAT(files.BeginOutput(kNew, {}), IsEmpty());
  files.FinishOutput(kNew, kFile);
  EXPECT_THAT(files.BeginOutput(kFile, {}), HasSubstr("already an output"));
}

TEST(CallFiles, WhatWasWrittenMayBeReadAgain) {
  CallFiles files(false);
  EXPECT_THAT(files.BeginOutput(kFile, {}), IsEmpty());
  EXPECT_THAT(files.AddInput(kFile), HasSubstr("also an output"));
  files.FinishOutput(kFile, kOther);
  EXPECT_THAT(files.AddInput(kOther), IsEmpty());
  // The inode of the replaced file is free again.
  EXPECT_THAT(files.BeginOutput(kFile, {}), IsEmpty());
}

TEST(CallFiles, AContinuedFileIsReadAndWrittenRepeatedly) {
  CallFiles files(false);
  const OutputUse use{.may_be_read = true, .is_repeated = true};
  EXPECT_THAT(files.ClaimOutput(kFile, use), IsEmpty());
  EXPECT_THAT(files.AddInput(kFile), IsEmpty());
  EXPECT_THAT(files.BeginOutput(kFile, {}), IsEmpty());
  files.FinishOutput(kFile, kOther);
  EXPECT_THAT(files.BeginOutput(kOther, {}), IsEmpty());
}

TEST(CallFiles, AWriterThatKnowsItsFileReplacesIt) {
  CallFiles files(false);
  EXPECT_THAT(files.BeginOutput(kFile, {.may_be_read = true}), IsEmpty());
  files.FinishOutput(kFile, kFile);
  EXPECT_THAT(files.BeginOutput(kFile, {}), HasSubstr("already an output"));
  EXPECT_THAT(files.BeginOutput(kFile, {.may_be_read = true, .is_repeated = true}), IsEmpty());
}

TEST(CallFiles, WithoutAnObjectNothingIsRefused) {
  EXPECT_EQ(CallFiles::Current(), nullptr);
  EXPECT_THAT(NoteInput({}), IsEmpty());
}

}  // namespace
}  // namespace sextant
