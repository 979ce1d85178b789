// An HTTP server for one person on this machine: it listens on 127.0.0.1 only, answers GET only,
// and only under an address that holds a random token.
//
// A request is refused with 403 when its Host is not this server (a page elsewhere whose name was
// bound to 127.0.0.1) or the token is missing, 405 when it is no GET, 404 when nothing of that name
// is served. No header lets other origins read an answer. Names are compared whole with those that
// were handed in; no path of a file is ever made of a request.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "lib/core/error.h"

namespace spool::tools {

struct Answer {
  int status = 200;
  std::string type = "application/json";
  std::string body;
};

// The value of a parameter of the request; empty where it was not given.
using Query = std::function<std::string(std::string_view)>;
// By name below the token: "" is the page. Called on several threads.
using Answers = std::map<std::string, std::function<Answer(const Query&)>>;

// Serves until the process ends; `ready` is told the address once somebody can ask. Port 0, or one
// that is taken: any free one. Errors kIo when no port can be had.
Result<void> serve_locally(const Answers& answers, int port,
                           const std::function<void(const std::string& url)>& ready);

}  // namespace spool::tools
