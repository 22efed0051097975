// SPDX-License-Identifier: Apache-2.0
#include "cli/capture/page_server.h"

#include <fmt/core.h>

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http.hpp>
#include <exception>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

namespace sextant::cli {

// The page that is shown, and when its state was last read. In no unnamed namespace, as
// the server has one as a member.
class PageShelf {
 public:
  void Put(ServedPage page) {
    const auto next = std::make_shared<const ServedPage>(std::move(page));
    const std::scoped_lock lock(mutex_);
    page_ = next;
  }

  std::shared_ptr<const ServedPage> Get() const {
    const std::scoped_lock lock(mutex_);
    return page_;
  }

  void NoteStateRead() {
    const std::scoped_lock lock(mutex_);
    last_read_ = std::chrono::steady_clock::now();
  }

  bool WasStateReadWithin(std::chrono::seconds time) const {
    const std::scoped_lock lock(mutex_);
    return last_read_ && std::chrono::steady_clock::now() - *last_read_ <= time;
  }

 private:
  mutable std::mutex mutex_;
  std::shared_ptr<const ServedPage> page_ = std::make_shared<const ServedPage>();
  std::optional<std::chrono::steady_clock::time_point> last_read_;
};

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using asio::ip::tcp;

constexpr std::size_t kMaxRequestBytes = 8192;

std::string_view ViewOf(beast::string_view text) { return {text.data(), text.size()}; }

// One browser's connection; it lives as long as an operation of it is outstanding.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(tcp::socket socket, std::uint16_t port, PageShelf& shelf, std::atomic<int>& count)
      : stream_(std::move(socket)), port_(port), shelf_(shelf), count_(count) {
    ++count_;
  }
  ~Connection() { --count_; }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void Read() {
    parser_.emplace();
    parser_->header_limit(kMaxRequestBytes);
    stream_.expires_after(std::chrono::seconds(30));
    http::async_read(stream_, buffer_, *parser_,
                     [self = shared_from_this()](beast::error_code error, std::size_t) {
                       if (!error) self->Answer();
                     });
  }

 private:
  void Answer() {
    const auto& request = parser_->get();
    const std::shared_ptr<const ServedPage> page = shelf_.Get();
    const LocalAnswer answer = AnswerLocally({.method = ViewOf(request.method_string()),
                                              .target = ViewOf(request.target()),
                                              .host = ViewOf(request[http::field::host])},
                                             port_, *page);
    const bool is_state = !answer.body.empty() && answer.body.data() == page->state.data();
    auto response = std::make_shared<http::response<http::string_body>>(
        static_cast<http::status>(answer.status), request.version());
    response->set(http::field::content_type,
                  beast::string_view(answer.type.data(), answer.type.size()));
    response->set(http::field::cache_control, "no-store");
    response->set(http::field::x_frame_options, "DENY");
    response->set("X-Content-Type-Options", "nosniff");
    response->set("Referrer-Policy", "no-referrer");
    response->set("Cross-Origin-Resource-Policy", "same-origin");
    response->keep_alive(request.keep_alive());
    response->body() = std::string(answer.body);
    response->prepare_payload();
    http::async_write(
        stream_, *response,
        [self = shared_from_this(), response, is_state](beast::error_code error, std::size_t) {
          if (error) return;
          if (is_state) self->shelf_.NoteStateRead();
          if (response->need_eof()) return self->Close();
          self->Read();
        });
  }

  void Close() {
    beast::error_code ignored;
    stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
  }

  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{kMaxRequestBytes};
  std::optional<http::request_parser<http::empty_body>> parser_;
  std::uint16_t port_;
  PageShelf& shelf_;
  std::atomic<int>& count_;
};

}  // namespace

class PageServer::Impl {
 public:
  ~Impl() {
    context_.stop();
    if (thread_.joinable()) thread_.join();
  }

  // Empty, or why the port cannot be used.
  std::string Listen(std::uint16_t port) {
    const tcp::endpoint here(asio::ip::address_v4::loopback(), port);
    beast::error_code error;
    acceptor_.open(here.protocol(), error);
    if (!error) acceptor_.set_option(asio::socket_base::reuse_address(true), error);
    if (!error) acceptor_.bind(here, error);
    if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
    if (!error) port_ = acceptor_.local_endpoint(error).port();
    if (error) return error.message();
    Accept();
    thread_ = std::thread([this] { Run(); });
    return {};
  }

  std::uint16_t port() const { return port_; }
  PageShelf& shelf() { return shelf_; }

 private:
  void Accept() {
    acceptor_.async_accept([this](beast::error_code error, tcp::socket socket) {
      // Before the connection, for which there may be no memory.
      if (acceptor_.is_open()) Accept();
      if (!error && connections_ < kMaxConnections) {
        std::make_shared<Connection>(std::move(socket), port_, shelf_, connections_)->Read();
      }
    });
  }

  // A connection for which there is no memory ends; the others go on.
  void Run() {
    for (;;) {
      try {
        context_.run();
        return;
      } catch (const std::exception&) {
        continue;
      }
    }
  }

  PageShelf shelf_;
  std::atomic<int> connections_ = 0;
  asio::io_context context_{1};
  tcp::acceptor acceptor_{context_};
  std::uint16_t port_ = 0;
  std::thread thread_;
};

PageServer::PageServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PageServer::~PageServer() = default;

Expected<std::unique_ptr<PageServer>> PageServer::Start(std::uint16_t port) {
  auto impl = std::make_unique<Impl>();
  const std::string why = impl->Listen(port);
  if (why.empty()) return std::unique_ptr<PageServer>(new PageServer(std::move(impl)));
  return MakeError(ErrorCode::kInvalidOption,
                   fmt::format("--port: port {} of 127.0.0.1 cannot be used ({}); choose another "
                               "one, or 0 for any that is free",
                               port, why));
}

std::uint16_t PageServer::port() const { return impl_->port(); }
void PageServer::Show(ServedPage page) { impl_->shelf().Put(std::move(page)); }
bool PageServer::WasAskedWithin(std::chrono::seconds time) const {
  return impl_->shelf().WasStateReadWithin(time);
}

}  // namespace sextant::cli
