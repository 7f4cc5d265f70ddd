#include "tests/mutation/operators.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <set>

#include "tests/mutation/code_text.hpp"
#include "tests/mutation/draw.hpp"

namespace clearway::mutation {
namespace operators_test {

/// What the operators make of one line inside a function, without the line's other text.
std::set<std::string> changed(const std::string& line) {
  const std::string source = "void f() {\n  " + line + "\n}\n";
  std::set<std::string> lines;
  for (const Fault& fault : faults_of(source)) {
    const std::string faulty = fault.applied_to(source);
    EXPECT_NE(faulty, source) << fault.kind;
    lines.insert(fault.kind + ": " + faulty.substr(13, faulty.size() - 16));
  }
  return lines;
}

using Lines = std::set<std::string>;

TEST(MutationOperators, ChangeComparisonsSignsFactorsNumbersAndWords) {
  EXPECT_EQ(changed("if (a < b) g();"), (Lines{"boundary: if (a <= b) g();", "relation: if (a >= b) g();"}));
  EXPECT_EQ(changed("x = a - b;"), (Lines{"sign: x = a + b;", "dropped: ;"}));
  EXPECT_EQ(changed("const auto x = std::min(a, b);"), (Lines{"extremum: const auto x = std::max(a, b);"}));
  EXPECT_EQ(changed("const auto x = p.q(i) * r;"),
            (Lines{"product: const auto x = p.q(i) / r;", "product: const auto x = p.q(i);"}));
  EXPECT_EQ(changed("const auto x = std::abs(a);"), (Lines{"absolute: const auto x = (a);"}));
  EXPECT_EQ(changed("const int x = 7;"),
            (Lines{"off by one: const int x = 6;", "off by one: const int x = 8;"}));
  EXPECT_EQ(changed("const double x = 0.8;"),
            (Lines{"constant: const double x = 0.0;", "constant: const double x = (0.5 * 0.8);",
                   "constant: const double x = 1.0;"}));
}

TEST(MutationOperators, LeaveExponentsAndJoinedTextsWhole) {
  EXPECT_EQ(changed("const bool x = a == \"b\";"), (Lines{"relation: const bool x = a != \"b\";"}));
  EXPECT_EQ(changed("const auto x = 1e-9 * r;"),
            (Lines{"product: const auto x = 1e-9 / r;", "product: const auto x = 1e-9;"}));
}

TEST(MutationOperators, DropStatementsGuardsAndNegationsAndAnswerBothWays) {
  EXPECT_EQ(changed("continue;"), (Lines{"dropped: ;"}));
  EXPECT_EQ(changed("list.push_back(x);"), (Lines{"dropped: ;"}));
  EXPECT_EQ(changed("if (done) return;"), (Lines{"dropped: ;"}));
  EXPECT_EQ(changed("if (!done) g();"), (Lines{"logic: if (done) g();"}));
  EXPECT_EQ(changed("return true;"), (Lines{"answer: return false;"}));
  EXPECT_EQ(changed("return a && b;"),
            (Lines{"logic: return a || b;", "answer: return true;", "answer: return false;"}));
}

TEST(MutationOperators, LeaveAloneWhatIsNoCodeDeclarationsTemplatesAndAllowancesForRounding) {
  for (const char* line :
       {"// a < b + 1", "const char* x = \"a < b + 1\";", "std::vector<int> list;", "Foo& x = y;",
        "const double x = 1e-9;", "const Array<float, 3>* p = q;", "static_assert(a < 4);",
        "HWY_BEFORE_NAMESPACE();", "const double x = y * (1.0 + 1e-9);",
        "const std::string x = a + \": \" + b;", "for (int i = 0; i < 8; ++i) __builtin_prefetch(p[i]);"})
    EXPECT_EQ(changed(line), Lines{}) << line;
}

TEST(MutationOperators, CodeKeepsItsPlaces) {
  const std::string source =
      "#include <a>\nint x = 1'000;  // one\nauto s = R\"(a\n\"b)\" + '\"';\n/* c\n d */ y();\n";
  const std::string code = code_only(source);
  ASSERT_EQ(code.size(), source.size());
  EXPECT_EQ(code.find("include"), std::string::npos);
  EXPECT_EQ(code.find("one"), std::string::npos);
  EXPECT_EQ(code.find('b'), std::string::npos);
  EXPECT_EQ(code.substr(source.find("y()"), 4), "y();");
  EXPECT_NE(code.find("1'000"), std::string::npos);
  EXPECT_EQ(line_number(source, source.find("y()")), 6);
  EXPECT_EQ(line_at(source, source.find("y()")), "d */ y();");
}

TEST(MutationDraw, TakesAsManyFromEachFileAndDoesNotChangeWithLinesThatMove) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "clearway_mutation_draw";
  std::filesystem::create_directories(folder);
  const std::string code = "bool f(int a, int b) {\n  if (a < b) return true;\n  return a + b > 4;\n}\n";
  const auto names = [&](const std::string& before) {
    std::ofstream(folder / "one.cpp") << before << code;
    std::ofstream(folder / "two.cpp") << code;
    std::vector<std::string> list;
    for (const Candidate& candidate : drawn(folder, {"one.cpp", "two.cpp"}, 7))
      list.push_back(candidate.file + candidate.text + candidate.change);
    return list;
  };
  const std::vector<std::string> first = names(""), moved = names("int g();\n\n// more\n");
  EXPECT_GT(first.size(), 10U);
  EXPECT_EQ(first, moved);
  for (std::size_t i = 0; i + 1 < first.size(); i += 2)
    EXPECT_NE(first[i].substr(0, 7), first[i + 1].substr(0, 7));
  std::filesystem::remove_all(folder);
}

TEST(MutationDraw, OfFewerFaultsThanFilesTakesOtherFilesForOtherSeeds) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "clearway_mutation_few";
  std::filesystem::create_directories(folder);
  std::vector<std::string> files;
  for (const char* name : {"a.cpp", "b.cpp", "c.cpp", "d.cpp", "e.cpp", "f.cpp", "g.cpp", "h.cpp"}) {
    std::ofstream(folder / name) << "bool f(int a, int b) {\n  return a < b;\n}\n";
    files.push_back(name);
  }
  std::map<std::string, int> met;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const std::vector<Candidate> order = drawn(folder, files, seed);
    std::set<std::string> once;
    for (std::size_t i = 0; i < files.size(); ++i) once.insert(order.at(i).file);
    EXPECT_EQ(once.size(), files.size());
    for (std::size_t i = 0; i < 2; ++i) ++met[order[i].file];
  }
  for (const std::string& file : files) EXPECT_GE(met[file], 3) << file << " of 10 expected";
  std::filesystem::remove_all(folder);
}

TEST(MutationDraw, FindsEveryFileThatDecides) {
  const std::vector<std::string> files = deciding_files(CLEARWAY_SOURCE_DIR);
  EXPECT_GT(files.size(), 35U);
  EXPECT_GT(drawn(CLEARWAY_SOURCE_DIR, files, 1).size(), 2000U);
}

TEST(MutationDraw, FindsEveryNamedFault) {
  const std::filesystem::path list =
      std::filesystem::path(CLEARWAY_SOURCE_DIR) / "tests/mutation/named_faults.txt";
  const std::vector<Candidate> candidates = named(CLEARWAY_SOURCE_DIR, list);
  EXPECT_GE(candidates.size(), 16U);
  for (const Candidate& candidate : candidates)
    EXPECT_NE(candidate.fault.is, candidate.text) << candidate.name();
}

}  // namespace operators_test
}  // namespace clearway::mutation
