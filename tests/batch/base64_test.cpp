#include "tools/batch/base64.h"

#include <gtest/gtest.h>

namespace spool::tools {
namespace {

TEST(Base64, EqualsTheExamplesOfItsStandard) {
  const std::pair<const char*, const char*> examples[] = {{"", ""},
                                                          {"f", "Zg=="},
                                                          {"fo", "Zm8="},
                                                          {"foo", "Zm9v"},
                                                          {"foob", "Zm9vYg=="},
                                                          {"fooba", "Zm9vYmE="},
                                                          {"foobar", "Zm9vYmFy"}};
  for (const auto& [bytes, text] : examples) {
    EXPECT_EQ(to_base64(bytes), text);
    EXPECT_EQ(from_base64(text), bytes);
  }
}

TEST(Base64, EveryByteAndEveryLengthComeBack) {
  std::string bytes;
  for (int i = 0; i < 700; ++i) {
    EXPECT_EQ(from_base64(to_base64(bytes)), bytes) << "of " << i << " bytes";
    bytes += static_cast<char>(i * 37);
  }
}

TEST(Base64, WhatIsNoBase64IsNothing) {
  for (const char* text : {"Zg", "Z", "####", "Zg==Zg==", "Zm9\x01"})
    EXPECT_EQ(from_base64(text), "") << text;
}

}  // namespace
}  // namespace spool::tools
