// SPDX-License-Identifier: Apache-2.0
#include "cli/capture/local_page.h"

#include <fmt/core.h>

namespace sextant::cli {
namespace {

constexpr std::string_view kText = "text/plain; charset=utf-8";

bool IsOurHost(std::string_view host, std::uint16_t port) {
  constexpr std::uint16_t kDefaultPort = 80;  // Browsers leave it out.
  for (const char* name : {"127.0.0.1", "localhost"}) {
    if (host == fmt::format("{}:{}", name, port)) return true;
    if (port == kDefaultPort && host == name) return true;
  }
  return false;
}

LocalAnswer AnswerWithBody(const LocalRequest& request, std::uint16_t port,
                           const ServedPage& page) {
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

}  // namespace

LocalAnswer AnswerLocally(const LocalRequest& request, std::uint16_t port, const ServedPage& page) {
  LocalAnswer answer = AnswerWithBody(request, port, page);
  if (request.method == "HEAD") answer.body = {};  // HTTP allows it none.
  return answer;
}

}  // namespace sextant::cli
