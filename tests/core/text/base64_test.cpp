#include "core/text/base64.h"

#include <gtest/gtest.h>

namespace cloudbake {
namespace {

// RFC 4648, section 10, and bytes above 127.
TEST(Base64, VectorsOfTheStandard) {
  EXPECT_EQ(encodeBase64(""), "");
  EXPECT_EQ(encodeBase64("f"), "Zg==");
  EXPECT_EQ(encodeBase64("fo"), "Zm8=");
  EXPECT_EQ(encodeBase64("foo"), "Zm9v");
  EXPECT_EQ(encodeBase64("foob"), "Zm9vYg==");
  EXPECT_EQ(encodeBase64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(encodeBase64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(encodeBase64(std::string_view("\xff\xfe\x00\x80", 4)), "//4AgA==");
}

TEST(Base64, ReadsWhatItWrites) {
  for (const std::string text : {"", "f", "fo", "foo", "foob", "fooba", "foobar", "\xff\xfe\x80"}) {
    const std::string base64 = encodeBase64(text);
    EXPECT_EQ(decodeBase64(base64), text);
    EXPECT_EQ(decodeBase64(base64.substr(0, base64.find('='))), text);
  }
  for (const char* damaged : {"Z", "Zm9vY", "Zm=v", "Zg===", "====", "Zm9v Zm9v", "Zm9v\n", "Zm9\xe4", "Zm9-"})
    EXPECT_FALSE(decodeBase64(damaged)) << damaged;
}

}  // namespace
}  // namespace cloudbake
