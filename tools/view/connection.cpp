#include "tools/view/connection.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <limits>
#include <utility>

#include <fmt/core.h>

#include "lib/core/percent_text.h"

namespace spool::tools {
namespace {

namespace net = boost::asio;
namespace http = boost::beast::http;
using boost::system::error_code;
using std::chrono::seconds;

constexpr std::size_t kMostHead = 64 << 10;   // bytes of a request; its body is not used
constexpr std::size_t kMostTarget = 8 << 10;  // bytes of its address
constexpr seconds kTimeToAsk{10};             // for the whole request
constexpr seconds kTimeToTake{10};            // for each piece of the answer
constexpr seconds kTimeToClose{2};            // for the other side, once it has its answer

// Takes the same time wherever two texts of one length differ.
bool same_text(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  return difference == 0;
}

std::string text_of(boost::beast::string_view view) {
  return std::string(view.data(), view.size());
}

Answer refusal(int status, const std::string& why) {
  return {status, "application/json", "{\"error\": \"" + why + "\"}\n"};
}

// What there is to answer to a request that could not be read; status 0: nothing.
Answer refusal_of(error_code error) {
  if (error == http::error::header_limit || error == http::error::buffer_overflow)
    return refusal(431, "the request is too long");
  const bool ended = error == http::error::end_of_stream || error == http::error::partial_message;
  if (!ended && error.category() == make_error_code(http::error::bad_method).category())
    return refusal(400, "no request of HTTP");
  return {0, "", ""};
}

// What precedes the first `end`; the text then begins behind it.
std::string_view cut(std::string_view& text, char end) {
  const std::size_t at = text.find(end);
  const std::string_view head = text.substr(0, at);
  text = at == std::string_view::npos ? std::string_view{} : text.substr(at + 1);
  return head;
}

RequestTarget parse_target(std::string_view target) {
  if (!target.starts_with('/')) return {};
  target.remove_prefix(1);
  std::string_view path = cut(target, '?');
  // Without its slash the page would ask for what lies beside its token: it is not served there.
  const bool page = path.find('/') != std::string_view::npos;
  const std::string_view token = cut(path, '/');
  return {std::string(token), page ? std::string(path) : "/", std::string(target)};
}

// The first value of that name, its %XX replaced.
std::string parameter_of(std::string_view parameters, std::string_view name) {
  while (!parameters.empty()) {
    std::string_view value = cut(parameters, '&');
    if (cut(value, '=') == name) return percent_decoded(value);
  }
  return "";
}

Answer computed(const std::function<Answer(const Query&)>& make, const std::string& parameters) {
  try {
    return make([&](std::string_view name) { return parameter_of(parameters, name); });
  } catch (const std::exception&) {  // out of memory: this answer fails, the server goes on
    return refusal(500, "out of memory: ask for a smaller budget");
  }
}

}  // namespace

bool Service::is_this_server(std::string_view host) const {
  return host == fmt::format("127.0.0.1:{}", port) || host == fmt::format("localhost:{}", port);
}

Connection::Connection(net::ip::tcp::socket socket, const Service& service,
                       net::thread_pool& workers)
    : stream_(std::move(socket)), service_(service), workers_(workers), buffer_(kMostHead) {
  parser_.header_limit(kMostHead);
  parser_.body_limit(std::numeric_limits<std::uint64_t>::max());  // 405 says more than 413
}

void Connection::start() {
  stream_.expires_after(kTimeToAsk);
  http::async_read_header(
      stream_, buffer_, parser_,
      [self = shared_from_this()](error_code error, std::size_t) { self->asked(error); });
}

void Connection::asked(error_code error) {
  Answer answer = error ? refusal_of(error) : refused();
  if (answer.status != 0) return send(std::move(answer));
  if (error) return close();
  stream_.expires_never();
  net::post(workers_, [self = shared_from_this()]() mutable {
    Answer made = computed(self->service_.answers.at(self->target_.name), self->target_.parameters);
    const auto io = self->stream_.get_executor();
    net::post(io, [self = std::move(self), made = std::move(made)]() mutable {
      self->send(std::move(made));
    });
  });
}

Answer Connection::refused() {
  const auto& request = parser_.get();
  if (request.count(http::field::host) != 1 ||
      !service_.is_this_server(text_of(request[http::field::host])))
    return refusal(403, "another host");
  target_ = parse_target(text_of(request.target()));
  if (!same_text(target_.token, service_.token)) return refusal(403, "the address lacks its token");
  admitted_ = true;
  if (request.method() != http::verb::get) return refusal(405, "only GET");
  if (request.target().size() > kMostTarget) return refusal(414, "the address is too long");
  if (!service_.answers.contains(target_.name))
    return refusal(404, "nothing of that name is served");
  return {0, "", ""};
}

void Connection::send(Answer answer) {
  response_.result(static_cast<unsigned>(answer.status));
  response_.set(http::field::content_type, answer.type);
  response_.set(http::field::cache_control, "no-store");
  response_.set("X-Content-Type-Options", "nosniff");
  response_.set("Referrer-Policy", "no-referrer");
  response_.set("X-Frame-Options", "DENY");
  response_.set("Cross-Origin-Resource-Policy", "same-origin");
  response_.keep_alive(false);
  response_.body() = std::move(answer.body);
  response_.prepare_payload();
  if (parser_.get().method() == http::verb::head) response_.body().clear();
  send_piece();
}

void Connection::send_piece() {
  stream_.expires_after(kTimeToTake);
  http::async_write_some(stream_, serializer_,
                         [self = shared_from_this()](error_code error, std::size_t) {
                           if (error) return self->close();
                           if (!self->serializer_.is_done()) return self->send_piece();
                           self->finish();
                         });
}

// A socket that is closed over unread bytes takes its answer back: what else was sent is read, but
// no more than a request may be.
void Connection::finish() {
  error_code ignored;
  stream_.socket().shutdown(net::ip::tcp::socket::shutdown_send, ignored);
  stream_.expires_after(kTimeToClose);
  buffer_.clear();
  response_.body() = {};
  admitted_ = false;  // a client that has its answer makes room first
  net::async_read(stream_, buffer_, net::transfer_at_least(kMostHead),
                  [self = shared_from_this()](error_code, std::size_t) { self->close(); });
}

}  // namespace spool::tools
