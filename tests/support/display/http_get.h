// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace sextant::test {

/// What a server answered.
struct HttpAnswer {
  int status = 0;      ///< 0: no connection, or no answer of HTTP.
  std::string head{};  ///< Status line and headers.
  std::string body{};
};

/// Sends the bytes to a port of 127.0.0.1 and reads until the server closes the connection.
HttpAnswer SendToPort(std::uint16_t port, const std::string& request);

/// GET of a path, as a browser on this machine sends it.
HttpAnswer HttpGet(std::uint16_t port, const std::string& path);

}  // namespace sextant::test
