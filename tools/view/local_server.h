// An HTTP server for one person on this machine: it listens on 127.0.0.1 only, answers GET only,
// and only under an address that holds a random token.
//
// A request is refused with 403 when its Host is not this server (a page elsewhere whose name was
// bound to 127.0.0.1) or the token is missing, 405 when it is no GET, 404 when nothing of that name
// is served. No header lets other origins read an answer. Names are compared whole with those that
// were handed in; no path of a file is ever made of a request.
//
// Others on the machine can connect, too: a request is 64 kB and 10 s at most, and costs no thread
// before its token was found right. Where 256 connections are open, the oldest that has shown no
// token makes room for the next. One connection is one request; `Range` is not read.
#pragma once

#include <functional>
#include <string>

#include "lib/core/error.h"
#include "tools/view/answers.h"

namespace spool::tools {

// Serves until the process ends; `ready` gets the address once it can be asked, and its error ends
// the server. Port 0, or one that is taken: any free one. Errors kIo when no port can be had.
Result<void> serve_locally(const Answers& answers, int port,
                           const std::function<Result<void>(const std::string& url)>& ready);

}  // namespace spool::tools
