// SPDX-License-Identifier: Apache-2.0
#include "cli/capture/page_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "support/display/http_get.h"

namespace sextant::cli {
namespace {

using test::HttpAnswer;
using test::HttpGet;
using test::SendToPort;
using testing::HasSubstr;
using testing::Not;

constexpr std::uint16_t kPort = 8735;
const ServedPage kServed{.html = "<p>page</p>", .state = "{\"revision\": \"1\"}"};

unsigned StatusFor(std::string_view method, std::string_view target, std::string_view host) {
  return AnswerLocally({.method = method, .target = target, .host = host}, kPort, kServed).status;
}

TEST(AnswerLocally, OnlyForBrowsersThatNameThisMachine) {
  EXPECT_EQ(StatusFor("GET", "/", "127.0.0.1:8735"), 200U);
  EXPECT_EQ(StatusFor("GET", "/", "localhost:8735"), 200U);
  EXPECT_EQ(AnswerLocally({"GET", "/", "127.0.0.1"}, 80, kServed).status, 200U) << "no port: 80";
  EXPECT_EQ(AnswerLocally({"GET", "/", "evil.example"}, 80, kServed).status, 403U);
  // A name of another site that leads here, and other ports.
  for (const char* host : {"evil.example:8735", "evil.example", "127.0.0.1", "127.0.0.1:80", "",
                           "127.0.0.1:8735.evil.example", "127.0.0.1:87350", "[::1]:8735"}) {
    EXPECT_EQ(StatusFor("GET", "/", host), 403U) << host;
  }
}

TEST(AnswerLocally, HasTwoAddressesAndNoFile) {
  const std::string host = "127.0.0.1:8735";
  EXPECT_EQ(AnswerLocally({"GET", "/", host}, kPort, kServed).body, "<p>page</p>");
  EXPECT_EQ(AnswerLocally({"GET", "/?again", host}, kPort, kServed).body, "<p>page</p>");
  EXPECT_EQ(AnswerLocally({"GET", "/state", host}, kPort, kServed).body, "{\"revision\": \"1\"}");
  for (const char* target : {"/etc/passwd", "/../etc/passwd", "//etc/passwd", "/%2e%2e/etc/passwd",
                             "/state/", "", "*", "http://127.0.0.1:8735/", "/result.yaml"}) {
    EXPECT_EQ(StatusFor("GET", target, host), 404U) << target;
  }
  for (const char* method : {"POST", "PUT", "DELETE", "HEAD", "OPTIONS", "get"}) {
    EXPECT_EQ(StatusFor(method, "/", host), 405U) << method;
  }
  EXPECT_EQ(AnswerLocally({"HEAD", "/", host}, kPort, kServed).body, "");
  EXPECT_NE(AnswerLocally({"POST", "/", host}, kPort, kServed).body, "");
}

class PageServerTest : public testing::Test {
 protected:
  void SetUp() override {
    Expected<std::unique_ptr<PageServer>> server = PageServer::Start(0);
    ASSERT_TRUE(server) << server.error().message;
    server_ = *std::move(server);
  }
  std::unique_ptr<PageServer> server_;
};

TEST_F(PageServerTest, ShowsTheLastPage) {
  server_->Show({.html = "first", .state = "1"});
  EXPECT_EQ(HttpGet(server_->port(), "/").body, "first");
  EXPECT_FALSE(server_->WasAskedWithin(std::chrono::seconds(60)));
  server_->Show({.html = std::string(3'000'000, 'x'), .state = "2"});
  const HttpAnswer answer = HttpGet(server_->port(), "/");
  EXPECT_EQ(answer.status, 200);
  EXPECT_EQ(answer.body, std::string(3'000'000, 'x'));
  EXPECT_THAT(answer.head, HasSubstr("Content-Type: text/html"));
  EXPECT_THAT(answer.head, HasSubstr("nosniff"));
  EXPECT_EQ(HttpGet(server_->port(), "/state").body, "2");
  EXPECT_TRUE(server_->WasAskedWithin(std::chrono::seconds(60)));
}

TEST_F(PageServerTest, OthersAreRefused) {
  server_->Show({.html = "secret", .state = "1"});
  const std::uint16_t port = server_->port();
  const HttpAnswer rebound =
      SendToPort(port, "GET / HTTP/1.1\r\nHost: evil.example:" + std::to_string(port) +
                           "\r\nConnection: close\r\n\r\n");
  EXPECT_EQ(rebound.status, 403);
  EXPECT_THAT(rebound.body, Not(HasSubstr("secret")));
  EXPECT_EQ(SendToPort(port, "GET / HTTP/1.0\r\n\r\n").status, 403);
  EXPECT_EQ(HttpGet(port, "/../../etc/passwd").status, 404);
}

TEST_F(PageServerTest, WhatIsNoRequestEndsTheConnectionAndNothingElse) {
  server_->Show({.html = "page", .state = "1"});
  const std::uint16_t port = server_->port();
  const std::string host = "Host: 127.0.0.1:" + std::to_string(port) + "\r\n";
  for (const std::string& request :
       {std::string("\0\xff\n\n\r\n\r\n", 8), std::string("GET /\r\n\r\n"),
        "GET / HTTP/1.1\r\n" + host + "Cookie: " + std::string(20'000, 'x') + "\r\n\r\n",
        "POST / HTTP/1.1\r\n" + host + "Content-Length: 5\r\n\r\nhello",
        "GET /" + std::string(100'000, 'a') + " HTTP/1.1\r\n" + host + "\r\n"}) {
    EXPECT_EQ(SendToPort(port, request).status, 0) << request.substr(0, 60);
  }
  EXPECT_EQ(HttpGet(port, "/").body, "page");
}

TEST_F(PageServerTest, APortThatIsTakenIsRefused) {
  const Expected<std::unique_ptr<PageServer>> second = PageServer::Start(server_->port());
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::kInvalidOption);
  EXPECT_THAT(second.error().message, HasSubstr("--port"));
}

}  // namespace
}  // namespace sextant::cli
