#include "tests/mutation/reach.hpp"

#include <gtest/gtest.h>

#include <fstream>

namespace clearway::mutation {
namespace reach_test {

/// The source with "@" where the probe for the "#" stands; "#" itself is left out.
std::string probed(std::string source) {
  const std::size_t at = source.find('#');
  source.erase(at, 1);
  const std::size_t place = place_of_probe(source, at);
  return place == std::string::npos ? "none" : source.insert(place, "@");
}

TEST(PlaceOfProbe, IsBeforeTheStatementThatHoldsTheFault) {
  EXPECT_EQ(probed("int f(int a) { int b = 1; return a #< b; }"),
            "int f(int a) { int b = 1;@ return a < b; }");
  EXPECT_EQ(probed("int f(int a) { if (a #< 1) { a = 2; } }"), "int f(int a) {@ if (a < 1) { a = 2; } }");
  EXPECT_EQ(probed("int f(int a) { if (a) { a = #2; } }"), "int f(int a) { if (a) {@ a = 2; } }");
  EXPECT_EQ(probed("int f(int a) { g(); a[#2] = h(3); }"), "int f(int a) { g();@ a[2] = h(3); }");
}

TEST(PlaceOfProbe, IsBeforeALoopWhoseHeadHoldsTheFaultOrThatHasNoBraces) {
  EXPECT_EQ(probed("int f() { g(); for (int i = 0; i #< 9; ++i) g(); }"),
            "int f() { g();@ for (int i = 0; i < 9; ++i) g(); }");
  EXPECT_EQ(probed("int f() { g(); for (int i = 0; i < 9; ++i) h(i #+ 1); }"),
            "int f() { g();@ for (int i = 0; i < 9; ++i) h(i + 1); }");
}

TEST(PlaceOfProbe, OfAnElseWithoutBracesIsBeforeItsIf) {
  EXPECT_EQ(probed("int f() { g(); if (a) h(); else k(#1); }"), "int f() { g();@ if (a) h(); else k(1); }");
  EXPECT_EQ(probed("int f() { g(); if (a) { h(); k(); } else if (b #< 1) { k(); } }"),
            "int f() { g();@ if (a) { h(); k(); } else if (b < 1) { k(); } }");
  EXPECT_EQ(probed("int f() { if (a) { h(); } else { k(#1); } }"),
            "int f() { if (a) { h(); } else {@ k(1); } }");
}

TEST(PlaceOfProbe, OfACaseIsBehindItsLabels) {
  EXPECT_EQ(probed("int f() { switch (a) { case E::a: return 1; case E::b: default: return b #< 2; } }"),
            "int f() { switch (a) { case E::a: return 1; case E::b: default:@ return b < 2; } }");
  EXPECT_EQ(probed("int f() { switch (a) { case 1: return 1; case #2: return 2; } }"), "none");
}

TEST(PlaceOfProbe, OfALambdaIsInItsBody) {
  EXPECT_EQ(probed("int f() { g([&](int i) { h(); return i #< 2; }); }"),
            "int f() { g([&](int i) { h();@ return i < 2; }); }");
}

TEST(PlaceOfProbe, IsNowhereOutsideOfBlocks) { EXPECT_EQ(probed("int a = 1; int b = #2;"), "none"); }

TEST(Probe, IsACallWithItsNumber) { EXPECT_EQ(with_probe("{f();}", 1, 7), "{ ::clearway_reached(7);f();}"); }

TEST(Reach, AddsWhatSeveralProgramsWrote) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "clearway_reach_test.txt";
  std::ofstream(file) << "* 0.5 3\nA 1.5 0 2\nB/0 2\n";
  Reach reach;
  reach.read(file);
  std::ofstream(file) << "A 1 7\n";
  reach.read(file);
  std::filesystem::remove(file);
  reach.read(file);
  EXPECT_EQ(reach.suites,
            (std::map<int, std::set<std::string>>{{0, {"A"}}, {2, {"A"}}, {3, {"*"}}, {7, {"A"}}}));
  EXPECT_EQ(reach.times, (std::map<std::string, double>{{"*", 0.5}, {"A", 2.5}, {"B/0", 2.0}}));
}

}  // namespace reach_test
}  // namespace clearway::mutation
