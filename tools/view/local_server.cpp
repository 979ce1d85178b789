#include "tools/view/local_server.h"

#include <sys/random.h>

#include <array>
#include <chrono>
#include <exception>
#include <list>
#include <memory>
#include <utility>

#include <fmt/core.h>

#include <boost/asio.hpp>
#include "tools/view/connection.h"

namespace spool::tools {
namespace {

namespace net = boost::asio;
using boost::system::error_code;
using net::ip::tcp;

constexpr const char* kHost = "127.0.0.1";
constexpr std::chrono::milliseconds kPause{50};  // where no connection can be accepted
constexpr std::size_t kMostConnections = 256;
constexpr std::size_t kThreads = 32;  // more than a few browsers ask of at once

// 128 random bits in hexadecimal.
Result<std::string> random_token() {
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    return fail(ErrorCode::kIo, "no random numbers for the address of the page");
  }
  std::string token;
  for (const unsigned char byte : bytes)
    token += fmt::format("{:02x}", byte);
  return token;
}

class LocalServer {
 public:
  explicit LocalServer(const Answers& answers) : service_{answers, "", 0} {}

  // On that port, or on any when it is taken.
  Result<void> open(int port) {
    SPOOL_ASSIGN(service_.token, random_token());
    if (!listen_at(port) && !listen_at(0)) {
      return fail(ErrorCode::kIo, "no port of {} is free: end another server", kHost);
    }
    service_.port = acceptor_.local_endpoint().port();
    return {};
  }
  std::string url() const {
    return fmt::format("http://{}:{}/{}/", kHost, service_.port, service_.token);
  }
  void run() {
    accept();
    for (;;) {
      try {
        io_.run();
        return;
      } catch (const std::exception&) {  // out of memory: a connection is lost, no more
      }
    }
  }

 private:
  // No other process may share the port: reuse_address is for connections that have ended.
  bool listen_at(int port) {
    error_code error;
    acceptor_ = tcp::acceptor(io_);
    const tcp::endpoint place(net::ip::make_address_v4(kHost), static_cast<unsigned short>(port));
    acceptor_.open(place.protocol(), error);
    if (!error) acceptor_.set_option(net::socket_base::reuse_address(true), error);
    if (!error) acceptor_.bind(place, error);
    if (!error) acceptor_.listen(net::socket_base::max_listen_connections, error);
    return !error;
  }

  void accept() {
    acceptor_.async_accept([this](error_code error, tcp::socket socket) {
      if (!error) admit(std::move(socket));
      if (!error || make_room()) return accept();  // of file handles
      pause_.expires_after(kPause);
      pause_.async_wait([this](error_code) { accept(); });
    });
  }

  void admit(tcp::socket socket) {
    connections_.remove_if([](const auto& connection) {
      const auto held = connection.lock();
      return !held || held->closed();
    });
    if (connections_.size() >= kMostConnections && !make_room()) return;
    const auto connection = std::make_shared<Connection>(std::move(socket), service_, workers_);
    connections_.push_back(connection);
    connection->start();
  }

  // The oldest connection that is owed no answer goes, by its lack of a token or by having it: a
  // browser's request arrives at once, that of a slow client does not.
  bool make_room() {
    for (const auto& connection : connections_) {
      const auto held = connection.lock();
      if (!held || held->closed() || held->admitted()) continue;
      held->close();
      return true;
    }
    return false;
  }

  net::io_context io_;
  tcp::acceptor acceptor_{io_};
  net::steady_timer pause_{io_};
  net::thread_pool workers_{kThreads};
  Service service_;
  std::list<std::weak_ptr<Connection>> connections_;
};

}  // namespace

Result<void> serve_locally(const Answers& answers, int port,
                           const std::function<Result<void>(const std::string& url)>& ready) {
  LocalServer server(answers);
  SPOOL_TRY(server.open(port));
  SPOOL_TRY(ready(server.url()));
  server.run();
  return {};
}

}  // namespace spool::tools
