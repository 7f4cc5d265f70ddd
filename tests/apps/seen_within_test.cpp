// A recording in which one side is not looked at for ten seconds, from the command line.
#include <gtest/gtest.h>

#include <png.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/apps/run_command.hpp"

namespace clearway {
namespace seen_within_test {

using Json = nlohmann::json;

/// Points of a wall at x, seen from the origin, as a .pcd file.
std::string wall(double x) {
  std::ostringstream points;
  int count = 0;
  for (double y = -1.5; y <= 1.5; y += 0.04) {
    for (double z = -0.3; z <= 0.3; z += 0.04, ++count) points << x << ' ' << y << ' ' << z << '\n';
  }
  const std::string size = std::to_string(count);
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + size +
         "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + size + "\nDATA ascii\n" + points.str();
}

const std::string start_before = "--start=1.1,-0.2", goal_before = "--goal=1.3,0.3";
const std::string start_behind = "--start=-1.1,-0.2", goal_behind = "--goal=-1.3,0.3";

/// Pixels of a slice that have the colours of the oldest and of the newest look; without the legend.
std::pair<int, int> pixels_of_ages(const std::string& file) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_file(&image, file.c_str()), 0);
  image.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> bytes(PNG_IMAGE_SIZE(image));
  EXPECT_NE(png_image_finish_read(&image, nullptr, bytes.data(), 0, nullptr), 0);
  int old = 0, fresh = 0;
  for (std::size_t row = 0; row < image.height; ++row) {
    for (std::size_t column = 0; column + 190 < image.width; ++column) {
      const std::uint8_t* rgb = &bytes[3 * (row * image.width + column)];
      old += rgb[0] == 8 && rgb[1] == 48 && rgb[2] == 107 ? 1 : 0;
      fresh += rgb[0] == 222 && rgb[1] == 235 && rgb[2] == 247 ? 1 : 0;
    }
  }
  return {old, fresh};
}

class SeenWithin : public ::testing::Test {
 protected:
  /// At 100 s the wall at x = 2 m is seen, from then on to 110 s the one at x = -2 m.
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    std::filesystem::create_directory(folder_->path() / "scans");
    folder_->write("scans/100.pcd", wall(2.0));
    for (int time = 101; time <= 110; time += 3)
      folder_->write("scans/" + std::to_string(time) + ".pcd", wall(-2.0));
    folder_->write("setup.yaml", setup(""));
    const CommandRun run = replay("setup.yaml", "map", {});
    ASSERT_EQ(run.status, exit_done) << run.out << run.log;
    const CommandRun bare =
        run_command({"inspect", folder_->file("map"), "--export", folder_->file("map.bt")});
    ASSERT_EQ(bare.status, exit_done) << bare.log;
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static std::string setup(const std::string& more) {
    return "map: {resolution: 0.05}\nrobot: {name: point}\nqueries:\n"
           "  - {name: before, start: [1.1, -0.2], goals: [[1.3, 0.3]], planners: [rrtconnect], "
           "policies: {default: known_free}" +
           more + "}\n";
  }

  static CommandRun replay(const std::string& setup, const std::string& out, std::vector<std::string> more) {
    std::vector<std::string> arguments{"replay", folder_->file("scans"), "--setup", folder_->file(setup),
                                       "--out",  folder_->file(out),     "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_command(arguments);
  }

  static CommandRun plan(const std::string& start, const std::string& goal, std::vector<std::string> more) {
    std::vector<std::string> arguments{
        "plan",       "--map", folder_->file("map"),      "--robot", "point", start, goal, "--policy",
        "known_free", "--out", folder_->file("plan.json")};
    if (std::find(more.begin(), more.end(), "--planner") == more.end())
      more.insert(more.end(), {"--planner", "rrtconnect"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_command(arguments);
  }

  static CommandRun check(std::vector<std::string> more) {
    std::vector<std::string> arguments{
        "check", "--map", folder_->file("map"), "--robot", "point", folder_->file("plan.json"), "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_command(arguments);
  }

  inline static std::unique_ptr<TemporaryFolder> folder_;
};

TEST_F(SeenWithin, what_was_not_looked_at_lately_is_planned_through_only_when_nobody_asks) {
  const CommandRun ever = plan(start_before, goal_before, {});
  EXPECT_EQ(ever.status, exit_done) << ever.out << ever.log;
  EXPECT_EQ(Json::parse(read_file(folder_->file("plan.json"))).contains("seen_within_s"), false);
  const CommandRun whenever = check({});
  EXPECT_EQ(whenever.status, exit_done) << whenever.out;
  EXPECT_NEAR(Json::parse(whenever.out)["swept"]["oldest_look_s"].get<double>(), 10.0, 1e-9);
  EXPECT_EQ(check({"--seen-within", "11"}).status, exit_done) << check({"--seen-within", "11"}).out;
  const CommandRun refused = check({"--seen-within", "5"});
  EXPECT_EQ(refused.status, exit_no);
  const Json verdict = Json::parse(refused.out);
  EXPECT_EQ(verdict["verdict"], "refused");
  EXPECT_EQ(verdict["seen_within_s"], 5.0);
  EXPECT_EQ(verdict["contract"]["seen_within_s"]["source"], "flag");
  EXPECT_NE(verdict["first_contact"].get<std::string>().find("last seen 10 s before the newest look"),
            std::string::npos)
      << verdict["first_contact"];

  for (const char* planner : {"rrtconnect", "beam", "boundary", "rrtconnect_fcl"}) {
    const CommandRun lately = plan(start_before, goal_before, {"--seen-within", "5", "--planner", planner});
    EXPECT_EQ(lately.status, exit_no) << planner << lately.out << lately.log;
    EXPECT_EQ(Json::parse(read_file(folder_->file("plan.json")))["status"], "start_invalid") << planner;
  }
  EXPECT_NE(plan(start_before, goal_before, {"--seen-within", "5"}).out.find("not seen lately enough"),
            std::string::npos);
}

TEST_F(SeenWithin, what_was_looked_at_lately_is_free_and_the_plan_keeps_what_it_was_asked) {
  for (const char* planner : {"rrtconnect", "beam", "rrtconnect_fcl"}) {
    const CommandRun lately = plan(start_behind, goal_behind, {"--seen-within", "5", "--planner", planner});
    EXPECT_EQ(lately.status, exit_done) << planner << lately.out << lately.log;
    EXPECT_NE(lately.out.find("seen within 5 s"), std::string::npos) << lately.out;
    EXPECT_EQ(Json::parse(read_file(folder_->file("plan.json")))["seen_within_s"], 5.0);
    const CommandRun checked = check({});
    EXPECT_EQ(checked.status, exit_done) << checked.out;
    EXPECT_EQ(Json::parse(checked.out)["contract"]["seen_within_s"],
              Json({{"value", 5.0}, {"source", "plan"}}));
  }
}

TEST_F(SeenWithin, a_query_may_ask_for_it_and_a_plan_that_forgets_is_refused) {
  folder_->write("asks.yaml", setup(", seen_within: 5"));
  EXPECT_EQ(replay("asks.yaml", "asks", {}).status, exit_no);
  EXPECT_EQ(Json::parse(read_file(folder_->file("asks/plans/before-rrtconnect.json")))["status"],
            "start_invalid");
  // The flag replaces the query's own.
  const CommandRun run = replay("asks.yaml", "asks", {"--seen-within", "11"});
  EXPECT_EQ(run.status, exit_done) << run.out << run.log;
  Json plan = Json::parse(read_file(folder_->file("asks/plans/before-rrtconnect.json")));
  EXPECT_EQ(plan["seen_within_s"], 11.0);
  for (const double sooner : {11.0, 0.5}) {
    plan["seen_within_s"] = sooner;
    const std::string narrower = folder_->write("sooner.json", plan.dump());
    const CommandRun kept =
        run_command({"check", "--map", folder_->file("asks"), "--robot", "point", narrower});
    EXPECT_EQ(kept.out.find("seen within: expected"), std::string::npos) << kept.out;
  }
  plan.erase("seen_within_s");
  const std::string file = folder_->write("forgets.json", plan.dump());
  const CommandRun refused = run_command({"check", "--map", folder_->file("asks"), "--robot", "point", file});
  EXPECT_EQ(refused.status, exit_no);
  EXPECT_NE(refused.out.find("seen within: expected 11 s by the map's record, the plan says ever"),
            std::string::npos)
      << refused.out;
}

TEST_F(SeenWithin, a_map_or_policy_that_cannot_answer_is_refused_in_one_sentence) {
  const CommandRun bare =
      run_command({"plan", "--map", folder_->file("map.bt"), "--robot", "point", start_before, goal_before,
                   "--policy", "known_free", "--seen-within", "5", "--planner", "rrtconnect"});
  EXPECT_EQ(bare.status, exit_bad_input);
  EXPECT_TRUE(bare.complains_in_one_sentence()) << bare.log;
  EXPECT_NE(bare.log.find("does not know when its voxels were seen"), std::string::npos) << bare.log;
  const CommandRun unasked =
      run_command({"plan", "--map", folder_->file("map"), "--robot", "point", start_before, goal_before,
                   "--policy", "not_occupied", "--seen-within", "5", "--planner", "rrtconnect"});
  EXPECT_EQ(unasked.status, exit_bad_input);
  EXPECT_TRUE(unasked.complains_in_one_sentence()) << unasked.log;
  EXPECT_NE(unasked.log.find("known_free"), std::string::npos) << unasked.log;
  for (const char* text : {"0", "-1", "nan", "soon"}) {
    const CommandRun none = plan(start_before, goal_before, {"--seen-within", text});
    EXPECT_EQ(none.status, exit_bad_input) << text;
    EXPECT_TRUE(none.complains_in_one_sentence()) << none.log;
  }
}

TEST_F(SeenWithin, inspect_says_when_a_voxel_was_seen_and_colours_a_slice_by_it) {
  const CommandRun run = run_command({"inspect", folder_->file("map"), "--json", "--at=1,0,0", "--at=-1,0,0",
                                      "--at=0,0,1", "--slice", "z=0.01", folder_->file("age.png"), "--age"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  const Json json = Json::parse(run.out);
  EXPECT_EQ(json["at"][0]["last_seen_s"], 100.0);
  EXPECT_EQ(json["at"][0]["age_s"], 10.0);
  EXPECT_EQ(json["at"][1]["last_seen_s"], 110.0);
  EXPECT_EQ(json["at"][1]["age_s"], 0.0);
  EXPECT_FALSE(json["at"][2].contains("last_seen_s"));
  EXPECT_EQ(json["seen"]["newest_s"], 110.0);
  EXPECT_EQ(json["seen"]["oldest_s"], 100.0);
  EXPECT_GT(json["seen"]["voxels"], 10000);
  const std::string text = run_command({"inspect", folder_->file("map"), "--at=1,0,0"}).out;
  EXPECT_NE(text.find("at 100 s, 10 s before the newest look"), std::string::npos) << text;
  EXPECT_NE(text.find("100 to 110 s"), std::string::npos) << text;

  const auto [old, fresh] = pixels_of_ages(folder_->file("age.png"));
  EXPECT_GT(old, 10000);
  EXPECT_NEAR(static_cast<double>(old) / fresh, 1.0, 0.1);  // one side was seen early, the other lately
  EXPECT_EQ(run_command({"inspect", folder_->file("map"), "--age"}).status, exit_bad_input);
  EXPECT_EQ(
      run_command({"inspect", folder_->file("map.bt"), "--slice", "z=0", folder_->file("b.png"), "--age"})
          .status,
      exit_bad_input);
}

}  // namespace seen_within_test
}  // namespace clearway
