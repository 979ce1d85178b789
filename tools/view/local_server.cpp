// The only file that includes the HTTP library, which costs seconds per translation unit.
#include "tools/view/local_server.h"

#include <sys/random.h>

#include <array>
#include <exception>
#include <memory>

#include <fmt/format.h>
#include <httplib.h>

namespace spool::tools {
namespace {

constexpr const char* kHost = "127.0.0.1";
constexpr std::size_t kMostBody = 1024;  // bytes of a request's body; nobody needs one
constexpr int kSecondsToSend = 10;       // that a request may take to arrive
constexpr int kSecondsIdle = 2;          // that a connection may wait for its next request
constexpr std::size_t kThreads = 32;     // more than the connections of a few browsers

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

// Takes the same time wherever two texts of one length differ.
bool same_text(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  return difference == 0;
}

// "/TOKEN/name" in its two parts.
std::pair<std::string, std::string> split_path(const std::string& path) {
  const std::size_t end = path.find('/', 1);
  if (path.empty() || end == std::string::npos) return {path.substr(path.empty() ? 0 : 1), ""};
  return {path.substr(1, end - 1), path.substr(end + 1)};
}

void refuse(httplib::Response& response, int status, const std::string& why) {
  response.status = status;
  response.set_content("{\"error\": \"" + why + "\"}\n", "application/json");
}

bool is_this_server(const std::string& host, int port) {
  return host == fmt::format("{}:{}", kHost, port) || host == fmt::format("localhost:{}", port);
}

void answer_request(const Answers& answers, const httplib::Request& request,
                    httplib::Response& response) {
  const auto found = answers.find(split_path(request.path).second);
  if (found == answers.end()) return refuse(response, 404, "nothing of that name is served");
  const Query query = [&](std::string_view name) {
    return request.get_param_value(std::string(name));
  };
  try {
    const auto answer = std::make_shared<const Answer>(found->second(query));
    response.status = answer->status;
    // In pieces: the library compresses what it is given at once, for seconds.
    response.set_content_provider(
        answer->body.size(), answer->type,
        [answer](std::size_t at, std::size_t length, httplib::DataSink& sink) {
          return sink.write(answer->body.data() + at, length);
        });
  } catch (const std::exception&) {  // out of memory: this answer fails, the server goes on
    refuse(response, 500, "out of memory: ask for a smaller budget");
  }
}

void set_limits(httplib::Server& server) {
  server.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
  server.set_payload_max_length(kMostBody);
  server.set_read_timeout(kSecondsToSend);
  server.set_keep_alive_timeout(kSecondsIdle);
  server.set_default_headers({{"Cache-Control", "no-store"},
                              {"X-Content-Type-Options", "nosniff"},
                              {"Referrer-Policy", "no-referrer"},
                              {"X-Frame-Options", "DENY"},
                              {"Cross-Origin-Resource-Policy", "same-origin"}});
}

// No other process may share the port, whoever starts it: the library's own options would let it.
void own_port(int socket) {
  const int yes = 1;
  ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
}

}  // namespace

Result<void> serve_locally(const Answers& answers, int port,
                           const std::function<void(const std::string& url)>& ready) {
  SPOOL_ASSIGN(const std::string token, random_token());
  httplib::Server server;
  set_limits(server);
  server.set_socket_options(own_port);
  if (port == 0 || !server.bind_to_port(kHost, port)) port = server.bind_to_any_port(kHost);
  if (port <= 0) return fail(ErrorCode::kIo, "no port of {} is free: end another server", kHost);
  server.set_pre_routing_handler(
      [&, port](const httplib::Request& request, httplib::Response& response) {
        const bool alone = request.get_header_value_count("Host") == 1;
        if (!alone || !is_this_server(request.get_header_value("Host"), port)) {
          refuse(response, 403, "another host");
        } else if (!same_text(split_path(request.path).first, token)) {
          refuse(response, 403, "the address lacks its token");
        } else if (request.method != "GET") {
          refuse(response, 405, "only GET");
        } else {
          return httplib::Server::HandlerResponse::Unhandled;
        }
        return httplib::Server::HandlerResponse::Handled;
      });
  server.Get(".*", [&](const httplib::Request& request, httplib::Response& response) {
    answer_request(answers, request, response);
  });
  ready(fmt::format("http://{}:{}/{}/", kHost, port, token));
  if (server.listen_after_bind()) return {};
  return fail(ErrorCode::kIo, "port {}: listening failed: start again", port);
}

}  // namespace spool::tools
