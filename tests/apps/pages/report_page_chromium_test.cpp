// The report page in a real browser: Chromium, headless, with software WebGL and with none.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/pages/report_page.hpp"
#include "tests/apps/chromium.hpp"
#include "tests/worlds/sample_page.hpp"

namespace clearway {
namespace report_page_chromium_test {

class ReportPageInChromium : public PageInChromium {};

TEST_F(ReportPageInChromium, DrawsEveryFacePlanAndPlotWithoutAnError) {
  const ReportPage page = SamplePage::make();
  std::size_t quads = 0;
  for (const PageVoxels& voxels : page.voxels) quads += exposed_faces(voxels).size();
  const std::string dom = open(render_report_page(page), "#plan=1&t=0.5&cut=z:0.3&dark=1");
  EXPECT_EQ(attribute(dom, "ready"), "1");
  EXPECT_EQ(attribute(dom, "errors"), "0") << errors(dom);
  EXPECT_EQ(attribute(dom, "view"), "3d");
  EXPECT_EQ(attribute(dom, "quads"), std::to_string(quads));
  EXPECT_EQ(attribute(dom, "plans"), "3");
  EXPECT_EQ(attribute(dom, "plots"), "2");
  EXPECT_EQ(attribute(dom, "balls"), std::to_string(page.spheres.size()));
  EXPECT_NE(attribute(dom, "frames"), "");
  EXPECT_NE(dom.find("no path"), std::string::npos) << "the failed plan is in sight";
  EXPECT_NE(dom.find("120.5 / 240"), std::string::npos) << "the slider stands where the address says";
}

TEST_F(ReportPageInChromium, SlicesThroughExactlyTheVoxelsOfOneLayer) {
  const ReportPage page = SamplePage::make();
  const double height = 15.5 * page.resolution;
  std::size_t cut = 0;
  for (const PageVoxels& voxels : page.voxels)
    for (std::size_t i = 0; i < voxels.centers.size(); ++i) {
      const double side = std::round(static_cast<double>(voxels.sizes[i]) / page.resolution);
      if (std::abs(static_cast<double>(voxels.centers[i].z()) - height) < 0.5 * side * page.resolution)
        cut += static_cast<std::size_t>(side * side);
    }
  const std::string dom = open(render_report_page(page),
                               "#layers=painted,occupied,conflict,seen_free&cut=z:" + std::to_string(height));
  EXPECT_EQ(attribute(dom, "errors"), "0") << errors(dom);
  EXPECT_EQ(attribute(dom, "slice"), std::to_string(cut));
}

TEST_F(ReportPageInChromium, ShowsTheFailedPlansExplanation) {
  const ReportPage page = SamplePage::make();
  const std::string dom = open(render_report_page(page), "#plan=2");
  EXPECT_EQ(attribute(dom, "errors"), "0") << errors(dom);
  EXPECT_EQ(attribute(dom, "plots"), "0");
  EXPECT_NE(dom.find("<p class=\"explanation failed\">The search ended after 412 steps"), std::string::npos);
}

TEST_F(ReportPageInChromium, KeepsPlotsAndTablesWhenThereIsNoWebGl) {
  const std::string dom = open(render_report_page(SamplePage::make()), "", kNoWebGl);
  EXPECT_EQ(attribute(dom, "ready"), "1");
  EXPECT_EQ(attribute(dom, "view"), "none");
  EXPECT_EQ(attribute(dom, "plots"), "2");
  EXPECT_NE(dom.find("offers no WebGL 2"), std::string::npos);
  EXPECT_NE(dom.find("ambiguous pose"), std::string::npos);
}

TEST_F(ReportPageInChromium, KeepsTextAndTablesWhenTheArraysCannotBeUnpacked) {
  std::string html = render_report_page(SamplePage::make());
  html.insert(html.find("<script type=\"application/json\""),
              "<script>delete window.DecompressionStream</script>");
  const std::string dom = open(html, "", kNoWebGl);
  EXPECT_EQ(attribute(dom, "ready"), "1");
  EXPECT_EQ(attribute(dom, "errors"), "0") << errors(dom);
  EXPECT_NE(dom.find("too old to unpack"), std::string::npos);
  EXPECT_NE(dom.find("ambiguous pose"), std::string::npos);
}

TEST_F(ReportPageInChromium, ShowsAPlanInTimeWithSpeedsAndAccelerationsAgainstTheirLimits) {
  const std::string html = render_report_page(SamplePage::make_timed());
  const std::string half = open(html, "#nowebgl&plan=3&t=0.5");
  EXPECT_EQ(attribute(half, "errors"), "0") << errors(half);
  EXPECT_EQ(attribute(half, "plots"), "4") << "joints, separation, speeds, accelerations";
  EXPECT_NE(half.find("1.46 / 2.92 s"), std::string::npos) << "the slider is in seconds";
  EXPECT_NE(half.find("d_s 0.0200 m"), std::string::npos);
  const std::string fast = open(html, "#nowebgl&plan=3&t=" + std::to_string(1.5 / 2.92));
  EXPECT_NE(fast.find("<span id=\"speed-now\" class=\"now bad\">shoulder -1.8 rad/s, 120 %"),
            std::string::npos)
      << "a speed over its limit is told, and told to be bad";
  EXPECT_NE(open(html, "#nowebgl&plan=3&t=1").find("2.92 / 2.92 s"), std::string::npos);
  EXPECT_EQ(attribute(open(html, "#nowebgl&plan=1"), "plots"), "2") << "a plan without time";
}

TEST_F(ReportPageInChromium, ShowsWhatWasSeenAnewAtEachTimeAndHowOldTheMapWas) {
  const std::string html = render_report_page(SamplePage::make_sensed());
  const auto counted = [](const std::string& dom, const std::string& count) {
    return dom.find("seen anew</span><span class=\"count\">" + count + "</span>") != std::string::npos;
  };
  const std::string half = open(html, "#plan=3&t=0.5");  // 1.46 s, the 30th waypoint
  EXPECT_EQ(attribute(half, "errors"), "0") << errors(half);
  EXPECT_TRUE(counted(half, "3"));
  EXPECT_NE(half.find("map 300 ms old"), std::string::npos);
  EXPECT_NE(half.find("true, of what is sensed"), std::string::npos);
  EXPECT_TRUE(counted(open(html, "#plan=3&t=0"), "1"));
  EXPECT_TRUE(counted(open(html, "#plan=3&t=1"), "0"));
  const std::string other = open(html, "#plan=1");
  EXPECT_NE(other.find("<output id=\"map-age\" class=\"map-age\" hidden"), std::string::npos);
}

/// Frames come from a timer, since a browser that only dumps the document draws none.
TEST_F(ReportPageInChromium, PlaysAPlanWithTimeAsFastAsTheRobotMoves) {
  std::string html = render_report_page(SamplePage::make_timed());
  html.insert(
      html.find("<script type=\"application/json\""),
      "<script>window.requestAnimationFrame = (frame) => setTimeout(() => frame(performance.now()), 16);"
      "const shown = () => document.getElementById('time-text').textContent;"
      "const wait = setInterval(() => { if (!document.body.dataset.ready) return; clearInterval(wait);"
      "document.getElementById('play').click(); const begin = performance.now();"
      "const look = (now) => { if (now - begin < 1000) return requestAnimationFrame(look);"
      "document.body.dataset.after = ((now - begin) / 1000 - parseFloat(shown())).toFixed(3); };"
      "requestAnimationFrame(look); }, 50);</script>");
  const std::string dom = open(html, "#plan=3");
  EXPECT_EQ(attribute(dom, "errors"), "0") << errors(dom);
  ASSERT_NE(attribute(dom, "after"), "") << "it never played";
  EXPECT_NEAR(std::stod(attribute(dom, "after")), 0.0, 0.15) << "wall time less time of the motion, s";
}

/// A page that holds `html` in a frame as wide as a phone (headless Chromium's own windows are not narrower
/// than 500 pixels) and, once that is ready, takes over what its body says.
std::string in_a_phone(const std::string& html) {
  std::string quoted = nlohmann::json(html).dump();
  for (std::size_t at = 0; (at = quoted.find('<', at)) != std::string::npos; at += 6)
    quoted.replace(at, 1, "\\u003c");
  return "<!doctype html><body><iframe id=phone width=390 height=844></iframe><pre "
         "id=\"errors\"></pre><script>"
         "phone.srcdoc = " +
         quoted +
         ";"
         "const wait = setInterval(() => { const inner = phone.contentDocument;"
         "if (!inner?.body?.dataset.ready) return; clearInterval(wait);"
         "Object.assign(document.body.dataset, inner.body.dataset, {images: inner.images.length});"
         "errors.textContent = inner.getElementById('errors').textContent; }, 100);</script></body>";
}

TEST_F(ReportPageInChromium, FitsAPhoneAndTreatsHostileTextAsText) {
  ReportPage page = SamplePage::make();
  page.title = page.plans[0].name = page.plans[0].explanation = page.tables[0].rows[0][0] = page.warnings[0] =
      "</script><img src=x onerror=alert(2)>" + std::string(80, 'W');
  const std::string dom = open(in_a_phone(render_report_page(page)));
  EXPECT_EQ(attribute(dom, "errors"), "0") << errors(dom);
  EXPECT_EQ(attribute(dom, "width"), "390");
  EXPECT_EQ(attribute(dom, "overflow"), "0") << "nothing is wider than the window";
  EXPECT_EQ(attribute(dom, "images"), "0");
}

TEST_F(ReportPageInChromium, OpensAnEmptyReport) {
  ReportPage page;
  page.title = "nothing yet";
  const std::string dom = open(render_report_page(page));
  EXPECT_EQ(attribute(dom, "ready"), "1");
  EXPECT_EQ(attribute(dom, "errors"), "0") << errors(dom);
}

}  // namespace report_page_chromium_test
}  // namespace clearway
