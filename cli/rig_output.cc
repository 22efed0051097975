// SPDX-License-Identifier: Apache-2.0
#include "cli/rig_output.h"

#include "cli/output.h"
#include "cli/report_file.h"
#include "io/output/output_file.h"
#include "report/collect/rig_page.h"
#include "report/rig_text.h"

namespace sextant::cli {

int ExitCodeOfRig(const Error& error) {
  const bool has_no_answer = error.code == ErrorCode::kDegenerate ||
                             error.code == ErrorCode::kNoConvergence ||
                             error.code == ErrorCode::kMissingData;
  return has_no_answer ? kNoAnswer : kWrongUse;
}

int DeliverRig(const char* command, const Expected<RigResult>& result, const RigOutputs& outputs) {
  if (!result) return Refuse(command, result.error(), ExitCodeOfRig(result.error()));
  const std::string json = FormatRigResult(*result);
  std::string text = DescribeRig(*result) + "\n";
  Expected<void> written = WriteFileAtomically(outputs.result_path, json);
  if (!outputs.report_path.empty()) {
    const Expected<void> page = WritePage(CollectRigPage(*result), outputs.report_path);
    if (written) written = page;
  }
  if (written) {
    text += WroteLine(outputs.result_path, "the result, for sextant export and report");
    if (!outputs.report_path.empty()) text += WroteLine(outputs.report_path, kReportWords);
  }
  const bool whole = result->refutations.empty() && result->unconnected.empty();
  const int code = Deliver(command, outputs.json_path, text, json, whole ? kAnswered : kNotUsable);
  return written ? code : Refuse(command, written.error());
}

}  // namespace sextant::cli
