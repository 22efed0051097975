// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace sextant::cli {

/// What the server of a capture shows.
struct ServedPage {
  std::string html{};
  std::string state{};  ///< JSON, by which the page learns that there is a newer one.
};

/// The parts of an HTTP request that decide about its answer.
struct LocalRequest {
  std::string_view method{};
  std::string_view target{};  ///< "/", "/state"; what follows a `?` is ignored.
  std::string_view host{};    ///< The header Host.
};

struct LocalAnswer {
  unsigned status = 200;
  std::string_view type{};  ///< Content-Type.
  std::string_view body{};  ///< Part of the served page, or a constant.
};

/// The answer to a request at a port of 127.0.0.1. There are two addresses, `/` and `/state`, and
/// none is looked up in the file system. A Host other than 127.0.0.1 or localhost with this port is
/// refused, so that a page of another site cannot read this one by giving its name our address (DNS
/// rebinding).
LocalAnswer AnswerLocally(const LocalRequest& request, std::uint16_t port, const ServedPage& page);

}  // namespace sextant::cli
