// What the local server can be asked for, and what it answers.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

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

}  // namespace spool::tools
