// Descriptions, recordings, maps and cameras with bytes changed. mutated_records_test has what people and the
// program itself write down: sessions, comparisons, trajectories, loads, tables.
#include "tests/apps/mutated_readers.hpp"

#include "apps/fusion/open_frames.hpp"
#include "apps/problem_sets/planning_scene.hpp"
#include "datasets/bags/bag_source.hpp"
#include "datasets/camera_files/camera_file.hpp"
#include "datasets/descriptions/scene.hpp"
#include "datasets/descriptions/setup.hpp"
#include "datasets/descriptions/suite.hpp"
#include "datasets/pictures/depth_folder.hpp"
#include "datasets/pictures/image_folder.hpp"
#include "datasets/pictures/picture_poses.hpp"
#include "datasets/pictures/picture_times.hpp"
#include "datasets/poses/numbered_poses.hpp"
#include "datasets/poses/tum_poses.hpp"
#include "datasets/sources/recording.hpp"
#include "datasets/sources/scan_graph.hpp"
#include "mapping/files/cloud_file.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/free_space_map.hpp"
#include "mapping/history/provenance.hpp"
#include "mapping/system/input_file.hpp"
#include "planning/files/plan_file.hpp"
#include "planning/files/query_record.hpp"
#include "planning/robot/robot.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/robot_files/robot_settings.hpp"
#include "planning/robot_files/srdf_file.hpp"
#include "planning/robot_files/urdf_file.hpp"
#include "tests/apps/run_command.hpp"
#include "tests/worlds/bag_topics.hpp"
#include "tests/worlds/bags/sqlite_bag_writer.hpp"
#include "tests/worlds/bytes/picture_bytes.hpp"
#include "tests/worlds/bytes/resealed.hpp"
#include "tests/worlds/small_scene.hpp"

namespace clearway {
namespace mutated_readers_test {

/// Changed behind its checksum.
std::string mutated_and_resealed(const std::string& whole, std::mt19937& random) {
  return resealed(mutated(whole, random));
}

TEST_F(MutatedReaders, plans_and_records_of_queries) {
  expect_read_or_refused("plan.json", source("tests/fuzz/corpus/plan_file/in_one_go-beam_guided.json"),
                         [](const auto& file) { static_cast<void>(to_json(load_plan(file))); });
  QueryRecord record;
  record.map_sha256 = std::string(64, 'a');
  record.queries.push_back({.name = "q",
                            .robot = "planar2",
                            .policies = {{"arm", Policy::known_free}},
                            .start = Eigen::Vector2d(0.0, 0.1),
                            .goals = {Eigen::Vector2d(1.0, 0.5)}});
  const auto load = [](const auto& file) { load_query_record(file.parent_path()); };
  expect_read_or_refused("queries.json", to_json(record), load);
  expect_read_or_refused("queries.json", to_json(record), load,
                         [](const auto& whole, auto& random) { return with_sha256(mutated(whole, random)); });
}

TEST_F(MutatedReaders, suites_scenes_and_setups) {
  for (const char* suite : {"quick", "dynamic", "sensed"})
    expect_read_or_refused("suite.yaml", source("datasets/suites/" + std::string(suite) + ".yaml"),
                           [](const auto& file) { load_suite(file); });
  folder_.write("setup.yaml", small_setup);
  expect_read_or_refused("scene.yaml", small_scene, [](const auto& file) { load_scene(file); });
  expect_read_or_refused("setup.yaml", small_setup, [](const auto& file) { load_setup(file); });
}

TEST_F(MutatedReaders, robots) {
  for (const char* robot : {"puma560", "arm5"})
    expect_read_or_refused("robot.yaml", source("datasets/robots/" + std::string(robot) + ".yaml"),
                           [](const auto& file) { read_robot_settings(file); });
  for (const char* robot : {"puma560", "panda"})
    expect_read_or_refused("robot.urdf", source("datasets/robots/" + std::string(robot) + ".urdf"),
                           [](const auto& file) { read_urdf(file); });
  expect_read_or_refused("robot.srdf",
                         "<robot name='r'><disable_collisions link1='a' link2='b' reason='Never'/>"
                         "<disable_collisions link1='b' link2='c' reason='Adjacent'/>"
                         "<group name='g'><chain base_link='a' tip_link='c'/><joint name='j'/></group>"
                         "<group name='h'><group name='g'/><link name='b'/></group>"
                         "<group_state name='home' group='g'><joint name='j' value='0.5'/></group_state>"
                         "<end_effector name='e' parent_link='b' group='h' parent_group='g'/></robot>",
                         [](const auto& file) { read_srdf(file); });
}

TEST_F(MutatedReaders, foreign_problem_sets) {
  const auto example = [](const std::string& name) { return source("datasets/suites/foreign/" + name); };
  const auto text = [](const auto& file) { return read_input(file, "file", 1U << 20U); };
  std::vector<std::string> left_out;
  expect_read_or_refused("scene.yaml", example("scene0001.yaml"),
                         [&](const auto& file) { read_planning_scene(text(file), file, {}, left_out); });
  expect_read_or_refused(
      "octomap.yaml",
      "fixed_frame_transforms: [{header: {frame_id: a}, child_frame_id: world, transform: {translation: [1, "
      "0, 0], rotation: [0, 0, 0, 1]}}, {header: {frame_id: world}, child_frame_id: world, transform: {}}]\n"
      "world: {octomap: {header: {frame_id: a}, origin: {position: [0, 0, 1]}, octomap: {binary: true, id: "
      "OcTree, resolution: 0.1, data: [11, 0, 2, 0]}}, collision_objects: [{id: floor, header: {frame_id: "
      "a}, planes: [{coef: [0, 0, 1, 0]}], plane_poses: [{position: [0, 0, 1]}]}]}\n",
      [&](const auto& file) { read_planning_scene(text(file), file, {}, left_out); });
  for (const char* request : {"request0001.yaml", "request0002.yaml"})
    expect_read_or_refused("request.yaml", example(request), [&](const auto& file) {
      read_motion_request(text(file), file, {}, {}, left_out);
    });
  expect_read_or_refused("table.scene", example("table.scene"),
                         [&](const auto& file) { read_scene_text(text(file), file, {}); });
  expect_read_or_refused("problems.json", example("problems.json"),
                         [&](const auto& file) { read_problem_json(text(file), file); });
  const SceneContext panda{load_robot("panda")};
  expect_read_or_refused("robometrics.yaml", example("robometrics.yaml"),
                         [&](const auto& file) { read_robometrics(text(file), file, panda); });
}

/// A recording in memory.
std::string small_recording(const TemporaryFolder& folder) {
  RecordingWriter writer(folder.file("whole.rawlog"));
  std::mt19937 random(1);
  for (int i = 0; i < 5; ++i) {
    CloudFrame cloud;
    for (int k = 0; k < 60; ++k)
      cloud.points.emplace_back(1.0F, static_cast<float>(random() % 100) / 100, 0.0F);
    writer.write(Frame{1000.0 + i, "cloud", cloud});
  }
  writer.finish();
  return read_file(folder.file("whole.rawlog"));
}

void read_recording(const std::filesystem::path& file) {
  RecordingReader reader(file);
  while (reader.next()) {
  }
  if (reader.damage()) throw DamagedFile(*reader.damage());
}

TEST_F(MutatedReaders, recordings) {
  expect_read_or_refused("r.rawlog", small_recording(folder_), read_recording);
}

TEST_F(MutatedReaders, what_recordings_seal) {
  expect_read_or_refused("r.rawlog", small_recording(folder_), read_recording, mutated_recording);
}

TEST_F(MutatedReaders, pictures_and_their_times) {
  cv::Mat noise(60, 80, CV_8UC1);
  cv::theRNG().state = 1;
  cv::randu(noise, 0, 255);
  for (const char* end : {".png", ".jpg"})
    expect_all_read_or_refused("", end, picture_bytes(noise, end), [](const auto& files) {
      const auto source = open_pictures(files, "eye", {});
      while (source->next()) continue;
      if (source->damage()) throw DamagedFile(*source->damage());
    });
  expect_read_or_refused("times.csv", source("tests/fuzz/corpus/file_times/tum.csv"),
                         [](const auto& file) { parse_file_times(read_file(file), "times"); });
}

TEST_F(MutatedReaders, bags) {
  const SourceOptions options = worlds::all_topics();
  const auto read = [&](const auto& file) {
    const auto source = open_bag(file, options);
    while (source->next()) {
    }
    if (source->damage()) throw DamagedFile(*source->damage());
  };
  for (const char* name : {"cdr_none.mcap", "cdr_zstd.mcap", "ros1_none.mcap"})
    expect_read_or_refused(name, source(std::string("tests/datasets/ros/bags/") + name), read);
  worlds::write_sqlite_bag(folder_ / "whole.db3",
                           worlds::records_of_mcap(std::filesystem::path(CLEARWAY_SOURCE_DIR) /
                                                   "tests/datasets/ros/bags/cdr_none.mcap"));
  expect_read_or_refused("a.db3", read_file(folder_ / "whole.db3"), read);
  worlds::write_ros1_bag(
      folder_ / "a.bag",
      std::filesystem::path(CLEARWAY_SOURCE_DIR) / "tests/datasets/ros/bags/ros1_none.mcap", "none");
  expect_read_or_refused("a.bag", read_file(folder_ / "a.bag"), read);
}

TEST_F(MutatedReaders, depth_pictures_and_matrices_of_poses) {
  setenv("OPENCV_IO_ENABLE_OPENEXR", "1", 1);
  for (const char* name : {"depth", "pose"}) std::filesystem::create_directory(folder_ / name);
  const std::string pose = "1 0 0 0.5\n0 1 0 0.25\n0 0 1 -1\n0 0 0 1\n";
  for (int i = 1; i <= 26; ++i) folder_.write("pose/" + std::to_string(i) + ".txt", pose);
  const std::string values(36 * 48 * 4, '@');  // 3.0 each
  std::string head = "{'descr': '<f4', 'fortran_order': False, 'shape': (36, 48), }";
  head.resize(117, ' ');
  const std::vector<std::pair<const char*, std::string>> kinds{
      {".png", picture_bytes(cv::Mat(36, 48, CV_16UC1, cv::Scalar(900)), ".png")},
      {".npy", std::string("\x93NUMPY\x01\x00\x76\x00", 10) + head + "\n" + values},
      {".pfm", "Pf\n48 36\n-1.0\n" + values},
      {".exr", picture_bytes(cv::Mat_<float>(36, 48, 2.0F), ".exr")}};
  for (const auto& [end, bytes] : kinds)
    expect_all_read_or_refused("depth", end, bytes, [this](const auto&) {
      SourceOptions options;
      options.camera = CameraIntrinsics{48, 36, 50, 52, 24, 18, {}};
      const auto source = open_depth_folder(folder_.path(), *depth_layout(folder_.path()), options);
      while (source->next()) continue;
      if (source->damage()) throw DamagedFile(*source->damage());
    });
  expect_read_or_refused("1.txt", pose, [](const auto& file) { parse_pose_matrix(read_file(file), "pose"); });
  expect_read_or_refused("depth/trajectory.log", "0 0 1\n1 0 0 0.5\n0 1 0 0.25\n0 0 1 -1\n0 0 0 1\n",
                         [](const auto& file) { PicturePoses(file, "", "depth", {"1.png"}, 0.02); });
  for (
      const char* path :
      {R"({"fl_x": 50, "w": 48, "h": 36, "k1": 0.1, "frames": [{"file_path": "i/1.png", "transform_matrix": )"
       R"([[1, 0, 0, 0.5], [0, 1, 0, 0.25], [0, 0, 1, -1], [0, 0, 0, 1]]}]})",
       R"({"parameters": [{"extrinsic": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3, 2, 1, 1], "intrinsic": )"
       R"({"width": 48, "height": 36, "intrinsic_matrix": [50, 0, 0, 0, 50, 0, 24, 18, 1]}}]})"})
    expect_read_or_refused("depth/path.json", path,
                           [](const auto& file) { PicturePoses(file, "", "depth", {"1.png"}, 0.02); });
}

TEST_F(MutatedReaders, streams_of_poses) {
  expect_read_or_refused("poses.tum", source("tests/fuzz/corpus/pose_stream/three.tum"),
                         [](const auto& file) { load_tum_poses(file, 0.5); });
}

TEST_F(MutatedReaders, maps) {
  FreeSpaceMap map({.resolution = 0.05});
  const int volume = map.add_volume("tool", {"hand"});
  map.begin_stroke("first", "test");
  for (int i = 0; i < 10; ++i) map.paint(volume, {{0.02 * i, 0.2, 0.3}, 0.1}, i);
  map.end_stroke();
  const auto folder = folder_.path() / "map";
  save_map(map.snapshot(), folder);
  save_provenance(map.provenance(), folder);
  const auto load = [](const auto& file) { load_map(file.parent_path()); };
  const auto load_alone = [](const auto& file) { load_map(file); };
  const auto history = [](const auto& file) { load_provenance(file.parent_path()); };
  expect_read_or_refused("map/map.ot", read_file(folder / "map.ot"), load);
  expect_read_or_refused("map/map.ot", read_file(folder / "map.ot"), load, mutated_and_resealed);
  expect_read_or_refused("map/provenance.bin", read_file(folder / "provenance.bin"), history);
  expect_read_or_refused("map/provenance.bin", read_file(folder / "provenance.bin"), history,
                         mutated_and_resealed);
  export_map(map.snapshot(), folder / "map.ot");  // of another program: painted.csv is read
  expect_read_or_refused("map/painted.csv", read_file(folder / "painted.csv"), load);
  expect_read_or_refused("other.ot", read_file(folder / "map.ot"), load_alone);
  expect_read_or_refused("other.bt", source("tests/fuzz/corpus/map_file/tiny.bt"), load_alone);
}

TEST_F(MutatedReaders, clouds) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 30; ++i) points.emplace_back(0.1F * static_cast<float>(i), 0.5F, 1.0F);
  const auto read = [](const auto& file) { read_viewed_cloud(file); };
  expect_read_or_refused("binary.pcd", format_pcd(points), read);
  expect_read_or_refused("binary.ply", format_ply(points), read);
  std::string pcd =
      "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 3\nHEIGHT 1\n"
      "VIEWPOINT 0 0 1 1 0 0 0\nPOINTS 3\nDATA ascii\n0 0 0\n1 0 0\n0 1 0.5\n";
  expect_read_or_refused("text.pcd", pcd, read);
  std::string scan(30 * 16, '\0');
  for (std::size_t i = 0; i < 30; ++i) std::memcpy(&scan[16 * i], points[i].data(), 12);
  expect_read_or_refused("scan.bin", scan, read);
}

TEST_F(MutatedReaders, what_lies_beside_kittis_scans) {
  const std::filesystem::path folder = folder_ / "kitti";
  std::filesystem::create_directories(folder / "velodyne");
  for (const char* name : {"velodyne/0.bin", "velodyne/1.bin"}) {
    const float point[] = {1, 2, 3, 0.5F};
    folder_.write(std::string("kitti/") + name,
                  std::string(reinterpret_cast<const char*>(point), sizeof point));
  }
  const std::pair<const char*, std::string> files[] = {
      {"poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n"},
      {"calib.txt", "P0: 7e2 0 6e2 0 0 7e2 1.8e2 0 0 0 1 0\nTr: 0 -1 0 0 0 0 -1 -0.08 1 0 0 -0.27\n"},
      {"times.txt", "0.000000e+00\n1.036224e-01\n"}};
  for (const auto& [name, text] : files) folder_.write(std::string("kitti/") + name, text);
  for (const auto& [name, text] : files) {
    expect_read_or_refused(std::string("kitti/") + name, text, [](const auto& file) {
      const auto source = open_frames(file.parent_path(), {});
      while (source->next()) continue;
    });
    folder_.write(std::string("kitti/") + name, text);
  }
}

TEST_F(MutatedReaders, scan_graphs) {
  for (const char* name : {"two.graph", "walk.log"})
    expect_read_or_refused(name, source("tests/fuzz/corpus/scan_graph/" + std::string(name)),
                           [](const auto& file) {
                             const auto graph = open_scan_graph(file, {});
                             while (graph->next()) continue;
                             if (const auto damage = graph->damage()) throw std::invalid_argument(*damage);
                           });
}

TEST_F(MutatedReaders, cameras) {
  const auto read = [](const auto& file) { load_camera_file(file, "", false, ImageSize{640, 480}); };
  expect_read_or_refused("camera.xml",
                         "<?xml version=\"1.0\"?>\n<opencv_storage>\n<image_width>640</image_width>\n"
                         "<image_height>480</image_height>\n<camera_matrix type_id=\"opencv-matrix\">\n"
                         "<rows>3</rows><cols>3</cols><dt>d</dt><data>\n600. 0. 320. 0. 601. 240. 0. 0. 1."
                         "</data></camera_matrix>\n<dist_coeffs type_id=\"opencv-matrix\"><rows>1</rows>"
                         "<cols>5</cols><dt>d</dt><data>\n0.1 0. 0. 0. 0.</data></dist_coeffs>\n"
                         "<x><_>\"a b\"</_><_>1</_></x></opencv_storage>\n",
                         read);
  expect_read_or_refused("realsense.json",
                         R"({"color": {"width": 640, "height": 480, "ppx": 320.5, "ppy": 240, "fx": 600, )"
                         R"("fy": 600, "model": "distortion.brown_conrady", "coeffs": [0.1, 0, 0, 0, 0]}})",
                         read);
  expect_read_or_refused(
      "open3d.json",
      R"({"width": 640, "height": 480, "intrinsic_matrix": [600, 0, 0, 0, 600, 0, 320, 240, 1]})", read);
  expect_read_or_refused("matrix.txt", "600 0 320 0\n0 600 240 0\n0 0 1 0\n0 0 0 1\n", read);
}

}  // namespace mutated_readers_test
}  // namespace clearway
