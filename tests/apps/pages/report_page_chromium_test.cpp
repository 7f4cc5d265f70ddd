// The report page in a real browser: Chromium, headless, with software WebGL and with none.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/pages/map_page.hpp"
#include "apps/pages/report_page.hpp"
#include "mapping/files/map_leaves.hpp"
#include "tests/apps/chromium.hpp"
#include "tests/apps/page_reader.hpp"
#include "tests/worlds/sample_page.hpp"
#include "tests/worlds/voxel_scene.hpp"

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
  const int layer = static_cast<int>(std::floor(height / page.resolution)) + kOriginVoxel;
  for (PageVoxels voxels : page.voxels) {
    voxels.cells.sort();
    for (const VoxelBricks::Cube& cube : voxels.cells.cubes()) {
      const int above = layer - VoxelBricks::low_of(cube.code)[2], side = 1 << cube.level;
      if (above < 0 || above >= side) continue;
      cut += cube.bits == VoxelBricks::Cube::full
                 ? static_cast<std::size_t>(side) * static_cast<std::size_t>(side)
                 : static_cast<std::size_t>(
                       std::popcount(voxels.cells.bits(cube)[static_cast<std::size_t>(above)]));
    }
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
      << "a speed over its limit is shown, and marked as bad";
  EXPECT_NE(open(html, "#nowebgl&plan=3&t=1").find("2.92 / 2.92 s"), std::string::npos);
  EXPECT_EQ(attribute(open(html, "#nowebgl&plan=1"), "plots"), "2") << "a plan without time";
}

TEST_F(ReportPageInChromium, ShowsTorquesAgainstTheLimitsOfTheJointsThatHaveOne) {
  ReportPage page = SamplePage::make_timed();
  PagePlan& timed = page.plans[3];
  timed.torques.assign(timed.waypoints.size(), Eigen::VectorXd::Constant(6, 3.0));
  for (Eigen::VectorXd& torques : timed.torques) torques[0] = 1e6;  // of a joint without a limit
  timed.max_torque.assign(6, 12.0);
  timed.max_torque[0] = std::numeric_limits<double>::infinity();
  timed.torques[30][2] = -15.0;
  const std::string html = render_report_page(page);
  const std::string start = open(html, "#nowebgl&plan=3&t=0");
  EXPECT_EQ(attribute(start, "errors"), "0") << errors(start);
  EXPECT_EQ(attribute(start, "plots"), "5") << "joints, separation, speeds, accelerations, torques";
  EXPECT_NE(start.find("<span id=\"torque-now\" class=\"now\">" + timed.joints[1] + " 3 N m, 25 %"),
            std::string::npos);
  EXPECT_NE(open(html, "#nowebgl&plan=3&t=" + std::to_string(1.5 / 2.92))
                .find("<span id=\"torque-now\" class=\"now bad\">" + timed.joints[2] + " -15 N m, 125 %"),
            std::string::npos);
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

/// A page whose frames come from a timer, `frame_ms` apart, as where drawing takes so long (a browser that
/// only dumps the document draws none). Plays a second, and says by how much the motion is behind the clock
/// then.
std::string playing(std::string html, int frame_ms) {
  html.insert(
      html.find("<script type=\"application/json\""),
      "<script>window.requestAnimationFrame = (frame) => setTimeout(() => frame(performance.now()), " +
          std::to_string(frame_ms) +
          ");"
          "const shown = () => document.getElementById('time-text').textContent;"
          "const wait = setInterval(() => { if (!document.body.dataset.ready) return; clearInterval(wait);"
          "document.getElementById('play').click(); const begin = performance.now();"
          "const look = (now) => { if (now - begin < 1400) return requestAnimationFrame(look);"
          "document.body.dataset.after = ((now - begin) / 1000 - parseFloat(shown())).toFixed(3); };"
          "requestAnimationFrame(look); }, 50);</script>");
  return html;
}

TEST_F(ReportPageInChromium, PlaysAPlanWithTimeAsFastAsTheRobotMovesHoweverSlowDrawingIs) {
  for (const int frame_ms : {16, 350}) {
    const std::string dom =
        open(playing(render_report_page(SamplePage::make_timed()), frame_ms), "#nowebgl&plan=3");
    EXPECT_EQ(attribute(dom, "errors"), "0") << errors(dom);
    ASSERT_NE(attribute(dom, "after"), "") << "it never played";
    // The clock of the motion starts with the first frame.
    EXPECT_NEAR(std::stod(attribute(dom, "after")), frame_ms / 1000.0, 0.15 + frame_ms / 1000.0)
        << "wall time less time of the motion, s, frames of " << frame_ms << " ms";
  }
}

TEST_F(ReportPageInChromium, OpensOnTheFirstPlanThatArrives) {
  ReportPage page = SamplePage::make();
  std::rotate(page.plans.begin(), page.plans.begin() + 2, page.plans.end());  // the failed one first
  ASSERT_NE(page.plans.front().status, "solved");
  const std::string html = render_report_page(page);
  EXPECT_EQ(attribute(open(html, "#nowebgl"), "plots"), "2");
  EXPECT_EQ(attribute(open(html, "#nowebgl&plan=0"), "plots"), "0") << "but for the one that is asked for";
}

TEST_F(ReportPageInChromium, OpensAsThePageAsksUnlessTheAddressAsksOtherwise) {
  ReportPage page = SamplePage::make();
  const std::string plain = open(render_report_page(page), "#cut=z:0.3");
  page.opens = "cut=z:0.3&view=60,50,1.4";
  page.subtitle = "What is to be seen.";
  const std::string dom = open(render_report_page(page));
  EXPECT_EQ(attribute(dom, "errors"), "0") << errors(dom);
  EXPECT_GT(std::stoi("0" + attribute(dom, "slice")), 0);
  EXPECT_EQ(attribute(dom, "slice"), attribute(plain, "slice"));
  EXPECT_NE(dom.find("What is to be seen."), std::string::npos);
  EXPECT_EQ(attribute(open(render_report_page(page), "#cut="), "slice"), "") << "no plane";
}

TEST_F(ReportPageInChromium, CutsAlongAllAxesAtOnce) {
  const std::string html = render_report_page(SamplePage::make());
  const std::string layers = "#layers=painted,occupied,conflict,seen_free&cut=";
  int sum = 0;
  for (const char* cut : {"x:0.1", "-y:0.2", "z:0.3"}) {
    const std::string count = attribute(open(html, layers + cut), "slice");
    ASSERT_NE(count, "");
    EXPECT_GT(std::stoi(count), 0);
    sum += std::stoi(count);
  }
  const std::string dom = open(html, layers + "x:0.1,-y:0.2,z:0.3");
  EXPECT_EQ(attribute(dom, "errors"), "0") << errors(dom);
  EXPECT_EQ(attribute(dom, "slice"), std::to_string(sum));
}

TEST_F(ReportPageInChromium, ShowsSlicesAsPicturesWhereThereIsNoWebGl) {
  const std::string dom = open(render_report_page(SamplePage::make()), "#nowebgl");
  EXPECT_EQ(attribute(dom, "errors"), "0") << errors(dom);
  EXPECT_NE(dom.find("<canvas class=\"flat-slice\" role=\"img\""), std::string::npos);
  EXPECT_NE(dom.find("aria-label=\"Slice of the map at z = "), std::string::npos);
  ASSERT_NE(attribute(dom, "slice"), "");
  EXPECT_GT(std::stoi(attribute(dom, "slice")), 100);
}

TEST_F(ReportPageInChromium, TellsOfWordsOfItsAddressThatItDoesNotKnow) {
  const std::string html = render_report_page(SamplePage::make());
  const std::string dom = open(html, "?opne=1#nowebgl&plna=1&tables");
  EXPECT_EQ(attribute(dom, "errors"), "0") << errors(dom);
  EXPECT_NE(
      dom.find(
          "The address asks for #plna, ?opne, which this page does not know. Expected behind '#': plan, t, "),
      std::string::npos);
  EXPECT_EQ(open(html, "#nowebgl&plan=1").find("The address asks for #"), std::string::npos);
}

TEST_F(ReportPageInChromium, NamesItsPicturesAndTheColumnsOfItsTables) {
  const std::string dom = open(render_report_page(SamplePage::make()), "#nowebgl&plan=1");
  EXPECT_NE(dom.find("role=\"img\" aria-label=\"Joint profiles against waypoints: "), std::string::npos);
  EXPECT_NE(dom.find("<th scope=\"col\""), std::string::npos);
  for (std::size_t at = 0; (at = dom.find("<th", at)) != std::string::npos; ++at)
    if (dom[at + 3] == ' ' || dom[at + 3] == '>') {
      const std::string tag = dom.substr(at, dom.find('>', at) - at);
      EXPECT_NE(tag.find("scope=\"col\""), std::string::npos) << tag;
    }
}

/// 64 x 64 columns of voxels, each of its own: more surface than a slow browser can turn.
TEST_F(ReportPageInChromium, HasACoarserSetForTurningWhatIsMuch) {
  ReportPage page;
  page.title = "columns";
  page.resolution = 0.05;
  PageVoxels occupied{"occupied", 0.05};
  for (int x = 0; x < 64; ++x)
    for (int y = 0; y < 64; ++y)
      for (int z = 0; z < (x + y) % 2 * 20 + 1; ++z)
        occupied.add(0.05 * Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5), 0.05);
  page.voxels = {occupied};
  const PageReader reader(render_report_page(page));
  const auto& set = reader.page["voxels"][0];
  EXPECT_EQ(set["cell"], 1);
  ASSERT_TRUE(set.contains("turned"));
  EXPECT_GT(set["turned"]["cell"].get<int>(), 1);
  EXPECT_LE(set["turned"]["columns"][0]["count"].get<std::size_t>(), 40'000U);
  const std::string dom = open(render_report_page(page));
  EXPECT_EQ(attribute(dom, "errors"), "0") << errors(dom);
  EXPECT_EQ(attribute(dom, "faces"), std::to_string(set["faces"].get<std::size_t>()));
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
         "inner.getElementById('recording').open = true;"
         "for (const [id, value] of [['path-color', 'phase'], ['voxel-color', 'volume']]) {"
         "const menu = inner.getElementById(id); menu.value = value; menu.dispatchEvent(new "
         "Event('change')); }"
         "setTimeout(() => { const root = inner.documentElement;"
         "Object.assign(document.body.dataset, inner.body.dataset, {images: inner.images.length,"
         " overflow: root.scrollWidth - root.clientWidth});"
         "errors.textContent = inner.getElementById('errors').textContent; }, 300); }, 100);</script></body>";
}

TEST_F(ReportPageInChromium, FitsAPhoneAndTreatsHostileTextAsText) {
  ReportPage page = SamplePage::make_recorded();
  page.recording.refusals[0].reason = page.volume_labels[0] = page.plans[0].phase_names[1] =
      "<img src=x onerror=alert(1)>" + std::string(80, 'W');
  page.title = page.plans[0].name = page.plans[0].explanation = page.tables[0].rows[0][0] = page.warnings[0] =
      "</script><img src=x onerror=alert(2)>" + std::string(80, 'W');
  const std::string dom = open(in_a_phone(render_report_page(page)));
  EXPECT_EQ(attribute(dom, "errors"), "0") << errors(dom);
  EXPECT_EQ(attribute(dom, "width"), "390");
  EXPECT_EQ(attribute(dom, "overflow"), "0") << "nothing is wider than the window";
  EXPECT_EQ(attribute(dom, "images"), "0");
  EXPECT_EQ(attribute(dom, "path"), "phase");
  EXPECT_EQ(attribute(dom, "color"), "volume");
  EXPECT_NE(attribute(dom, "recording"), "");
}

TEST_F(ReportPageInChromium, ColoursVoxelsAndThePathAndSaysByWhat) {
  const std::string html = render_report_page(SamplePage::make_recorded());
  const auto legend_has = [](const std::string& dom, const std::string& text) {
    const std::size_t at = dom.find("class=\"legend\"");
    return at != std::string::npos && dom.find(text, at) != std::string::npos;
  };
  const std::string age = open(html, "#color=age&path=phase&cut=z:0.3");
  EXPECT_EQ(attribute(age, "errors"), "0") << errors(age);
  EXPECT_EQ(attribute(age, "color"), "age");
  EXPECT_EQ(attribute(age, "path"), "phase");
  EXPECT_EQ(attribute(age, "strip"), "phase") << "under the curves, too";
  EXPECT_TRUE(legend_has(age, "60 s")) << "how old the oldest is";
  EXPECT_TRUE(legend_has(age, "boundary: end effector near what blocks it"));
  const std::string height = open(html, "#color=height&path=step");
  EXPECT_EQ(attribute(height, "errors"), "0") << errors(height);
  EXPECT_EQ(attribute(height, "color"), "height");
  EXPECT_TRUE(legend_has(height, "1.20 m"));
  EXPECT_TRUE(legend_has(height, "<span>59</span>")) << "the last search step";
}

/// The page with a click in the middle of its view, once it is ready.
std::string clicked(std::string html) {
  html.insert(html.find("<script type=\"application/json\""),
              "<script>const wait = setInterval(() => { if (!document.body.dataset.ready) return;"
              "clearInterval(wait); const canvas = document.querySelector('#canvas-box canvas');"
              "const box = canvas.getBoundingClientRect();"
              "for (const type of ['pointerdown', 'pointerup']) canvas.dispatchEvent(new PointerEvent(type, "
              "{isPrimary: true, button: 0, pointerId: 1, clientX: box.left + box.width / 2, "
              "clientY: box.top + box.height / 2})); }, 50);</script>");
  return html;
}

/// Seen from above, what lies in the middle of the view is the floor.
TEST_F(ReportPageInChromium, AnswersAClickOnAVoxelAsInspectDoes) {
  const std::string html = clicked(render_report_page(SamplePage::make_recorded()));
  const std::string dom = open(html, "#view=top&fit=all&layers=occupied");
  EXPECT_EQ(attribute(dom, "errors"), "0") << errors(dom);
  EXPECT_EQ(attribute(dom, "recording"), "") << "closed unless asked for";
  const std::size_t at = dom.find("id=\"voxel-answer\"");
  ASSERT_NE(at, std::string::npos);
  const std::string answer = dom.substr(at, dom.find("recording", at) - at);
  for (const char* part :
       {"<dd>occupied</dd>", "In the cube of 160 mm that holds it:", "log-odds ≈ 1.5, probability 0.82",
        "s before the newest look", "clearway inspect 'a map'\\''s folder' --at="})
    EXPECT_NE(answer.find(part), std::string::npos) << part << "\n" << answer;
}

TEST_F(ReportPageInChromium, ShowsTheRecordingInTime) {
  const std::string html = render_report_page(SamplePage::make_recorded());
  const std::string early = open(html, "#recording=0.4");
  EXPECT_EQ(attribute(early, "errors"), "0") << errors(early);
  EXPECT_EQ(attribute(early, "recording"), "4.00");
  EXPECT_EQ(attribute(early, "painted"), "21") << "balls 0 to 20 came by 4 s";
  EXPECT_NE(early.find("Refused, 3 images: probe not seen (No tag of the probe was found.)"),
            std::string::npos);
  EXPECT_NE(early.find("0 of 1 conflicts"), std::string::npos);
  const std::string late = open(html, "#recording=0.7");
  EXPECT_EQ(attribute(late, "painted"), "36");
  EXPECT_NE(late.find("1 of 1 conflicts"), std::string::npos);
  EXPECT_NE(late.find("3 tags"), std::string::npos);
}

/// In a closed room nothing of what differs is seen from outside; without a lid it is.
TEST_F(ReportPageInChromium, OpensWithACutWhereWallsHideWhatItIsAbout) {
  const auto room = [](bool has_lid, bool has_box) {
    VoxelScene scene{0.05, {box_of(-1.0, -1.0, 0.0, 1.0, 1.0, 0.05)}, {}, {}};
    for (const double side : {-1.0, 0.95}) {
      scene.occupied.push_back(box_of(side, -1.0, 0.0, side + 0.05, 1.0, 0.5));
      scene.occupied.push_back(box_of(-1.0, side, 0.0, 1.0, side + 0.05, 0.5));
    }
    if (has_lid) scene.occupied.push_back(box_of(-1.0, -1.0, 0.5, 1.0, 1.0, 0.55));
    if (has_box) scene.occupied.push_back(box_of(-0.2, 0.1, 0.05, 0.2, 0.4, 0.25));
    return MapLeaves(scene.snapshot());
  };
  for (const bool has_lid : {false, true}) {
    const MapLeaves difference =
        MapLeaves::difference(room(has_lid, false).about(), room(has_lid, true).about());
    const std::string page = difference_page(difference, "from a to b");
    const std::string dom = open(page);
    EXPECT_EQ(attribute(dom, "errors"), "0") << errors(dom);
    EXPECT_EQ(attribute(dom, "slice").empty(), !has_lid);
    if (!has_lid) continue;
    EXPECT_EQ(attribute(open(page, "#picture"), "slice"),
              "");  // whoever asks for a picture says what it cuts
  }
}

/// What differs, but is blocked in neither or in both, is hidden otherwise, because it may be much.
TEST_F(ReportPageInChromium, ShowsOtherChangesWhereNothingElseDiffers) {
  const auto room = [](double radius, bool has_box) {
    VoxelScene scene{0.05, {box_of(-1.0, -1.0, 0.0, 1.0, 1.0, 0.05)}, {{{-0.5, 0.0, 0.5}, radius}}, {"tool"}};
    if (has_box) scene.occupied.push_back(box_of(-0.2, 0.1, 0.05, 0.2, 0.4, 0.25));
    return MapLeaves(scene.snapshot());
  };
  const auto page = [&](double radius, bool has_box) {
    return difference_page(MapLeaves::difference(room(0.1, false).about(), room(radius, has_box).about()),
                           "from a to b");
  };
  const std::string layers = "layers=conflict,painted,occupied,seen_free";
  EXPECT_NE(page(0.2, false).find(layers), std::string::npos);
  EXPECT_EQ(page(0.2, true).find(layers), std::string::npos);
  const std::string dom = open(page(0.2, false));
  EXPECT_EQ(attribute(dom, "errors"), "0") << errors(dom);
}

/// Of isolated free voxels a page that draws larger cubes shows none: their set is empty.
TEST_F(ReportPageInChromium, CutsWhereAStateIsTooFineToBeDrawn) {
  ReportPage page = SamplePage::make();
  PageVoxels fine{"seen_free", page.resolution};
  for (int x = 0; x < 8; ++x)
    for (int y = 0; y < 8; ++y)
      fine.add(page.resolution * Eigen::Vector3d(2 * x + 0.5, 2 * y + 0.5, 0.5), page.resolution);
  fine.cells.sort();
  fine.cells.coarsen(false);
  std::erase_if(page.voxels, [](const PageVoxels& voxels) { return voxels.state == "seen_free"; });
  page.voxels.push_back(fine);
  const std::string html = render_report_page(page);
  for (const char* address : {"#cut=z:0.1&layers=seen_free", "#nowebgl"}) {
    const std::string dom = open(html, address);
    EXPECT_EQ(attribute(dom, "ready"), "1") << address;
    EXPECT_EQ(attribute(dom, "errors"), "0") << address << errors(dom);
  }
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
