#include "tools/show/plane_text.h"

#include <cstring>

#include "tools/json/json_text.h"

namespace spool::tools {

std::string PlaneText::text() const {
  std::string told = json_text(said_);
  told.append((4 - told.size() % 4) % 4, ' ');
  std::string body;
  for (int shift = 0; shift < 32; shift += 8)
    body += static_cast<char>(told.size() >> shift & 255u);
  body += told;
  const std::size_t begin = body.size();
  body.resize(begin + values_.size() * sizeof(float));
  std::memcpy(body.data() + begin, values_.data(), values_.size() * sizeof(float));
  return body;
}

}  // namespace spool::tools
