// SPDX-License-Identifier: Apache-2.0
#include "cli/rig_output.h"

#include "cli/output.h"
#include "io/output/output_file.h"
#include "report/rig_text.h"

namespace sextant::cli {

int DeliverRig(const char* command, const Expected<RigResult>& result, const std::string& out_path,
               const std::string& json_path) {
  if (!result) {
    const ErrorCode code = result.error().code;
    const bool no_answer = code == ErrorCode::kDegenerate || code == ErrorCode::kNoConvergence ||
                           code == ErrorCode::kMissingData;
    return Refuse(command, result.error(), no_answer ? kNoAnswer : kWrongUse);
  }
  const std::string json = FormatRigResult(*result);
  if (const Expected<void> ok = WriteFileAtomically(out_path, json); !ok) {
    return Refuse(command, ok.error());
  }
  const std::string text =
      DescribeRig(*result) + "\n" + WroteLine(out_path, "the result, for sextant export");
  const bool whole = result->refutations.empty() && result->unconnected.empty();
  return Deliver(command, json_path, text, json, whole ? kAnswered : kNotUsable);
}

}  // namespace sextant::cli
