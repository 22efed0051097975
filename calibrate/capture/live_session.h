// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "calibrate/calibrate.h"
#include "calibrate/capture/folder_watch.h"
#include "calibrate/observe/observe.h"

namespace sextant {

/// A session whose photos and scans arrive one after the other. Each pair is observed once; the
/// answer is that of Calibrate for the pairs so far, so a session that is started again with the
/// same files has the same answer.
class LiveSession {
 public:
  /// Reads the boards and the camera. Errors: those of the readers and of Observer::Make.
  static Expected<LiveSession> Make(const std::filesystem::path& boards,
                                    const std::filesystem::path& camera,
                                    const CalibrateOptions& options, double tolerance_s);

  /// Takes the complete files of the folder: observes the pairs that are new or whose files have
  /// changed, on all cores, and forgets those that are gone. Whether any pair is new or gone.
  bool Take(const FolderFiles& files);

  /// The answer of all pairs so far; requires one. Time: that of CalibrateObserved.
  Calibration Solve() const;

  std::size_t size() const { return views_.size(); }
  const std::vector<Board>& boards() const { return observer_.boards(); }
  /// The views that the last Take observed, as indices into Calibration::observed.views.
  const std::vector<std::size_t>& newest() const { return newest_; }
  /// All views, the newest first; those of one Take in the order of their names.
  std::vector<std::size_t> ByArrival() const;
  /// Complete files whose partner is not there yet.
  const std::vector<std::filesystem::path>& without_partner() const {
    return session_.files.without_partner;
  }

 private:
  struct View {
    WatchedFile image{};
    WatchedFile cloud{};
    std::size_t arrival = 0;  ///< Counts the calls of Take.
    SessionView seen{};
  };

  LiveSession(Observer observer, CalibrateOptions options, double tolerance_s)
      : observer_(std::move(observer)), options_(std::move(options)), tolerance_s_(tolerance_s) {}

  Observer observer_;
  CalibrateOptions options_;
  double tolerance_s_;
  Session session_{};
  std::vector<View> views_{};  ///< In the order of session_.files.pairs.
  std::vector<std::size_t> newest_{};
  std::size_t takes_ = 0;
};

/// "7: board 0 in the photo; 1 possible board in the scan", with what is missing and why: one view
/// in one line, which is its error where its files could not be read.
std::string DescribeSighting(const SessionView& view, const std::vector<Board>& boards);

}  // namespace sextant
