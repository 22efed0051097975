// SPDX-License-Identifier: Apache-2.0
#include "cli/capture/capture_display.h"

#include <fmt/core.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "base/text/escape.h"
#include "report/page/page_html.h"

namespace sextant::cli {

CaptureDisplay::CaptureDisplay(std::unique_ptr<PageServer> server)
    : server_(std::move(server)),
      start_(fmt::format("{}", std::chrono::system_clock::now().time_since_epoch().count())) {}

std::string CaptureDisplay::address() const {
  return fmt::format("http://127.0.0.1:{}/", server_->port());
}

void CaptureDisplay::Publish() {
  const nlohmann::ordered_json state = {{"revision", page_.live->revision}, {"state", state_}};
  server_->Show({.html = html_, .state = JsonText(state)});
}

void CaptureDisplay::Show(ReportPage page) {
  page_ = std::move(page);
  if (!page_.live) page_.live.emplace();
  page_.live->revision = fmt::format("{}-{}", start_, ++count_);
  page_.live->state = state_;
  html_ = FormatPage(page_);
  Publish();
}

void CaptureDisplay::SetState(std::string state) {
  if (state == state_ || !page_.live) return;
  state_ = std::move(state);
  Publish();
}

void CaptureDisplay::End(ReportPage page, std::string state) {
  constexpr std::chrono::seconds kOpen(5);
  constexpr std::chrono::milliseconds kToLoad(2500);
  state_ = std::move(state);
  if (!page.live) page.live.emplace();
  page.live->has_ended = true;
  Show(std::move(page));
  if (server_->WasAskedWithin(kOpen)) std::this_thread::sleep_for(kToLoad);
}

}  // namespace sextant::cli
