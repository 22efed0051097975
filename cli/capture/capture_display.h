// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "cli/capture/page_server.h"
#include "report/page/page.h"

namespace sextant::cli {

/// The page of a capture as it changes.
class CaptureDisplay {
 public:
  explicit CaptureDisplay(std::unique_ptr<PageServer> server);

  /// "http://127.0.0.1:PORT/"
  std::string address() const;

  /// A new page; open ones load it. Its `live` lacks the revision and the state.
  void Show(ReportPage page);
  /// What is being done; open pages show it within a second.
  void SetState(std::string state);
  /// The last page, with what became of the capture. Returns when those that were open have had
  /// the time to load it.
  void End(ReportPage page, std::string state);

 private:
  void Publish();

  std::unique_ptr<PageServer> server_;
  ReportPage page_{};
  std::string html_{};
  std::string state_ = "Waiting for the first photo and scan.";
  std::string start_{};  ///< Distinguishes this run's revisions from those before it.
  std::uint64_t count_ = 0;
};

}  // namespace sextant::cli
