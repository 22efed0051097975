// SPDX-License-Identifier: Apache-2.0
#include "base/error.h"

namespace sextant {

std::string_view ToString(ErrorCode code) {
  switch (code) {
    case ErrorCode::kMissingData:
      return "missing_data";
    case ErrorCode::kTooFewPairs:
      return "too_few_pairs";
    case ErrorCode::kNonFinite:
      return "non_finite";
    case ErrorCode::kInvalidInput:
      return "invalid_input";
    case ErrorCode::kDegenerate:
      return "degenerate";
    case ErrorCode::kMirrored:
      return "mirrored";
    case ErrorCode::kNoConsensus:
      return "no_consensus";
    case ErrorCode::kNoConvergence:
      return "no_convergence";
    case ErrorCode::kUnknownName:
      return "unknown_name";
    case ErrorCode::kInvalidOption:
      return "invalid_option";
    case ErrorCode::kParse:
      return "parse";
    case ErrorCode::kIo:
      return "io";
    case ErrorCode::kUnwritable:
      return "unwritable";
  }
  return "unknown";
}

}  // namespace sextant
