// SPDX-License-Identifier: Apache-2.0
#include "cli/capture/local_page.h"

#include <fmt/core.h>

namespace sextant::cli {
namespace {

constexpr std::string_view kText = "text/plain; charset=utf-8";

bool IsOurHost(std::string_view host, std::uint16_t port) {
  return host == fmt::format("127.0.0.1:{}", port) || host == fmt::format("localhost:{}", port);
}

}  // namespace

LocalAnswer AnswerLocally(const LocalRequest& request, std::uint16_t port, const ServedPage& page) {
  if (!IsOurHost(request.host, port)) {
    return {.status = 403, .type = kText, .body = "This server answers on 127.0.0.1 only.\n"};
  }
  if (request.method != "GET") {
    return {.status = 405, .type = kText, .body = "This page can only be read: use GET.\n"};
  }
  const std::string_view path = request.target.substr(0, request.target.find('?'));
  if (path == "/") return {.type = "text/html; charset=utf-8", .body = page.html};
  if (path == "/state") return {.type = "application/json", .body = page.state};
  return {.status = 404, .type = kText, .body = "There is only one page: /\n"};
}

}  // namespace sextant::cli
