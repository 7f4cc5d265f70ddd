// inspect: rays, differences, new maps made of maps, and what made a voxel what it is.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "apps/inspect/map_folder.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/free_space_map.hpp"
#include "mapping/history/provenance.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/atomic_folder.hpp"
#include "tests/apps/run_command.hpp"

namespace clearway {
namespace inspect_edit_test {

using Json = nlohmann::json;

class Inspect : public ::testing::Test {
 protected:
  /// A wall at x = 0.55 seen from the origin, and a sphere painted into it afterwards.
  void SetUp() override {
    FreeSpaceMap map({.resolution = 0.1});
    map.keep_scans();
    map.add_volume("tunnel", {"tool"});
    Scan scan;
    scan.sensor = "kinect";
    scan.time = 4.0;
    scan.map_from_sensor.translation() = Eigen::Vector3d(0.05, 0.05, 0.05);
    for (int y = -3; y <= 3; ++y) {
      for (int z = -3; z <= 3; ++z)
        scan.points.emplace_back(0.5F, 0.1F * static_cast<float>(y), 0.1F * static_cast<float>(z));
    }
    map.insert(scan);
    map.begin_stroke("stroke 1", "camera");
    map.paint(0, {{0.45, 0.05, 0.05}, 0.25}, 5.0);
    save_map(map.snapshot(), map_);
    save_provenance(map.provenance(), map_);
    map.begin_stroke("stroke 2", "camera");
    map.paint(0, {{-0.5, 0.0, 0.0}, 0.3}, 6.0);
    save_map(map.snapshot(), other_);
  }

  Json json(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "inspect");
    arguments.emplace_back("--json");
    const CommandRun run = run_command(arguments);
    EXPECT_EQ(run.log, "");
    return Json::parse(run.out);
  }

  void expect_refused(const std::vector<std::string>& arguments, const std::string& word) {
    std::vector<std::string> all{"inspect"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const CommandRun run = run_command(all);
    EXPECT_EQ(run.status, exit_bad_input) << run.log;
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_NE(run.log.find(word), std::string::npos) << run.log;
  }

  TemporaryFolder folder_;
  std::string map_ = folder_.file("map"), other_ = folder_.file("other");
};

TEST_F(Inspect, says_where_a_ray_is_blocked) {
  const Json ray = json({map_, "--ray=-0.45,0.05,0.05,2,0,0"})["rays"][0];
  EXPECT_TRUE(ray["blocked"]);
  EXPECT_NEAR(ray["distance_m"], 0.95, 1e-9);
  EXPECT_EQ(ray["state"], "conflict");
  std::vector<std::string> states;
  for (const auto& run : ray["runs"]) states.push_back(run["state"]);
  EXPECT_EQ(states, (std::vector<std::string>{"unknown", "seen_free", "painted"}));
  EXPECT_FALSE(json({map_, "--ray=-0.45,0.05,0.05,-1,0,0"})["rays"][0]["blocked"]);
  const CommandRun text = run_command({"inspect", map_, "--ray=-0.45,0.05,0.05,2,0,0"});
  EXPECT_NE(text.out.find("950 mm: conflict"), std::string::npos) << text.out;
  expect_refused({map_, "--ray", "1,2,3"}, "OX,OY,OZ,DX,DY,DZ");
  expect_refused({map_, "--ray", "1,2,3,0,0,0"}, "direction");
}

TEST_F(Inspect, says_which_strokes_and_scans_made_a_voxel) {
  const Json at = json({map_, "--at=0.55,0.05,0.05"})["at"][0];
  EXPECT_EQ(at["state"], "conflict");
  const Json& made = at["provenance"];
  ASSERT_EQ(made["painted"].size(), 1U);
  EXPECT_EQ(made["painted"][0]["stroke"], "stroke 1");
  EXPECT_EQ(made["painted"][0]["source"], "camera");
  EXPECT_EQ(made["painted"][0]["volume"], "tunnel");
  EXPECT_EQ(made["painted"][0]["from_s"], 5.0);
  ASSERT_EQ(made["hit_by_scans"].size(), 1U);
  EXPECT_EQ(made["hit_by_scans"][0]["sensor"], "kinect");
  EXPECT_EQ(made["hit_by_scans"][0]["time"], 4.0);
  EXPECT_TRUE(made["passed_by_scans"].empty());
  EXPECT_TRUE(made["scans_exact"]);
  const CommandRun text = run_command({"inspect", map_, "--at=0.55,0.05,0.05"});
  EXPECT_NE(text.out.find("0 (kinect)"), std::string::npos) << text.out;
  EXPECT_FALSE(json({other_, "--at=0.55,0.05,0.05"})["at"][0].contains("provenance"));
}

TEST_F(Inspect, lists_conflicts_with_what_came_second) {
  const Json conflicts = json({map_, "--conflicts"})["conflicts"];
  EXPECT_GT(conflicts["appeared"], 0);
  EXPECT_EQ(conflicts["not_kept"], 0);
  EXPECT_EQ(conflicts["records"][0]["second"], "paint");
  EXPECT_EQ(conflicts["records"][0]["stroke"], "stroke 1");
  EXPECT_EQ(conflicts["records"][0]["time"], 5.0);
  const CommandRun text = run_command({"inspect", map_, "--conflicts"});
  EXPECT_EQ(text.status, exit_done);
  EXPECT_NE(text.out.find("5 after the first frame"), std::string::npos) << text.out;
  expect_refused({other_, "--conflicts"}, "provenance.bin");
}

TEST_F(Inspect, shows_when_a_scan_met_paint_by_its_own_clock) {
  FreeSpaceMap map({.resolution = 0.1});
  map.keep_scans();
  map.paint(map.add_volume("tunnel", {}), {{0.55, 0.05, 0.05}, 0.25}, 5.0);
  Scan scan;
  scan.time = 1577836812.25;  // s since 1970
  scan.map_from_sensor.translation() = Eigen::Vector3d(-0.95, 0.05, 0.05);
  scan.points.emplace_back(1.5F, 0.0F, 0.0F);
  map.insert(scan);
  save_map(map.snapshot(), other_);
  save_provenance(map.provenance(), other_);
  EXPECT_EQ(json({other_, "--conflicts"})["conflicts"]["records"][0]["time"], scan.time);
  const CommandRun text = run_command({"inspect", other_, "--conflicts"});
  EXPECT_NE(text.out.find("1577836812.25 "), std::string::npos) << text.out;
}

TEST_F(Inspect, does_not_use_the_provenance_of_another_map) {
  std::filesystem::copy_file(map_ + "/provenance.bin", other_ + "/provenance.bin");
  const CommandRun run = run_command({"inspect", other_, "--json", "--at=0.55,0.05,0.05"});
  EXPECT_EQ(run.status, exit_done);
  EXPECT_NE(run.log.find("belongs to another map"), std::string::npos);
  EXPECT_FALSE(Json::parse(run.out)["at"][0].contains("provenance"));
  std::ofstream(other_ + "/provenance.bin") << "rubbish";
  EXPECT_EQ(run_command({"inspect", other_, "--at=0,0,0"}).status, exit_damaged);
}

TEST_F(Inspect, reports_how_two_maps_differ) {
  const CommandRun same = run_command({"inspect", map_, "--diff", map_, "--json"});
  EXPECT_EQ(same.status, exit_done);
  EXPECT_FALSE(Json::parse(same.out)["diff"]["differ"]);
  const CommandRun run = run_command({"inspect", map_, "--diff", other_, "--json"});
  EXPECT_EQ(run.status, exit_no);
  const Json diff = Json::parse(run.out)["diff"];
  EXPECT_TRUE(diff["differ"]);
  EXPECT_EQ(diff["volumes"], Json({"tunnel"}));
  ASSERT_EQ(diff["voxels"].size(), 1U);
  EXPECT_EQ(diff["voxels"][0]["here"], "unknown");
  EXPECT_EQ(diff["voxels"][0]["there"], "painted");
  EXPECT_GT(diff["voxels"][0]["count"], 10);
  EXPECT_NE(run_command({"inspect", map_, "--diff", other_}).out.find("there painted"), std::string::npos);
  expect_refused({map_, "--diff", "/nowhere"}, "/nowhere");
}

TEST_F(Inspect, paints_the_spheres_of_a_file) {
  const std::string csv = folder_.write("spheres.csv",
                                        "volume,label,critical_parts,x,y,z,radius,time\n"
                                        "0,by hand,tool,3.0,3.0,3.0,0.4,1\n"),
                    out = folder_.file("out");
  json({map_, "--paint", csv, "--save", out});
  const Json at = json({out, "--at=3.0,3.0,3.0", "--at=3.0,3.0,3.45"})["at"];
  EXPECT_EQ(at[0]["state"], "painted");
  EXPECT_NE(at[1]["state"], "painted");
  EXPECT_EQ(json({map_, "--at=3.0,3.0,3.0"})["at"][0]["state"], "unknown");
  expect_refused({map_, "--paint", csv}, "--save");
  expect_refused({map_, "--paint", folder_.file("no.csv"), "--save", out}, "no.csv");
  const std::string large = folder_.write("mm.csv",
                                          "volume,label,critical_parts,x,y,z,radius,time\n"
                                          "0,by hand,tool,3.0,3.0,3.0,0.4,1\n0,by hand,tool,3,3,3,310,2\n");
  expect_refused({map_, "--paint", large, "--save", out},
                 "sphere 2 of volume 'by hand' has a radius of 310 m");
}

/// As replay writes them: the plans of a recording do not make way for a map.
TEST_F(Inspect, keeps_off_a_folder_that_holds_more_than_a_map) {
  const std::string out = folder_.file("of_replay");
  AtomicFolder of_replay(out, is_in_map_folder);
  save_map(load_map(other_), of_replay.path());
  save_file(of_replay.path() / "report.html", "<html>");
  of_replay.publish();
  expect_refused({map_, "--crop=0,0,0,0.2,0.2,0.2", "--save", out}, "report.html");
  EXPECT_EQ(read_file(out + "/report.html"), "<html>");
  EXPECT_EQ(read_file(out + "/map.ot"), read_file(other_ + "/map.ot"));
}

TEST_F(Inspect, KeepsAMapOfAnotherProgramThatIsInTheWay) {
  const std::string out = folder_.file("octomap");
  std::filesystem::create_directory(out);
  save_file(out + "/map.ot", "# Octomap OcTree file\nid OcTree\n");
  expect_refused({map_, "--crop=0,0,0,0.2,0.2,0.2", "--save", out}, "map.ot that Clearway did not write");
  EXPECT_EQ(read_file(out + "/map.ot"), "# Octomap OcTree file\nid OcTree\n");
  save_map(load_map(other_), out);  // by the library, without a list of our files
  json({map_, "--crop=0,0,0,0.2,0.2,0.2", "--save", out});
}

TEST_F(Inspect, merging_maps_of_two_clocks_says_so) {
  const auto map_seen_at = [&](const std::string& name, double time) {
    FreeSpaceMap map({.resolution = 0.1});
    Scan scan;
    scan.time = time;
    scan.points.emplace_back(0.5F, 0.0F, 0.0F);
    map.insert(scan);
    save_map(map.snapshot(), folder_.file(name));
    return folder_.file(name);
  };
  const auto log_of = [&](double time, double other) {
    return run_command({"inspect", map_seen_at("a", time), "--merge", map_seen_at("b", other), "--save",
                        folder_.file("m")})
        .log;
  };
  EXPECT_NE(log_of(40.0, 1764500000.0).find("only one of the maps has times since 1970"), std::string::npos);
  EXPECT_NE(log_of(1764500000.0, 40.0).find("--seen-within refuses it"), std::string::npos);
  EXPECT_NE(log_of(40.0, 50.0).find("count from a start of their own"), std::string::npos);
  EXPECT_NE(log_of(40.0, 40.0).find("count from a start of their own"), std::string::npos);
  EXPECT_EQ(load_map(folder_.file("m")).seen(), nullptr);
  EXPECT_EQ(log_of(1764500000.0, 1764600000.0), "");
  EXPECT_NE(load_map(folder_.file("m")).seen(), nullptr);
}

TEST_F(Inspect, exports_tell_what_verdicts_must_say_or_that_they_do_not) {
  const std::string cleared = folder_.file("cleared");
  run_command({"inspect", map_, "--clear", "box:0,0,0,0.6,0.6,0.6", "--save", cleared});
  const auto log_of = [&](const std::string& name) {
    const CommandRun run = run_command({"inspect", cleared, "--export", folder_.file(name)});
    EXPECT_EQ(run.status, exit_done) << run.log;
    return run.log;
  };
  for (const char* name : {"x.ot", "x.bt"}) {
    EXPECT_EQ(log_of(name).find("edited by hand"), std::string::npos) << name;
    EXPECT_NE(run_command({"inspect", folder_.file(name)}).out.find("edited by hand"), std::string::npos)
        << name;
  }
  EXPECT_NE(log_of("x.ply").find("does not say what the map does: the map was edited by hand"),
            std::string::npos);
}

TEST_F(Inspect, makes_new_maps_of_maps) {
  const std::string out = folder_.file("out");
  const Json merged =
      Json::parse(run_command({"inspect", map_, "--merge", other_, "--save", out, "--json"}).out);
  EXPECT_EQ(merged["saved"], out);
  // All that the one holds the other holds as well: merging adds nothing.
  EXPECT_EQ(run_command({"inspect", out, "--diff", other_, "--json"}).status, exit_done);
  EXPECT_EQ(run_command({"inspect", out, "--diff", map_, "--json"}).status, exit_no);
  const Json cropped = json({map_, "--crop=0,0,0,0.2,0.2,0.2", "--save", out});
  EXPECT_EQ(cropped["bounds"]["max"][0].get<double>(), 0.2);
  const Json coarse = json({map_, "--coarsen", "0.2", "--save", out});
  EXPECT_EQ(coarse["resolution"], 0.2);
  EXPECT_EQ(json({out})["resolution"], 0.2);
  const std::string before = read_file(map_ + "/map.ot");
  expect_refused({map_, "--coarsen", "0.2", "--save", map_}, "is read by MAP");
  expect_refused({map_ + "/map.ot", "--coarsen", "0.2", "--save", map_}, "is read by MAP");
  expect_refused({map_, "--merge", other_, "--save", other_}, "is read by --merge");
  expect_refused({map_, "--coarsen", "0.3", "--save", out}, "2, 4, 8");
  expect_refused({map_, "--coarsen", "0.2"}, "--save");
  EXPECT_NE(run_command({"inspect", map_, "--crop=50,50,50,51,51,51", "--save", folder_.file("none")})
                .log.find("nothing inside of --crop"),
            std::string::npos);
  expect_refused({map_, "--crop", "1,2,3", "--save", out}, "X0,Y0,Z0");
  EXPECT_EQ(read_file(map_ + "/map.ot"), before);
}

}  // namespace inspect_edit_test
}  // namespace clearway
