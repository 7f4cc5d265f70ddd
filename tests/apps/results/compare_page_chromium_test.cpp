// The page of `clearway compare` in a real browser.

#include <gtest/gtest.h>

#include "tests/apps/chromium.hpp"
#include "tests/apps/run_command.hpp"
#include "tests/worlds/small_suite.hpp"

namespace clearway {
namespace compare_page_chromium_test {

class ComparePageInChromium : public PageInChromium {};

TEST_F(ComparePageInChromium, DrawsEveryPlotAndTableWithoutAnError) {
  TemporaryFolder folder;
  ASSERT_EQ(run_command(
                {"compare", folder.write("small.yaml", small_suite), "--out", folder.file("out"), "--quiet"})
                .status,
            0);
  const std::string html = read_file(folder.file("out/report.html"));
  for (const std::string dark : {"0", "1"}) {
    const std::string dom = open(html, "#dark=" + dark, kNoWebGl);
    EXPECT_EQ(attribute(dom, "ready"), "1");
    EXPECT_EQ(attribute(dom, "errors"), "0") << errors(dom);
    EXPECT_EQ(attribute(dom, "experiments"), "2");
    // times, three against the width, four profiles, costs; none of a single run
    EXPECT_EQ(attribute(dom, "charts"), "9");
    EXPECT_NE(dom.find(">Share solved against beam width<"), std::string::npos);
    EXPECT_NE(dom.find(">Path cost against beam width<"), std::string::npos);
    EXPECT_NE(
        dom.find(
            "Of 6 runs on 3 problems each; bars are intervals at 95 % confidence for problems like these."),
        std::string::npos);
    EXPECT_NE(dom.find("4 / 0 / 6"), std::string::npos);
    EXPECT_NE(dom.find(">search / shortcuts / proofs, %<"), std::string::npos);
    EXPECT_NE(dom.find("aria-label=\"search "), std::string::npos) << "a bar of the CPU";
    EXPECT_NE(dom.find("no shortcuts, proofs "), std::string::npos) << "of a beam";
    EXPECT_NE(dom.find("not certified"), std::string::npos);
    EXPECT_NE(dom.find("What a paper says."), std::string::npos);
    EXPECT_NE(dom.find("The start is not free"), std::string::npos) << "a failed run explains itself";
    EXPECT_NE(dom.find("66.7 (20.8–93.9)"), std::string::npos) << "Wilson's interval of 2 of 3 problems";
    EXPECT_NE(dom.find("Paired comparisons: 6"), std::string::npos);
    EXPECT_NE(dom.find("round/there_and_back/coarse-1"), std::string::npos) << "what --rerun takes";
    std::size_t canvases = 0;
    for (std::size_t at = 0; (at = dom.find("<canvas", at)) != std::string::npos; ++at) ++canvases;
    EXPECT_EQ(canvases, 9U);
    EXPECT_NE(
        dom.find("role=\"img\" aria-label=\"Share solved against beam width: runs, % against beam width k\""),
        std::string::npos);
    for (const char* head : {">length, m<", ">length, rad<", ">shared: length, rad or m<"})
      EXPECT_NE(dom.find(head), std::string::npos) << head;
    EXPECT_EQ(dom.find("The address asks for #"), std::string::npos);
  }
}

TEST_F(ComparePageInChromium, DrawsNothingAgainstAWidthThatNoPlannerHas) {
  TemporaryFolder folder;
  ASSERT_EQ(run_command({"compare", folder.write("small.yaml", small_suite), "--planners", "rrtconnect",
                         "--out", folder.file("out"), "--quiet"})
                .status,
            0);
  const std::string dom = open(read_file(folder.file("out/report.html")), "", kNoWebGl);
  EXPECT_EQ(attribute(dom, "ready"), "1");
  EXPECT_EQ(attribute(dom, "errors"), "0") << errors(dom);
  EXPECT_NE(dom.find("rrtconnect"), std::string::npos);
  const std::string strange = open(read_file(folder.file("out/report.html")), "#drak=1", kNoWebGl);
  EXPECT_NE(strange.find("The address asks for #drak, which this page does not know."), std::string::npos);
  EXPECT_EQ(dom.find("against beam width<"), std::string::npos);
}

}  // namespace compare_page_chromium_test
}  // namespace clearway
