#include "lsystem/grammar.h"

#include "tests/lsystem/lsystem_cases.h"

using namespace cloudbake;

namespace {

Rule ruleOf(const std::string& text) { return Case("AB", {text}).grammar().rules.at(0); }
std::string replacementOf(const Rule& rule) {
  std::string symbols;
  for (const ModuleTemplate& module : rule.replacement) symbols += module.symbol;
  return symbols;
}

}  // namespace

TEST(Grammar, FindsTheSeparator) {
  EXPECT_EQ(replacementOf(ruleOf("A=FA")), "FA");
  EXPECT_EQ(replacementOf(ruleOf("A -> F A")), "FA");
  EXPECT_EQ(replacementOf(ruleOf("A(x):x==3=B(x)")), "B");
  EXPECT_EQ(replacementOf(ruleOf("A(x):x=3=B(x)")), "B");
  EXPECT_EQ(replacementOf(ruleOf("A(x):x<=3=B(x)")), "B");
  EXPECT_EQ(replacementOf(ruleOf("A(x):x!=3->B(x=1)")), "B");
  EXPECT_EQ(replacementOf(ruleOf("!->F")), "F");
  EXPECT_EQ(replacementOf(ruleOf("A=")), "");
  EXPECT_EQ(replacementOf(ruleOf(R"(A=\\#(2)F)")), R"(\\#F)");  // a backslash stands for itself, # is a symbol
}

TEST(Grammar, SplitsContextsConditionAndProbability) {
  const Rule rule = ruleOf("XA(i)Y < B(j) > C(k)D : i<j & k>0 = F(i+j):G : 0.25");
  ASSERT_EQ(rule.left.size(), 3U);
  EXPECT_EQ(rule.left[1].symbol, 'A');
  EXPECT_EQ(rule.left[1].formals, std::vector<int>{0});
  EXPECT_EQ(rule.predecessor.symbol, 'B');
  EXPECT_EQ(rule.predecessor.formals, std::vector<int>{1});
  ASSERT_EQ(rule.right.size(), 2U);
  EXPECT_EQ(rule.right[0].formals, std::vector<int>{2});
  EXPECT_EQ(rule.local_count, 3);
  EXPECT_FALSE(rule.condition.nodes.empty());
  EXPECT_EQ(constantValue(rule.probability), 0.25);
  EXPECT_EQ(replacementOf(rule), "F:G");  // only the last colon begins the probability
}

TEST(Grammar, ReadsArguments) {
  const Grammar grammar = Case(R"(J(,,4)a("my name",1)F())", {}).grammar();
  ASSERT_EQ(grammar.premise.size(), 3U);
  ASSERT_EQ(grammar.premise[0].arguments.size(), 3U);
  EXPECT_TRUE(grammar.premise[0].arguments[0].nodes.empty());
  EXPECT_EQ(constantValue(grammar.premise[0].arguments[2]), 4.0);
  EXPECT_EQ(grammar.texts.at(size_t(grammar.premise[1].text)), "my name");
  EXPECT_TRUE(grammar.premise[2].arguments.empty());
}

TEST(Grammar, IgnoresBlankLinesAndComments) { EXPECT_EQ(Case("A", {"", "   ", "  # A=B", "A=F", "\t\r"}).grammar().rules.size(), 1U); }

// Row 34 and its kin: file, line, column, cure.
TEST(Grammar, ErrorsNameThePlace) {
  const auto fails = [](const std::string& rule, const std::string& piece) {
    return expectInputError([&] { Case("A", {"# first", rule}).grammar(); }, piece);
  };
  const InputError open = fails("A = B(", "never closed");
  EXPECT_EQ(open.file, "test.rules");
  EXPECT_EQ(open.line, 3);
  EXPECT_EQ(open.column, 6);
  EXPECT_EQ(fails("A=B(q)", "unknown variable \"q\"").column, 5);
  fails("AFA", "no \"=\"");
  fails("!=F", "write !->F");
  EXPECT_EQ(fails("AB=C", "must be one symbol, found \"AB\"").column, 1);
  fails("=C", "must be one symbol");
  fails("<A=C", "a context is missing");
  fails("A>=C", "no \"=\"");
  fails("A<B<C=D", "more than one");
  fails("[<A=D", "brackets");
  fails("A(1)=B", "names such as");
  fails("A(i)<B(i)=C", "appears twice");
  fails("A=B)", "closes nothing");
  fails("A=(3)B", "must follow a symbol");
  fails("A=B(\"x\")", "first argument of a(");
  fails("A=a(\"x)", "closing quote");
  fails("A=B:", "value is expected");
  fails("A:=B", "value is expected");
  const InputError quoted = fails("A=B(`$F`)", "backquote");
  EXPECT_EQ(quoted.line, 3);
  EXPECT_EQ(quoted.column, 5);
  fails("A=B($F)", "Houdini variables");
  fails("A=B(chan(\"x\"))", "Houdini scene");
  fails(
      "A=\xE2\x80\x9C"
      "F",
      "ASCII");
  EXPECT_EQ(expectInputError([] { Case("AB(", {}).grammar(); }, "never closed").line, 1);
  expectInputError([] { Case(" ", {}).grammar(); }, "premise is empty");
}

TEST(Grammar, DollarOutsideExpressionsIsATurtleSymbol) { EXPECT_EQ(replacementOf(ruleOf("A=F$F")), "F$F"); }

TEST(Grammar, WarnsOfRulesThatCannotDoWhatTheySay) {
  const auto warningOf = [](const std::vector<std::string>& rules) {
    Case c("AB", rules);
    c.grammar();
    return c.warning();
  };
  EXPECT_NE(warningOf({"A=B", "A=C:0.5"}).find("an earlier rule always rewrites"), std::string::npos);
  EXPECT_NE(warningOf({"A=B:0.7", "A=C:0.7"}).find("over 1"), std::string::npos);
  EXPECT_NE(warningOf({"A=B:70", "A=C:70"}).find("over 1"), std::string::npos);
  EXPECT_NE(warningOf({"Q=B"}).find("produces a \"Q\""), std::string::npos);
  EXPECT_NE(warningOf({"A:1=2=B"}).find("always false"), std::string::npos);
  EXPECT_NE(warningOf({"A=B:0"}).find("probability is 0"), std::string::npos);
  EXPECT_NE(warningOf({"F<A=BF"}).find("ignored context"), std::string::npos);
  EXPECT_NE(warningOf({"A(x)=B(x)"}).find("hides"), std::string::npos);
  EXPECT_NE(warningOf({"A=B,C"}).find("cpfg"), std::string::npos);
  EXPECT_NE(warningOf({"A=~L"}).find("cpfg"), std::string::npos);
  EXPECT_NE(warningOf({"A=a(3)"}).find("does nothing"), std::string::npos);
}

TEST(Grammar, IsSilentAboutGoodRules) {
  const std::vector<std::vector<std::string>> good{{"A=B:0.5", "A=C:0.5"},           {"A=B:0.3", "A=C"}, {"A:t<3=B", "A=C"},
                                                   {"A(i):i<4=B:0.7", "A(i):i<4=C"}, {"A>B=C", "A=D"},   {"A=~(20)F~F"}};
  for (const auto& rules : good) {
    Case c("AB", rules);
    c.grammar();
    EXPECT_FALSE(c.warned()) << c.warning();
  }
}

TEST(Grammar, NamesAreLimited) {
  const auto repeated = [](int count, const std::string& before, const std::string& after, const std::string& separator) {
    std::string text;
    for (int k = 0; k < count; ++k) text += (k > 0 ? separator : "") + before + std::to_string(k) + after;
    return text;
  };
  EXPECT_EQ(Case("A", {"A(" + repeated(100, "k", "", ",") + ")=F"}).grammar().rules[0].local_count, 100);
  expectInputError([&] { Case("A", {"A(" + repeated(101, "k", "", ",") + ")=F"}).grammar(); }, "more than 100 names on the left side");
  expectInputError([&] { Case(repeated(101, "a(\"", "\",1)", ""), {}).grammar(); }, "more than 100 names of attributes");
  Case c("F", {});
  for (int k = 0; k < 98; ++k) c.text.variables.emplace_back("v" + std::to_string(k), k);
  expectInputError([&] { c.grammar(); }, "more than 100 variables");
}

TEST(Grammar, DeclaredVariables) {
  Case c("F(w2+b)", {});
  c.text.variables = {{"w2", 3}, {"b", 4}};
  EXPECT_EQ(c.string(0), "F(7)");
  for (const std::string name : {"ab", "m0z", "A9", "Zz", "_", "z_0"}) {
    Case one("F(" + name + ")", {});
    one.text.variables = {{name, 5}};
    EXPECT_EQ(one.string(0), "F(5)");
  }
  for (const std::string name : {"", "9a", "a`", "a{", "@a", "a[", "a:", "a/", "é"}) {
    c.text.variables = {{name, 3}};
    expectInputError([&] { c.grammar(); }, "is not a valid name");
  }
  c.text.variables = {{"t", 3}};
  expectInputError([&] { c.grammar(); }, "built in");
  c.text.variables = {{"2w", 3}};
  expectInputError([&] { c.grammar(); }, "is not a valid name");
}
