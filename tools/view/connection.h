// One connection of the local server: one request, its answer, the end. Boost.Beast costs seconds
// per translation unit: this file and local_server.cpp alone include it.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include <boost/asio.hpp>
#include <boost/beast.hpp>

#include "tools/view/answers.h"

namespace spool::tools {

// What is served, and to which address.
struct Service {
  const Answers& answers;
  std::string token;
  int port = 0;

  bool is_this_server(std::string_view host) const;
};

// What the address of a request says: "/TOKEN/name?parameter=value&...".
struct RequestTarget {
  std::string token;
  std::string name;        // as sent: no name that is served needs an escape
  std::string parameters;  // what follows the question mark, as sent
};

// All but the making of the answer runs on the thread of the socket's executor.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(boost::asio::ip::tcp::socket socket, const Service& service,
             boost::asio::thread_pool& workers);

  void start();
  bool admitted() const { return admitted_; }
  bool closed() const { return !stream_.socket().is_open(); }
  void close() { stream_.close(); }

 private:
  void asked(boost::system::error_code error);
  Answer refused();  // status 0: it is not
  void send(Answer answer);
  void send_piece();
  void finish();

  boost::beast::tcp_stream stream_;
  const Service& service_;
  boost::asio::thread_pool& workers_;
  boost::beast::flat_buffer buffer_;
  boost::beast::http::request_parser<boost::beast::http::empty_body> parser_;
  RequestTarget target_;
  boost::beast::http::response<boost::beast::http::string_body> response_;
  boost::beast::http::response_serializer<boost::beast::http::string_body> serializer_{response_};
  bool admitted_ = false;  // its token was right, and it has no whole answer yet
};

}  // namespace spool::tools
