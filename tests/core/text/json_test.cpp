// What is refused before it can overflow the stack, and where a text goes wrong.
#include "core/text/json.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace cloudbake {
namespace {

std::string nested(int levels) { return std::string(size_t(levels), '[') + std::string(size_t(levels), ']'); }

JsonFault faultOf(std::string_view text) {
  JsonFault fault;
  EXPECT_FALSE(parseJson(text, &fault)) << text.substr(0, 100);
  EXPECT_FALSE(parseJson(text));
  return fault;
}

TEST(Json, KeepsTheOrderOfKeys) {
  const std::optional<Json> json = parseJson(R"({"b": [1, 2.5], "a": "]]]]{{"})");
  ASSERT_TRUE(json);
  EXPECT_EQ(json->dump(), R"({"b":[1,2.5],"a":"]]]]{{"})");
}

TEST(Json, RefusesWhatIsNestedDeeply) {
  EXPECT_TRUE(parseJson(nested(kMostNestedJson)));
  EXPECT_EQ(faultOf(nested(kMostNestedJson + 1)).why, "is nested more than 200 levels deep");
  for (const int levels : {100000, 1000000})
    EXPECT_EQ(faultOf("{\"a\": " + nested(levels) + "}").why, "is nested more than 200 levels deep");
  EXPECT_EQ(faultOf(std::string(100000, '{')).why, "is nested more than 200 levels deep");
  EXPECT_TRUE(parseJson("\"" + nested(1000) + "\\\"" + nested(1000) + "\"")) << "brackets in a text";
}

TEST(Json, NamesTheLineOfAFault) {
  EXPECT_EQ(faultOf("{\n\"a\":\n?\n}\n").line, 3);
  EXPECT_EQ(faultOf("").line, 1);
  EXPECT_EQ(faultOf("[1,\n2").why, "ends too early or is not valid from here on");
  EXPECT_EQ(faultOf("[1e999]").why, "has a number that is too large");
  EXPECT_EQ(faultOf("[1e999]").line, 0);
}

}  // namespace
}  // namespace cloudbake
