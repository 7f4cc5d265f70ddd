// The main job against exact truth: a rendered recording of the miniature kitchen becomes a map and plans,
// and everything in them is compared with the scene it was rendered from.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <nlohmann/json.hpp>

#include "mapping/files/map_file.hpp"
#include "planning/geometry/shape.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/apps/run_command.hpp"
#include "tests/worlds/scene_truth.hpp"
#include "tests/worlds/small_scene.hpp"

namespace clearway {
namespace kitchen_job_test {

using Json = nlohmann::json;
using worlds::Obstacle, worlds::FreeVoxels, worlds::count_free, worlds::for_each_voxel, worlds::vector_of;

/// Plans, but for times.
std::string without_times(const std::string& text) {
  Json json = Json::parse(text);
  for (const char* key : {"time_s", "timings_s"}) json.erase(key);
  if (json.contains("plans"))
    for (Json& plan : json["plans"]) plan.erase("time_s");
  return json.dump();
}

/// Of half a second, for what any recording shows.
std::string small_recording(const TemporaryFolder& folder) {
  folder.write("setup.yaml", small_setup);
  const std::string recording = folder.file("small.rawlog");
  const CommandRun run =
      run_command({"simulate", folder.write("scene.yaml", small_scene), "--out", recording, "--quiet"});
  EXPECT_EQ(run.status, exit_done) << run.log;
  return recording;
}

class KitchenJob : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    const std::string scene = std::string(CLEARWAY_SOURCE_DIR) + "/datasets/scenes/miniature_kitchen.yaml";
    simulated_ = run_command({"simulate", scene, "--out", folder_->file("recording.rawlog"), "--quiet"});
    replayed_ =
        run_command({"replay", folder_->file("recording.rawlog"), "--out", folder_->file("out"), "--quiet"});
    truth_ = Json::parse(read_file(folder_->file("truth.json")));
    report_ = Json::parse(read_file(folder_->file("out/report.json")));
    map_ = load_map(folder_->file("out"));
    obstacles_ = worlds::read_obstacles(truth_);
  }
  static void TearDownTestSuite() { delete folder_; }

  static TemporaryFolder* folder_;
  static CommandRun simulated_, replayed_;
  static Json truth_, report_;
  static Snapshot map_;
  static std::vector<Obstacle> obstacles_;
};

TemporaryFolder* KitchenJob::folder_ = nullptr;
CommandRun KitchenJob::simulated_, KitchenJob::replayed_;
Json KitchenJob::truth_, KitchenJob::report_;
Snapshot KitchenJob::map_;
std::vector<Obstacle> KitchenJob::obstacles_;

TEST_F(KitchenJob, ends_well_and_leaves_every_file_that_it_promises) {
  EXPECT_EQ(simulated_.status, exit_done) << simulated_.log;
  EXPECT_EQ(replayed_.status, exit_done) << replayed_.log << replayed_.out;
  for (const char* name : {"map.ot", "painted.csv", "report.json", "report.html"}) {
    EXPECT_TRUE(std::filesystem::exists(folder_->path() / "out" / name)) << name;
  }
  EXPECT_NE(replayed_.out.find("report.html"), std::string::npos);
  for (const char* word : {"frames", "balls painted", "conflicts", "seen free", "cost J", "clearance mm"}) {
    EXPECT_NE(replayed_.out.find(word), std::string::npos) << word;
  }
}

TEST_F(KitchenJob, report_counts_what_the_recording_holds) {
  EXPECT_EQ(report_["frames"]["images"], truth_["frames"].size());
  EXPECT_EQ(report_["scans"]["count"], truth_["depth"].size());
  EXPECT_EQ(report_["balls"], report_["tracking"]["accepted"]);
  std::size_t samples = report_["tracking"]["accepted"];
  for (const auto& [reason, count] : report_["tracking"]["refused"].items())
    samples += count.get<std::size_t>();
  EXPECT_EQ(samples, truth_["frames"].size());
  EXPECT_GE(report_["balls"], 100);
  EXPECT_EQ(report_["conflicts"], 0);
}

TEST_F(KitchenJob, every_painted_sphere_is_within_the_bound_that_it_paid_of_where_the_probe_truly_was) {
  ASSERT_EQ(map_.volumes().size(), 1u);
  const PaintedVolume& volume = map_.volumes()[0];
  const Json& budget = report_["tracking"]["error_budget"];
  EXPECT_EQ(budget["tracking"], "bound");
  const double most = budget["ball_radius_m"].get<double>() - budget["robot_error_m"].get<double>() -
                      budget["modelling_error_m"].get<double>();
  const double constant = budget["tracking_error_m"];
  const double first = truth_["depth"][0]["time"];
  double sum = 0.0;
  for (std::size_t i = 0; i < volume.spheres.size(); ++i) {
    const Json* nearest = nullptr;
    for (const auto& frame : truth_["frames"]) {
      if (nearest == nullptr || std::abs(frame["time"].get<double>() - first - volume.times[i]) <
                                    std::abs((*nearest)["time"].get<double>() - first - volume.times[i])) {
        nearest = &frame;
      }
    }
    const double error = (volume.spheres[i].center - vector_of((*nearest)["ball"])).norm();
    EXPECT_LE(error, most - volume.spheres[i].radius) << "ball " << i;
    EXPECT_GE(most - volume.spheres[i].radius, 0.0) << "ball " << i;
    sum += error;
  }
  EXPECT_LT(sum / static_cast<double>(volume.spheres.size()), 0.5 * constant);
}

TEST_F(KitchenJob, no_painted_voxel_leaves_the_exact_union_of_spheres) {
  std::size_t painted = 0;
  map_.visit_leaves([&](const Voxel& leaf) {
    if (leaf.volumes == 0) return;
    for_each_voxel(leaf, map_.resolution(), [&](const Eigen::Vector3d& center) {
      ++painted;
      const double half_diagonal = 0.5 * std::sqrt(3.0) * map_.resolution();
      bool inside_one = false;
      for (const Sphere& sphere : map_.volumes()[0].spheres) {
        // Farthest corner of the cube from the sphere's centre.
        const Eigen::Vector3d far =
            (center - sphere.center).cwiseAbs() + Eigen::Vector3d::Constant(0.5 * map_.resolution());
        if ((center - sphere.center).norm() <= sphere.radius + half_diagonal &&
            far.norm() <= sphere.radius + 1e-12) {
          inside_one = true;
          break;
        }
      }
      EXPECT_TRUE(inside_one) << center.transpose();
    });
  });
  EXPECT_GT(painted, 10000u);
}

TEST_F(KitchenJob, no_painted_voxel_touches_an_obstacle) {
  map_.visit_leaves([&](const Voxel& leaf) {
    if (leaf.state != VoxelState::painted) return;
    for (const Obstacle& obstacle : obstacles_) {
      EXPECT_GT(distance_to_cube(obstacle.shape, obstacle.map_from_shape, leaf.center, leaf.size).lower, 0.0)
          << obstacle.name << " at " << leaf.center.transpose();
    }
  });
}

TEST_F(KitchenJob, with_depth_noise_at_most_one_in_a_thousand_free_voxels_lies_inside_an_obstacle) {
  const FreeVoxels counts = count_free(map_, obstacles_);
  RecordProperty("seen_free_inside_obstacles", static_cast<int>(counts.inside));
  RecordProperty("seen_free", static_cast<int>(counts.free));
  EXPECT_GT(counts.free, 500000u);
  EXPECT_LE(static_cast<double>(counts.inside), 1e-3 * static_cast<double>(counts.free));
}

TEST_F(KitchenJob, without_depth_noise_no_free_voxel_lies_inside_an_obstacle) {
  const std::filesystem::path datasets = std::filesystem::path(CLEARWAY_SOURCE_DIR) / "datasets";
  std::string scene = read_file(datasets / "scenes" / "miniature_kitchen.yaml");
  const auto set = [&](const std::string& key, const std::string& value) {
    const std::size_t at = scene.find(key);
    ASSERT_NE(at, std::string::npos) << key;
    scene.replace(at, scene.find('\n', at) - at, key + value);
  };
  set("noise_constant:", " 0");
  set("noise_quadratic:", " 0");
  set("dropout:", " 0");
  set("setup:", " " + (datasets / "setups" / "miniature_kitchen.yaml").string());
  scene.erase(scene.find("\nstroke:"));  // the depth images alone
  scene.erase(scene.find("\ncamera:"), scene.find("\ndepth:") - scene.find("\ncamera:"));
  const TemporaryFolder folder;
  const std::string recording = folder.file("exact.rawlog");
  const CommandRun simulated =
      run_command({"simulate", folder.write("exact.yaml", scene), "--out", recording, "--quiet"});
  ASSERT_EQ(simulated.status, exit_done) << simulated.log;
  const std::string bare =
      folder.write("bare.yaml", "map: {resolution: 0.0025, min_range: 0.05, max_range: 1.0}\n");
  const CommandRun run =
      run_command({"replay", recording, "--setup", bare, "--out", folder.file("out"), "--quiet"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  const FreeVoxels counts = count_free(load_map(folder.file("out")), obstacles_);
  for (const auto& [place, count] : counts.culprits) ADD_FAILURE() << place;
  EXPECT_EQ(counts.inside, 0u);
  EXPECT_GT(counts.free, 500000u);
}

TEST_F(KitchenJob, plans_are_solved_and_the_check_command_confirms_each) {
  ASSERT_GE(report_["plans"].size(), 2u);
  for (const auto& plan : report_["plans"]) {
    EXPECT_EQ(plan["status"], "solved") << plan;
    EXPECT_EQ(plan["verdict"], "valid") << plan;
    const CommandRun check =
        run_command({"check", folder_->file("out/" + plan["file"].get<std::string>()), "--map",
                     folder_->file("out"), "--robot", "puma560_miniature", "--json"});
    EXPECT_EQ(check.status, exit_done) << check.out << check.log;
    const Json json = Json::parse(check.out);
    EXPECT_TRUE(json["same_map"]);
    EXPECT_EQ(json["contract"]["query"], plan["query"]);
    for (const char* term : {"scale", "base", "padding_m", "start", "goals"})
      EXPECT_EQ(json["contract"][term]["source"], "map") << term;
    EXPECT_EQ(json["contract"]["policy"]["tool"], Json({{"value", "painted"}, {"source", "map"}}));
  }
}

TEST_F(KitchenJob, a_second_replay_writes_the_same_map_and_paths_byte_for_byte) {
  ASSERT_EQ(
      run_command({"replay", folder_->file("recording.rawlog"), "--out", folder_->file("again"), "--quiet"})
          .status,
      exit_done);
  for (const char* name : {"map.ot", "painted.csv"}) {
    EXPECT_EQ(read_file(folder_->path() / "out" / name), read_file(folder_->path() / "again" / name)) << name;
  }
  for (const auto& plan : report_["plans"]) {
    const std::string name = plan["file"];
    EXPECT_EQ(Json::parse(read_file(folder_->path() / "out" / name))["waypoints"],
              Json::parse(read_file(folder_->path() / "again" / name))["waypoints"])
        << name;
  }
}

/// The demo's events, with a pen in the hand up to the second place on the way, and a ball that marks a cup.
std::string events_with_load() {
  std::string text = read_file(std::string(CLEARWAY_SOURCE_DIR) + "/datasets/scenes/miniature_kitchen.jsonl");
  const auto insert = [&](const std::string& before, const std::string& line) {
    text.insert(text.find("{\"time\": " + before), line + "\n");
  };
  insert("9.4", R"({"time": 8.05, "action": "object", "name": "cup"})");
  insert("9.4", R"({"time": 8.2, "action": "object_off"})");
  insert(
      "9.4",
      R"({"time": 9, "action": "attach", "load": {"name": "pen", "cylinder": [0.0025, 0.012], "link": "tool", )"
      R"("pose_deg": [0, 0, 0.014, 0, 0.1, 0], "mass": 0.1}})");
  insert("14.4", R"({"time": 13.5, "action": "detach", "name": "pen"})");
  return text;
}

TEST_F(KitchenJob, a_taught_session_ends_in_an_approved_plan_and_is_done_again_byte_for_byte) {
  const TemporaryFolder folder;
  const std::string recording = folder_->file("recording.rawlog");
  const std::string events = folder.write("events.jsonl", events_with_load());
  const CommandRun run = run_command({"teach", recording, "--events", events, "--out", folder.file("taught"),
                                      "--threads", "1", "--headless", "--overlay", folder.file("stills")});
  ASSERT_EQ(run.status, exit_done) << run.log << run.out;
  const Json report = Json::parse(read_file(folder / "taught/report.json"));
  const Json& taught = report["teaching"];
  EXPECT_EQ(taught["plans"][0]["approved"], true);
  EXPECT_EQ(taught["plans"][0]["map"], "map.ot");
  EXPECT_NE(read_file(folder / "taught/report.html").find("[\"approval\",\"approved\"]"), std::string::npos);
  EXPECT_GT(taught["images_leading_the_robot"], 100);
  EXPECT_GT(taught["of_these_warned"], 5);  // the probe ends beyond the arm's reach
  EXPECT_LT(taught["of_these_warned"], 60);
  EXPECT_EQ(taught["events"].back()["refused"], "the tip is beyond the arm's reach");

  for (const char* moment : {"start", "goal", "tightest"})
    EXPECT_GT(
        std::filesystem::file_size(folder / ("stills/over_the_box-beam-" + std::string(moment) + ".png")),
        100'000u);

  // Start and goals are where the probe was held, within what tracking may be off.
  const Robot robot = load_robot("puma560_miniature");
  const Json plan = Json::parse(read_file(folder / "taught/plans/over_the_box.json"));
  const auto values = plan["start"].get<std::vector<double>>();
  const Eigen::Isometry3d tip = tip_pose(robot, Eigen::Map<const Configuration>(values.data(), 6));
  const Json& held = truth_["frames"][135]["map_from_tip"];  // 9 s
  EXPECT_LT((tip.translation() - Eigen::Vector3d(held[0], held[1], held[2])).norm(), 0.003);

  EXPECT_EQ(run_command({"check", folder.file("taught/plans/over_the_box.json"), "--map",
                         folder.file("taught"), "--robot", "puma560_miniature"})
                .status,
            exit_done);
  // The pen rides on the first two legs; a plan that forgets it is refused by the map's record.
  EXPECT_EQ(plan["loads"][0]["name"], "pen");
  EXPECT_EQ(plan["loads"][0]["legs"], Json({1, 2}));
  EXPECT_EQ(taught["events"][5]["remark"].get<std::string>().substr(0, 5), "cup, ");
  Json forgetful = plan;
  forgetful.erase("loads");
  forgetful["policy"].erase("pen");
  const CommandRun refused = run_command({"check", folder.write("forgetful.json", forgetful.dump()), "--map",
                                          folder.file("taught"), "--robot", "puma560_miniature"});
  EXPECT_EQ(refused.status, exit_no);
  EXPECT_NE(refused.out.find("expected pen on tool, legs 1, 2 by the map's record"), std::string::npos)
      << refused.out;

  const CommandRun again =
      run_command({"replay", folder.file("taught/session"), "--out", folder.file("again"), "--threads", "2"});
  ASSERT_EQ(again.status, exit_done) << again.log << again.out;
  for (const char* file : {"map.ot", "painted.csv", "provenance.bin", "queries.json",
                           "approved/over_the_box.yaml", "session/events.jsonl", "session/session.json"})
    EXPECT_EQ(read_file(folder / "taught" / file), read_file(folder / "again" / file)) << file;
  for (const char* file : {"report.json", "plans/over_the_box.json"})
    EXPECT_EQ(without_times(read_file(folder / "taught" / file)),
              without_times(read_file(folder / "again" / file)))
        << file;

  // Another recording in its place is noticed.
  std::string session = read_file(folder / "taught/session/session.json");
  session.replace(session.find("\"sha256\": \"") + 11, 4, "----");
  write_file(folder / "taught/session/session.json", session);
  const CommandRun other =
      run_command({"replay", folder.file("taught/session"), "--out", folder.file("other")});
  EXPECT_EQ(other.status, exit_bad_input);
  EXPECT_NE(other.log.find("is not the one that it was made from"), std::string::npos) << other.log;
}

TEST_F(KitchenJob, a_truncated_recording_is_reported_as_damage_and_what_came_before_is_kept) {
  const std::string whole = read_file(folder_->file("recording.rawlog"));
  const std::string cut = folder_->write("cut.rawlog", whole.substr(0, whole.size() / 8));
  const CommandRun run = run_command({"replay", cut, "--out", folder_->file("cut"), "--no-plan"});
  EXPECT_EQ(run.status, exit_damaged) << run.log;
  EXPECT_NE(run.log.find("cut.rawlog"), std::string::npos) << run.log;
  const Json report = Json::parse(read_file(folder_->file("cut/report.json")));
  EXPECT_TRUE(report["recording"]["damage"].is_string());
  EXPECT_GT(report["frames"]["total"], 10);
  EXPECT_LT(report["frames"]["total"], report_["frames"]["total"]);
}

TEST_F(KitchenJob, a_replay_into_the_same_folder_leaves_no_plan_of_the_map_before) {
  const TemporaryFolder folder;
  const std::string out = folder.file("out");
  std::filesystem::copy(folder_->path() / "out", out, std::filesystem::copy_options::recursive);
  ASSERT_FALSE(std::filesystem::is_empty(out + "/plans"));
  const std::string bare = folder.write("bare.yaml", "map: {resolution: 0.005}\n");
  ASSERT_EQ(run_command({"replay", small_recording(folder), "--setup", bare, "--out", out, "--quiet"}).status,
            exit_done);
  EXPECT_TRUE(std::filesystem::is_empty(out + "/plans"));
  EXPECT_EQ(Json::parse(read_file(out + "/report.json"))["map"]["resolution"], 0.005);
}

TEST_F(KitchenJob, bad_recordings_and_folders_are_refused_in_one_sentence_and_leave_nothing) {
  const TemporaryFolder folder;
  const std::string setup = std::string(CLEARWAY_SOURCE_DIR) + "/datasets/setups/miniature_kitchen.yaml";
  const auto expect_refused = [&](const std::vector<std::string>& arguments, const std::string& word) {
    const auto before = folder.files();
    const CommandRun run = run_command(arguments);
    EXPECT_EQ(run.status, exit_bad_input) << run.log;
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_NE(run.log.find(word), std::string::npos) << run.log;
    EXPECT_EQ(folder.files(), before);
  };
  expect_refused({"replay", folder.file("none.rawlog"), "--out", folder.file("out")}, "none.rawlog");
  expect_refused({"replay", folder.write("text.rawlog", "hello"), "--out", folder.file("out")},
                 "text.rawlog");
  expect_refused({"replay", "/usr/share/mrpt/datasets/localization_demo.rawlog", "--setup", setup, "--out",
                  folder.file("out")},
                 "no camera image");
  expect_refused({"replay", small_recording(folder), "--out", "/proc/nowhere", "--no-plan"}, "/proc/nowhere");
  expect_refused(
      {"replay", folder_->file("recording.rawlog"), "--out", folder.file("out"), "--planner", "beem"},
      "beam");
  expect_refused({"replay", folder_->file("recording.rawlog"), "--setup", folder.write("s.yaml", "mapp: {}"),
                  "--out", folder.file("out")},
                 "mapp");
  const std::string query =
      "robot: {name: point}\nqueries: [{name: ../evil, start: [0, 0], goals: [[1, 1]]}]\n";
  expect_refused({"replay", "/usr/share/mrpt/datasets/localization_demo.rawlog", "--setup",
                  folder.write("evil.yaml", query), "--out", folder.file("out")},
                 "../evil");
  expect_refused({"simulate", folder.file("none.yaml"), "--out", folder.file("a.rawlog")}, "none.yaml");
}

}  // namespace kitchen_job_test
}  // namespace clearway
