#include "apps/pages/report_page.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tests/apps/page_reader.hpp"
#include "tests/worlds/sample_page.hpp"

namespace clearway {
namespace report_page_test {

using nlohmann::json;

/// Undoes the page's differences between rows.
std::vector<VoxelQuad> quads_of(const PageReader& reader, const json& set) {
  std::array<std::vector<std::uint16_t>, 5> columns;
  for (std::size_t c = 0; c < 5; ++c) {
    columns[c] = reader.array<std::uint16_t>(set["columns"][c]);
    for (std::size_t i = 1; i < columns[c].size(); ++i)
      columns[c][i] = static_cast<std::uint16_t>(columns[c][i] + columns[c][i - 1]);
  }
  std::vector<VoxelQuad> quads;
  for (std::uint16_t direction = 0; direction < 6; ++direction)
    for (std::size_t k = set["directions"][direction]; k > 0; --k) {
      const std::size_t i = quads.size();
      quads.push_back(
          {direction, columns[0][i], columns[1][i], columns[2][i], columns[3][i] + 1U, columns[4][i] + 1U});
    }
  return quads;
}

/// True when the bytes are UTF-8 (RFC 3629), up to the largest code point and without surrogates.
bool is_utf8(const std::string& text) {
  return json(text).dump(-1, ' ', false, json::error_handler_t::ignore) ==
         json(text).dump(-1, ' ', false, json::error_handler_t::replace);
}

std::string in_lower_case(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

/// True when `= "http...` or `= "//...` follows at `at`, with or without the quote and the spaces.
bool gives_an_address(const std::string& html, std::size_t at) {
  at = html.find_first_not_of(" \t\n", at);
  if (at == std::string::npos || html[at] != '=') return false;
  at = html.find_first_not_of(" \t\n\"'`", at + 1);
  return at != std::string::npos && (html.compare(at, 4, "http") == 0 || html.compare(at, 2, "//") == 0);
}

TEST(ReportPage, GivesBackTheVoxelSurfacesItWasGiven) {
  const ReportPage page = SamplePage::make();
  const PageReader reader(render_report_page(page));
  ASSERT_EQ(reader.page["voxels"].size(), page.voxels.size());
  for (std::size_t i = 0; i < page.voxels.size(); ++i) {
    const json& set = reader.page["voxels"][i];
    EXPECT_EQ(set["state"], page.voxels[i].state);
    EXPECT_EQ(set["count"], page.voxels[i].count);
    EXPECT_EQ(quads_of(reader, set), exposed_faces(page.voxels[i]));
  }
}

TEST(ReportPage, GivesBackSpheresPathsPosesAndClearances) {
  const ReportPage page = SamplePage::make();
  const PageReader reader(render_report_page(page));
  const auto spheres = reader.array<float>(reader.page["balls"]);
  ASSERT_EQ(spheres.size(), page.spheres.size() * 5);
  EXPECT_FLOAT_EQ(spheres[5 * 7 + 3], static_cast<float>(page.spheres[7].radius));
  const PagePlan& plan = page.plans[1];
  const json& shown = reader.page["plans"][1];
  const auto values = reader.array<float>(shown["values"]);
  const auto poses = reader.array<float>(shown["poses"]);
  const auto clearance = reader.array<float>(shown["clearance"]);
  for (std::size_t i = 0; i < plan.waypoints.size(); ++i) {
    for (std::size_t j = 0; j < 6; ++j)
      EXPECT_FLOAT_EQ(values[j * plan.waypoints.size() + i],
                      static_cast<float>(plan.waypoints[i][static_cast<int>(j)]));
    for (std::size_t link = 0; link < 6; ++link) {
      const float* pose = &poses[(i * 6 + link) * 7];
      const Eigen::Quaternionf rotation(pose[6], pose[3], pose[4], pose[5]);
      const Eigen::Isometry3f expected = plan.link_poses[i][link].cast<float>();
      EXPECT_TRUE(rotation.toRotationMatrix().isApprox(expected.linear(), 1e-5F));
      EXPECT_TRUE(Eigen::Vector3f(pose[0], pose[1], pose[2]).isApprox(expected.translation(), 1e-5F) ||
                  expected.translation().norm() < 1e-6F);
    }
    if (std::isnan(plan.clearance[i]))
      EXPECT_TRUE(std::isnan(clearance[i]));
    else
      EXPECT_FLOAT_EQ(clearance[i], static_cast<float>(plan.clearance[i]));
  }
}

TEST(ReportPage, GivesBackTheSpheresToPaintForAPlan) {
  ReportPage page = SamplePage::make();
  page.plans[2].to_paint = {{Eigen::Vector3d(0.25, -0.5, 1.0), 0.125}, {Eigen::Vector3d(1, 2, 3), 0.5}};
  const PageReader reader(render_report_page(page));
  EXPECT_TRUE(reader.array<float>(reader.page["plans"][0]["paint"]).empty());
  const auto spheres = reader.array<float>(reader.page["plans"][2]["paint"]);
  ASSERT_EQ(spheres.size(), 10u);
  EXPECT_EQ((std::vector<float>{spheres.begin(), spheres.begin() + 4}),
            (std::vector<float>{0.25F, -0.5F, 1.0F, 0.125F}));
  EXPECT_EQ(spheres[8], 0.5F);
}

TEST(ReportPage, GivesBackWhatWasSeenAnewChangeByChangeAndTheMapsAge) {
  const ReportPage page = SamplePage::make_sensed();
  const PageReader reader(render_report_page(page));
  const PagePlan& given = page.plans.back();
  const json& plan = reader.page["plans"].back();
  EXPECT_EQ(reader.array<float>(plan["seen"]["times"]), (std::vector<float>{0.0F, 1.0F, 2.0F}));
  const auto counts = reader.array<std::uint32_t>(plan["seen"]["counts"]);
  ASSERT_EQ(counts, (std::vector<std::uint32_t>{1, 3, 0}));
  const auto cells = reader.array<std::uint16_t>(plan["seen"]["cells"]);
  ASSERT_EQ(cells.size(), 12U);
  std::size_t start = 0;
  for (std::size_t change = 0; change < counts.size(); start += 3 * counts[change++]) {
    for (std::size_t i = 0; i < counts[change]; ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double middle = (cells[start + axis * counts[change] + i] - kOriginVoxel + 0.5) * 0.04;
        EXPECT_NEAR(middle, given.seen[change].centers[i][static_cast<Eigen::Index>(axis)], 0.0201);
      }
    }
  }
  const auto ages = reader.array<float>(plan["mapAge"]);
  const auto truths = reader.array<float>(plan["trueSeparation"]);
  ASSERT_EQ(ages.size(), given.waypoints.size());
  ASSERT_EQ(truths.size(), given.waypoints.size());
  EXPECT_FLOAT_EQ(ages[3], 0.25F);
  EXPECT_FLOAT_EQ(truths[7], static_cast<float>(given.clearance[7] + 0.01));
  EXPECT_EQ(reader.page["plans"][0]["seen"]["times"]["count"], 0);
}

TEST(ReportPage, OffersTheReportByteForByte) {
  ReportPage page = SamplePage::make();
  page.json = "{\"a\": \"</script><!-- \xc3\xa9\"}\n";
  const PageReader reader(render_report_page(page));
  const auto bytes = reader.array<char>(reader.page["report"]);
  EXPECT_EQ(std::string(bytes.begin(), bytes.end()), page.json);
}

TEST(ReportPage, KeepsHostileTextInsideItsStrings) {
  const std::string hostile =
      "</script><script>alert(1)</script><!--<img src=x onerror=alert(2)>\xe2\x80\xa8\"'&";
  ReportPage page = SamplePage::make();
  page.title = page.subtitle = page.plans[0].name = page.plans[0].explanation = hostile;
  page.warnings = {hostile};
  page.tables[0].rows[0][0] = page.volume_labels[0] = page.robot[0].part = hostile;
  const std::string html = render_report_page(page);
  EXPECT_EQ(html.find("<script>alert"), std::string::npos);
  EXPECT_EQ(html.find("<img src=x"), std::string::npos);
  const PageReader reader(html);
  EXPECT_EQ(reader.page["plans"][0]["explanation"], hostile);
  EXPECT_EQ(reader.page["tables"][0]["rows"][0][0], hostile);
  EXPECT_NE(html.find("<title>&lt;/script>&lt;script>alert(1)"), std::string::npos);
}

TEST(ReportPage, IsUtf8EvenWhenItsTextIsNot) {
  ReportPage page = SamplePage::make();
  EXPECT_TRUE(is_utf8(render_report_page(page)));
  page.title = "caf\xe9";
  page.warnings = {"\xff\xfe", "half \xe2\x82"};
  EXPECT_TRUE(is_utf8(render_report_page(page)));
}

TEST(ReportPage, HasNothingThatCouldAskTheNetwork) {
  const std::string html = render_report_page(SamplePage::make());
  const std::string lower = in_lower_case(html);
  for (const std::string name : {"src", "href", "action", "srcset", "poster", "data"})
    for (std::size_t at = lower.find(name); at != std::string::npos; at = lower.find(name, at + 1))
      EXPECT_FALSE(gives_an_address(lower, at + name.size())) << html.substr(at, 60);
  for (const char* call : {"fetch(", "XMLHttpRequest", "sendBeacon", "new WebSocket", "EventSource",
                           "import(", "importScripts", "new Worker", "@import", "url(http", "url(//"})
    EXPECT_EQ(html.find(call), std::string::npos) << call;
  EXPECT_NE(html.find("Content-Security-Policy\" content=\"default-src 'none'"), std::string::npos);
}

TEST(ReportPage, CarriesTheLicencesOfWhatItContains) {
  const std::string html = render_report_page({});
  for (const char* owner : {"three.js authors", "Leon Sorokin"})
    EXPECT_NE(html.find(owner), std::string::npos) << owner;
}

TEST(ReportPage, OfEqualReportsIsEqual) {
  EXPECT_EQ(render_report_page(SamplePage::make()), render_report_page(SamplePage::make()));
}

TEST(ReportPage, RefusesSizesAndIndicesThatDisagreeAndNamesTheField) {
  const auto refused = [](auto change, const std::string& field) {
    ReportPage page = SamplePage::make();
    change(page);
    try {
      render_report_page(page);
      ADD_FAILURE() << field << " was accepted";
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(field), std::string::npos) << error.what();
    }
  };
  refused([](ReportPage& p) { p.plans[0].clearance.pop_back(); }, "clearance");
  refused([](ReportPage& p) { p.plans[0].link_poses.pop_back(); }, "link_poses");
  refused([](ReportPage& p) { p.plans[1].link_poses[3].pop_back(); }, "link_poses");
  refused([](ReportPage& p) { p.plans[0].waypoints[2].resize(3); }, "waypoints");
  const auto timed = [](ReportPage& p) -> PagePlan& {
    p = SamplePage::make_timed();
    return p.plans[3];
  };
  refused([&](ReportPage& p) { timed(p).speeds.pop_back(); }, "speeds");
  refused([&](ReportPage& p) { timed(p).accelerations[4].resize(5); }, "accelerations");
  refused([&](ReportPage& p) { timed(p).max_speed.clear(); }, "max_speed");
  refused([&](ReportPage& p) { timed(p).max_jerk.assign(6, 1.0); }, "jerks");
  refused([&](ReportPage& p) { timed(p).max_torque.assign(6, 1.0); }, "torques");
  refused(
      [&](ReportPage& p) {
        PagePlan& plan = timed(p);
        plan.torques.assign(plan.waypoints.size(), Eigen::VectorXd::Zero(6));
        plan.max_torque.assign(5, 1.0);
      },
      "max_torque");
  refused(
      [](ReportPage& p) {
        p = SamplePage::make_sensed();
        p.plans[3].map_age.pop_back();
      },
      "map_age");
  refused([](ReportPage& p) { p.plans[0].seen = {{0.0, {}}}; }, "map_age");
  refused([](ReportPage& p) { p.plans[0].speeds = {Eigen::VectorXd::Zero(6)}; }, "speeds");
  refused([](ReportPage& p) { p.plans[0].is_prismatic.clear(); }, "is_prismatic");
  refused([](ReportPage& p) { p.plans[2].goal_poses.resize(2); }, "goal_poses");
  refused([](ReportPage& p) { p.robot[5].triangles[0][1] = 5; }, "triangles");
  refused([](ReportPage& p) { p.spheres[0].volume = 2; }, "volume");
  refused([](ReportPage& p) { p.voxels[0].state = "unknown"; }, "state");
  refused([](ReportPage& p) { p.resolution = 0.05; }, "resolution");
}

}  // namespace report_page_test
}  // namespace clearway
