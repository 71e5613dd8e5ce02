#include "lsystem/expression.h"

#include <cmath>
#include <iomanip>
#include <sstream>

#include "lsystem/keys.h"
#include "tests/lsystem/lsystem_cases.h"

using namespace cloudbake;

namespace {

struct Result {
  double value;
  EvaluationContext context;
};

Result run(const std::string& source, uint64_t key = 0) {
  const PlainText text = plainText("e", {source, 3, 1});
  int calls = 0;
  const NameScope scope{{"p", "missing"}, {"width_factor"}};
  const Expression expression = compileExpression(text, 0, text.characters.size(), scope, calls);
  Result result{0, {}};
  const std::vector<double> locals{5, NAN}, variables{0.25};
  result.context.locals = locals;
  result.context.variables = variables;
  result.context.key = key;
  result.context.root = rootKey(1);
  result.context[Builtin::kPass] = 7;
  result.context[Builtin::kArc] = 11;
  result.value = evaluate(expression, result.context);
  result.context.locals = {};
  result.context.variables = {};
  return result;
}

double valueOf(const std::string& source) { return run(source).value; }

}  // namespace

// Row 18 of the table.
TEST(Expression, PrecedenceIsThatOfC) {
  EXPECT_DOUBLE_EQ(valueOf("2+3*4^2/8%5"), 3);
  EXPECT_DOUBLE_EQ(valueOf("-2^2"), -4);
  EXPECT_DOUBLE_EQ(valueOf("2^3^2"), 512);
  EXPECT_DOUBLE_EQ(valueOf("3>2&1=0|5"), 1);
  EXPECT_DOUBLE_EQ(valueOf("-7%4"), -3);
  EXPECT_DOUBLE_EQ(valueOf("sin(30)"), 0.5);
  EXPECT_DOUBLE_EQ(valueOf("acos(0)"), 90);
  EXPECT_DOUBLE_EQ(valueOf("1/0"), 0);
  EXPECT_DOUBLE_EQ(valueOf("-1000000=-1000000.5"), 1) << "as near as 1e-6 of their size counts as equal";
  EXPECT_DOUBLE_EQ(valueOf("-1000000=-1000002"), 0);
}

TEST(Expression, OperatorsOfOneLevelGroupToTheLeft) {
  EXPECT_DOUBLE_EQ(valueOf("10-4-3"), 3);
  EXPECT_DOUBLE_EQ(valueOf("64/4/2*3"), 24);
  EXPECT_DOUBLE_EQ(valueOf("2^-1"), 0.5);
  EXPECT_DOUBLE_EQ(valueOf("--3+!0+!7"), 4);
  EXPECT_DOUBLE_EQ(valueOf("1 + 2 . 5 * ( 3 )"), 8.5);  // blanks mean nothing
  EXPECT_DOUBLE_EQ(valueOf("1e3+.5"), 1000.5);
}

TEST(Expression, RelationsForgiveRounding) {
  EXPECT_EQ(valueOf("0.1+0.1+0.1+0.1+0.1+0.1+0.1+0.1+0.1+0.1<1"), 0);
  EXPECT_EQ(valueOf("0.1*3=0.3"), 1);
  EXPECT_EQ(valueOf("0.1*3!=0.3"), 0);
  EXPECT_EQ(valueOf("0.1*3<=0.3&0.1*3>=0.3"), 1);
  EXPECT_EQ(valueOf("1>0.99999"), 1);
  EXPECT_EQ(valueOf("1000001=1000000.5"), 1);
  EXPECT_EQ(valueOf("0.00001=0"), 0);
}

TEST(Expression, FunctionsHaveTheirClosedForms) {
  EXPECT_DOUBLE_EQ(valueOf("min(3,2)+max(3,2)*10"), 32);
  EXPECT_DOUBLE_EQ(valueOf("clamp(7,0,5)+clamp(-1,0,5)+clamp(2,0,5)"), 7);
  EXPECT_DOUBLE_EQ(valueOf("fit01(0.25,10,20)"), 12.5);
  EXPECT_DOUBLE_EQ(valueOf("abs(-2)+floor(2.7)+ceil(2.1)+round(2.5)"), 10);
  EXPECT_DOUBLE_EQ(valueOf("sqrt(9)+pow(2,5)"), 35);
  EXPECT_NEAR(valueOf("tan(45)+atan2(1,-1)+asin(0.5)"), 1 + 135 + 30, 1e-12);
  EXPECT_DOUBLE_EQ(valueOf("if(0,1/0,4)+if(2,5,1/0)"), 9);
  EXPECT_DOUBLE_EQ(valueOf("p+t*A+width_factor"), 5 + 77 + 0.25);
}

// Exact, and quick however far the operands lie apart.
TEST(Expression, RemaindersOfHugeNumbersAreExact) {
  for (const double a : {1e308, 1e300, 12345678901234567.0, 1e5, 0.75})
    for (const double b : {1.7e-300, 7.25, 360.0, 1e15}) {
      std::ostringstream text;
      text << std::setprecision(17) << "-" << a << "%" << b;
      EXPECT_EQ(valueOf(text.str()), std::fmod(-a, b)) << text.str();
    }
  for (const double degrees : {1e308, -1e300, 0x1p53, 0x1p54 + 4, -0x1p55, 0x1p56, 3e17, 0x1p1023, 5e15, 720000001.0}) {
    const SinCos angle = sinCosDegrees(degrees), reduced = sinCosDegrees(std::fmod(degrees, 360));
    EXPECT_EQ(angle.sin, reduced.sin) << degrees;
    EXPECT_EQ(angle.cos, reduced.cos) << degrees;
  }
  EXPECT_TRUE(std::isnan(sinCosDegrees(INFINITY).sin));
}

TEST(Expression, CountsItsWork) {
  const uint64_t plain = run("1+2").context.steps, slow = run("1^2").context.steps;
  EXPECT_EQ(plain, 3U);
  EXPECT_GT(slow, plain);
  EXPECT_GT(run("1e300%1e-300").context.steps, run("7%3").context.steps);
  EXPECT_GT(run("-1e300%1e-300").context.steps, run("-7%3").context.steps);
}

TEST(Expression, CountsWhatItRepairs) {
  EXPECT_EQ(run("1/0+1%0").context.divisions_by_zero, 2U);
  EXPECT_EQ(run("if(0,1/0,4)").context.divisions_by_zero, 0U);
  EXPECT_EQ(run("0&1/0").context.divisions_by_zero, 0U);
  EXPECT_EQ(run("asin(2)").context.clamped_arguments, 1U);
  EXPECT_DOUBLE_EQ(valueOf("asin(2)"), 90);
  EXPECT_EQ(run("asin(-2)").context.clamped_arguments, 1U);
  EXPECT_DOUBLE_EQ(valueOf("asin(-2)"), -90);
  EXPECT_DOUBLE_EQ(valueOf("acos(-2)"), 180);
  EXPECT_EQ(run("asin(1.0000000001)").context.clamped_arguments, 0U);
  EXPECT_EQ(run("missing+1").context.missing_arguments, 1U);
  EXPECT_DOUBLE_EQ(valueOf("missing+1"), 1);
}

// Rows 28 and 32: the numbers of an independent program.
TEST(Expression, RandomDrawsAreThoseOfTheReference) {
  const uint64_t key = premiseKey(rootKey(1), 0);
  EXPECT_EQ(key, 0x46b73e79f0c37c00ULL);
  EXPECT_EQ(premiseKey(rootKey(1), 1), 0x374327c63d0cc8a6ULL);
  EXPECT_EQ(childKey(key, 0), 0xd0482a64bb856459ULL);
  EXPECT_DOUBLE_EQ(drawUniform(key, DrawChannel::kRule, 1), .9909284327845816);
  EXPECT_DOUBLE_EQ(drawUniform(key, DrawChannel::kFunction, 0), .34226718209266704);
  EXPECT_DOUBLE_EQ(run("rand()", key).value, .34226718209266704);
  EXPECT_NEAR(run("0*rand()+rand()", key).value, .847230, 1e-6);
  EXPECT_NEAR(valueOf("rand(1)"), .142078, 1e-6);
  EXPECT_EQ(valueOf("rand(0)"), valueOf("rand(-0)"));
}

// A call has its number by its place, whether or not an earlier one was evaluated.
TEST(Expression, RandKeepsItsNumberInUntakenBranches) {
  EXPECT_EQ(run("if(0,rand(),0)+rand()", 9).value, drawUniform(9, DrawChannel::kFunction, 1));
}

TEST(Expression, ErrorsNameThePlaceAndTheCure) {
  EXPECT_EQ(expectInputError([] { valueOf("1 + widht_factor"); }, "did you mean \"width_factor\"").column, 5);
  expectInputError([] { valueOf("1+q"); }, "unknown variable \"q\"");
  expectInputError([] { valueOf("flor(2)"); }, "did you mean \"floor\"");
  EXPECT_EQ(expectInputError([] { valueOf("2*(3+1"); }, "never closed").column, 3);
  EXPECT_EQ(expectInputError([] { valueOf("2 3 4 )"); }, "unexpected \")\"").column, 7);
  EXPECT_EQ(expectInputError([] { valueOf("2*"); }, "value is expected").line, 3);
  expectInputError([] { valueOf("sin(1,2)"); }, "takes 1 argument(s), not 2");
  expectInputError([] { valueOf("min(1,)"); }, "missing");
  expectInputError([] { valueOf("ch(\"../tx\")"); }, "Houdini scene");
  expectInputError([] { valueOf("$F+1"); }, "Houdini variables");
  expectInputError([] { valueOf("`1+1`"); }, "backquote");
  expectInputError(
      [] {
        valueOf(
            "2\xC3\x97"
            "3");
      },
      "ASCII");
  expectInputError([] { valueOf("1e999"); }, "the number '1e999' is beyond what can be computed with");
  expectInputError([] { valueOf("2*1e-999"); }, "the number '1e-999' is beyond");
}

TEST(Expression, DepthIsLimited) {
  std::string deep, flat = "1";
  for (int i = 0; i < 300; ++i) deep += "(", flat += "+1";
  expectInputError([&] { valueOf(deep + "1" + std::string(300, ')')); }, "200 levels");
  expectInputError([&] { valueOf(flat); }, "200 levels");
  expectInputError([&] { valueOf(std::string(300, '-') + "1"); }, "200 levels");
  EXPECT_DOUBLE_EQ(valueOf(std::string(150, '(') + "1" + std::string(150, ')')), 1);
}
