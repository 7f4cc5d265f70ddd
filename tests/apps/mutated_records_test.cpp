// What people and programs write down, with bytes changed: sessions, comparisons, trajectories, loads, tables
// and what lies beside recordings.
#include <random>

#include "apps/check/trajectory_file.hpp"
#include "apps/fusion/open_frames.hpp"
#include "apps/results/compare_diff.hpp"
#include "apps/results/compare_records.hpp"
#include "apps/teach/session_folder.hpp"
#include "apps/teach/teach_event.hpp"
#include "datasets/bags/bag_metadata.hpp"
#include "datasets/camera_files/camera_file.hpp"
#include "datasets/descriptions/load_setup.hpp"
#include "datasets/descriptions/suite.hpp"
#include "datasets/pictures/picture_poses.hpp"
#include "datasets/sources/joint_stream.hpp"
#include "datasets/yaml/yaml_fields.hpp"
#include "mapping/files/cloud_file.hpp"
#include "planning/files/gate_line.hpp"
#include "tests/apps/mutated_readers.hpp"

namespace clearway {
namespace mutated_records_test {

TEST_F(MutatedReaders, events_and_keys_of_sessions) {
  expect_read_or_refused("events.jsonl", source("tests/fuzz/corpus/teach_events/session.jsonl"),
                         [](const auto& file) {
                           for (const TeachEvent& event : load_teach_events(file)) to_json_line(event);
                         });
  expect_read_or_refused("keys.jsonl", source("tests/fuzz/corpus/teach_events/keys.jsonl"),
                         [](const auto& file) { load_teach_keys(file); });
}

TEST_F(MutatedReaders, sessions) {
  RecordedSession session;
  session.source = folder_.write("scan.pcd", format_pcd({{1.0F, 0.0F, 0.0F}}));
  session.setup_file = folder_.file("setup.yaml");
  session.setup_text = "robot: {robot: planar2}\n";
  session.integration = "safe";
  save_session(session, {{"/a/camera.yaml", "1"}}, folder_ / "session");
  expect_read_or_refused("session/session.json", read_file(folder_ / "session/session.json"),
                         [](const auto& file) { load_session(file.parent_path()); });
}

TEST_F(MutatedReaders, records_and_results_of_comparisons) {
  expect_read_or_refused("runs.jsonl", source("tests/fuzz/corpus/compare_records/two_planners.jsonl"),
                         [](const auto& file) { static_cast<void>(CompareRecords::read(file).text()); });
  expect_read_or_refused("results.sqlite", source("tests/fuzz/corpus/compare_diff/two_planners.sqlite"),
                         [](const auto& file) { to_json(compare_diff(file, file)); });
}

TEST_F(MutatedReaders, trajectories_of_other_programs) {
  for (const char* name : {"ros2.yaml", "moveit_goal.yaml", "result.json", "own.json"})
    expect_read_or_refused(name, source(std::string("tests/fuzz/corpus/check_trajectory/") + name),
                           [](const auto& file) {
                             if (read_trajectories(file).empty()) throw std::invalid_argument("it is a plan");
                           });
}

TEST_F(MutatedReaders, loads_picks_and_hulls) {
  const auto load = [](const auto& file) { load_load(file.parent_path() / "load.yaml"); };
  expect_read_or_refused("load.yaml", source("tests/fuzz/corpus/load_file/load.yaml"), load);
  expect_read_or_refused("pick.yaml", source("tests/fuzz/corpus/load_file/pick.yaml"),
                         [](const auto& file) { load_pick(file); });
  folder_.write("load.yaml", "{name: can, hull: points.txt, link: hand}");
  expect_read_or_refused("points.txt", source("tests/fuzz/corpus/load_file/points.txt"), load);
}

TEST_F(MutatedReaders, problems_beside_a_suite) {
  folder_.write("suite.yaml",
                "worlds: [{name: w, resolution: 0.1, sensors: [[0, 0, 1]], sensor_range: 2, solids: [{name: "
                "s, box: [1, 1, 0.1]}]}]\nplanners: [{planner: rrtconnect}]\ntime_limit: 0.1\nexperiments: "
                "[{name: e, robot: point, world: w, problems: p.yaml}]\n");
  expect_read_or_refused("p.yaml",
                         "problems:\n- {name: p, start: [0, 0], goals: [[1, 0]]}\n- {name: q, world: w, "
                         "start: [0, 1], goals: [[1, 0], [1, 1]]}\n",
                         [](const auto& file) { load_suite(file.parent_path() / "suite.yaml"); });
}

TEST_F(MutatedReaders, positions_of_joints) {
  expect_read_or_refused("joints.csv", source("tests/fuzz/corpus/joint_states/two.csv"),
                         [](const auto& file) { load_joint_states(file, 0.5); });
}

/// A fuzzer's find: the key of a list stood in the sentence as it is.
TEST_F(MutatedReaders, a_key_of_a_list_is_escaped) {
  const YamlFields fields("\"a\\e[2J\": [{b: 1}]", "a file");
  try {
    fields.list_of_maps("a\x1b[2J").front().text("c");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_EQ(std::string(error.what()).find('\x1b'), std::string::npos) << error.what();
  }
}

TEST_F(MutatedReaders, chunks_for_the_gate) {
  expect_read_or_refused("chunk.json", source("tests/fuzz/corpus/gate_line/two.json"), [](const auto& file) {
    const ChunkLine line = parse_chunk_line(read_file(file));
    if (!line.is_read()) throw std::invalid_argument(line.fault.sentence);
  });
}

TEST_F(MutatedReaders, what_lists_the_parts_of_a_bag) {
  std::filesystem::create_directory(folder_ / "bag");
  expect_read_or_refused("bag/metadata.yaml",
                         "rosbag2_bagfile_information:\n  version: 5\n  compression_format: \"\"\n"
                         "  compression_mode: \"\"\n  relative_file_paths: [a_0.mcap, a_1.mcap]\n",
                         [](const auto& file) {
                           listed_parts(file.parent_path());
                           require_unpacked(file.parent_path());
                         });
}

TEST_F(MutatedReaders, poses_beside_clouds) {
  const std::string poses = "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n";
  std::filesystem::create_directory(folder_ / "clouds");
  for (const char* name : {"clouds/0.pcd", "clouds/1.pcd"})
    folder_.write(name, format_pcd({{1.0F, 0.0F, 0.0F}}));
  expect_read_or_refused("clouds/poses.txt", poses,
                         [](const auto& file) { open_frames(file.parent_path(), {}); });
}

TEST_F(MutatedReaders, poses_beside_pictures) {
  std::filesystem::create_directory(folder_ / "depth");
  const auto read = [](const auto& file) { PicturePoses(file, "", "depth", {"1.png", "2.png"}, 0.02); };
  expect_read_or_refused("depth/traj.txt",
                         "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1\n", read);
  expect_read_or_refused("depth/groundtruth.txt", source("tests/fuzz/corpus/pose_stream/three.tum"), read);
}

TEST_F(MutatedReaders, what_lies_beside_scans_of_kittis_raw_data) {
  const std::filesystem::path folder = folder_ / "drive";
  std::filesystem::create_directories(folder / "velodyne");
  const float points[] = {1, 2, 3, 0.5F, 4, 5, 6, 0.25F};
  const std::string scan(reinterpret_cast<const char*>(points), sizeof points);
  const std::pair<const char*, std::string> files[] = {
      {"velodyne/0.bin", scan},
      {"poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n"},
      {"calib_velo_to_cam.txt", "calib_time: 1\nR: 0 -1 0 0 0 -1 1 0 0\nT: 0 -0.08 -0.27\n"},
      {"calib_cam_to_cam.txt", "R_rect_00: 1 0 0 0 1 0 0 0 1\n"}};
  for (const auto& [name, text] : files) folder_.write(std::string("drive/") + name, text);
  for (const auto& [name, text] : files) {
    expect_read_or_refused(std::string("drive/") + name, text, [&](const auto&) {
      const auto frames = open_frames(folder, {});
      while (frames->next()) continue;
      if (frames->damage()) throw std::invalid_argument(*frames->damage());
    });
  }
}

TEST_F(MutatedReaders, cameras_of_other_tools) {
  for (const char* name : {"kalibr.yaml", "ros.yaml", "echo.yaml", "opencv.yaml"})
    expect_read_or_refused(name, source(std::string("tests/fuzz/corpus/camera_file/") + name),
                           [](const auto& file) {
                             std::string note;
                             load_camera_file(file, "", false, ImageSize{640, 480}, {}, &note);
                           });
  expect_read_or_refused("cam_params.json",
                         R"({"camera": {"w": 48, "h": 36, "fx": 50, "fy": 50, "cx": 24, "cy": 18, )"
                         R"("scale": 6553.5}})",
                         [](const auto& file) {
                           load_camera_file(file, "");
                           depth_scale_of_file(file);
                         });
  expect_read_or_refused(
      "info.txt",
      "m_colorWidth = 96\nm_colorHeight = 72\nm_depthWidth = 48\nm_depthHeight = 36\n"
      "m_depthShift = 1000\nm_calibrationColorIntrinsic = 9 0 4 0 0 9 3 0 0 0 1 0 0 0 0 1\n"
      "m_calibrationDepthIntrinsic = 5 0 2 0 0 5 1 0 0 0 1 0 0 0 0 1\n",
      [](const auto& file) {
        load_camera_file(file, "");
        depth_scale_of_file(file);
      });
}

}  // namespace mutated_records_test
}  // namespace clearway
