// A rig in a room whose walls are known, its poses written in each convention.
#include "datasets/pictures/camera_path.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <iomanip>
#include <random>
#include <sstream>

#include "datasets/pictures/depth_folder.hpp"
#include "tests/datasets/complaint.hpp"
#include "tests/worlds/bytes/picture_bytes.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace camera_path_test {

namespace fs = std::filesystem;

const Eigen::AlignedBox3d room(Eigen::Vector3d(-2, -1.5, 0), Eigen::Vector3d(3, 2.5, 2.6));
constexpr double step = 0.0001;  ///< m of depth

/// What a pinhole in the room measures along its axis, written down anew: pixels count from the first's
/// middle.
std::string depth_png(const CameraIntrinsics& camera, const Eigen::Isometry3d& world_from_camera) {
  cv::Mat depth(camera.height, camera.width, CV_16UC1);
  for (int row = 0; row < camera.height; ++row) {
    for (int column = 0; column < camera.width; ++column) {
      const Eigen::Vector3d ray =
          world_from_camera.linear() *
          Eigen::Vector3d((column - camera.cx) / camera.fx, (row - camera.cy) / camera.fy, 1.0);
      double nearest = INFINITY;
      for (int axis = 0; axis < 3; ++axis)
        for (const double wall : {room.min()[axis], room.max()[axis]})
          if (const double far = (wall - world_from_camera.translation()[axis]) / ray[axis]; far > 0)
            nearest = std::min(nearest, far);
      depth.at<std::uint16_t>(row, column) = static_cast<std::uint16_t>(std::lround(nearest / step));
    }
  }
  return picture_bytes(depth, ".png");
}

std::string joined(const std::vector<double>& numbers) {
  std::ostringstream text;
  text << std::setprecision(12);
  for (std::size_t i = 0; i < numbers.size(); ++i) text << (i > 0 ? ", " : "") << numbers[i];
  return text.str();
}

/// Rows of a matrix as lists.
std::string rows(const Eigen::Matrix4d& matrix) {
  std::string text = "[";
  for (int row = 0; row < 4; ++row)
    text += std::string(row > 0 ? ", " : "") + "[" +
            joined({matrix(row, 0), matrix(row, 1), matrix(row, 2), matrix(row, 3)}) + "]";
  return text + "]";
}

/// From the axes of OpenGL: the columns of up and back are those of down and forward turned round.
Eigen::Matrix4d opengl(const Eigen::Isometry3d& world_from_camera) {
  Eigen::Matrix4d matrix = world_from_camera.matrix();
  matrix.col(1) = -matrix.col(1);
  matrix.col(2) = -matrix.col(2);
  return matrix;
}

std::string column_by_column(const Eigen::Matrix4d& matrix) {
  return "[" + joined(std::vector<double>(matrix.data(), matrix.data() + 16)) + "]";
}

/// As nerfstudio writes it: the first pixel's middle is at 0.5.
std::string nerf_camera(const CameraIntrinsics& camera) {
  return "\"fl_x\": " + joined({camera.fx}) + ", \"fl_y\": " + joined({camera.fy}) +
         ", \"cx\": " + joined({camera.cx + 0.5}) + ", \"cy\": " + joined({camera.cy + 0.5}) +
         ", \"w\": " + std::to_string(camera.width) + ", \"h\": " + std::to_string(camera.height);
}

class CameraPaths : public testing::Test {
 protected:
  CameraPaths() {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> part(0.2, 0.8);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 6; ++i) {
      Eigen::Isometry3d pose(
          Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized());
      for (int axis = 0; axis < 3; ++axis)
        pose.translation()[axis] = room.min()[axis] + part(random) * room.sizes()[axis];
      poses_.push_back(pose);
    }
  }

  static std::string name(std::size_t i) { return "frame_0000" + std::to_string(i + 1) + ".png"; }

  /// A folder of what this camera, or each its own, saw.
  fs::path folder(const std::string& called, const std::string& depth,
                  const std::function<CameraIntrinsics(std::size_t)>& camera) {
    fs::create_directories(folder_ / (called + "/" + depth));
    for (std::size_t i = 0; i < poses_.size(); ++i)
      folder_.write(called + "/" + depth + "/" + name(i), depth_png(camera(i), poses_[i]));
    return folder_ / called;
  }

  /// transforms.json; `more` of the file, `of_frame` of each frame.
  std::string transforms(const std::string& more, const std::string& depth,
                         const std::function<std::string(std::size_t)>& of_frame = {}) const {
    std::string text = "{" + more + "\"frames\": [";
    for (std::size_t i = poses_.size(); i-- > 0;) {  // in any order
      text += std::string("{\"file_path\": \"images/") + name(i) + "\", ";
      if (!depth.empty()) text += "\"depth_file_path\": \"./" + depth + "/" + name(i) + "\", ";
      if (of_frame) text += of_frame(i) + ", ";
      text += "\"transform_matrix\": " + rows(opengl(poses_[i])) + "}" + (i > 0 ? ", " : "]}");
    }
    return text;
  }

  struct Seen {
    std::vector<std::vector<Eigen::Vector3d>> points;  ///< of each picture, in the world
    std::vector<std::string> warnings;
  };
  static Seen seen(const fs::path& folder, SourceOptions options = {}) {
    if (!options.depth.scale) options.depth.scale = step;
    const auto layout = depth_layout(folder);
    EXPECT_TRUE(layout);
    const auto source = open_depth_folder(folder, *layout, options);
    Seen seen;
    while (const auto frame = source->next()) {
      if (frame->sensor != "depth") continue;
      const auto& cloud = std::get<CloudFrame>(frame->content);
      seen.points.emplace_back();
      for (const Eigen::Vector3f& point : cloud.points)
        seen.points.back().push_back(cloud.world_from_sensor * point.cast<double>());
    }
    EXPECT_FALSE(source->damage()) << *source->damage();
    seen.warnings = source->warnings();
    return seen;
  }

  /// That all points lie on the walls.
  void expect_room(const Seen& seen, std::size_t pixels) const {
    ASSERT_EQ(seen.points.size(), poses_.size());
    for (const auto& points : seen.points) {
      ASSERT_EQ(points.size(), pixels);
      for (const Eigen::Vector3d& point : points) {
        const double off =
            std::min((point - room.min()).cwiseAbs().minCoeff(), (point - room.max()).cwiseAbs().minCoeff());
        ASSERT_LT(off, 3 * step) << point.transpose();
        ASSERT_LT(room.squaredExteriorDistance(point), 9 * step * step);
      }
    }
  }
  static void expect_same(const Seen& a, const Seen& b) {
    ASSERT_EQ(a.points.size(), b.points.size());
    for (std::size_t i = 0; i < a.points.size(); ++i)
      for (std::size_t k = 0; k < a.points[i].size(); ++k)
        ASSERT_LT((a.points[i][k] - b.points[i].at(k)).norm(), 1e-5);
  }

  TemporaryFolder folder_;
  std::vector<Eigen::Isometry3d> poses_;
  const CameraIntrinsics camera_{48, 36, 40, 42, 22.5, 19, {}};
};

TEST_F(CameraPaths, PlaceThePicturesInEachConventionAlike) {
  const auto same = [this](std::size_t) { return camera_; };
  std::string matrices, log, parameters;
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    std::ostringstream rows;
    rows << std::setprecision(12) << poses_[i].matrix();
    log +=
        std::to_string(i) + " " + std::to_string(i) + " " + std::to_string(i + 1) + "\n" + rows.str() + "\n";
    parameters +=
        std::string(i > 0 ? ", " : "") + "{\"class_name\": \"PinholeCameraParameters\", \"extrinsic\": " +
        column_by_column(poses_[i].inverse().matrix()) +
        ", \"intrinsic\": {\"height\": 36, \"width\": 48, \"intrinsic_matrix\": [40, 0, 0, 0, 42, 0, "
        "22.5, 19, 1]}, \"version_major\": 1, \"version_minor\": 0}";
  }
  SourceOptions stated;
  stated.camera = camera_;
  const fs::path redwood = folder("redwood", "depth", same);
  folder_.write("redwood/trajectory.log", log);
  const Seen by_log = seen(redwood, stated);
  expect_room(by_log, 48 * 36);
  const fs::path open3d = folder("open3d", "depth", same);
  folder_.write("open3d/trajectory.json",
                "\n{\"class_name\": \"PinholeCameraTrajectory\", \"parameters\": [" + parameters + "]}");
  expect_same(seen(open3d), by_log);
  const fs::path nerf = folder("nerf", "depths", same);
  folder_.write("nerf/transforms.json", transforms(nerf_camera(camera_) + ", ", "depths"));
  const Seen by_nerf = seen(nerf);
  expect_same(by_nerf, by_log);
  ASSERT_EQ(by_nerf.warnings.size(), 1U);
  EXPECT_NE(by_nerf.warnings[0].find("cameras are those of"), std::string::npos) << by_nerf.warnings[0];
  const fs::path by_name = folder("by_name", "depth", same);
  folder_.write("by_name/transforms.json", transforms(nerf_camera(camera_) + ", ", ""));
  expect_same(seen(by_name), by_log);
  stated.depth.poses = open3d / "trajectory.json";  // named by the setup, of a folder with others
  expect_same(seen(redwood, stated), by_log);
}

TEST_F(CameraPaths, EachFrameMayHaveACameraOfItsOwn) {
  const auto camera = [this](std::size_t i) {
    CameraIntrinsics own = camera_;
    own.fx += 5.0 * static_cast<double>(i % 3);
    own.cy -= static_cast<double>(i);
    return own;
  };
  const fs::path nerf = folder("nerf", "depth", camera);
  folder_.write("nerf/transforms.json", transforms(nerf_camera(camera_) + ", ", "depth",
                                                   [&](std::size_t i) { return nerf_camera(camera(i)); }));
  expect_room(seen(nerf), 48 * 36);
  std::string parameters;
  for (std::size_t i = 0; i < poses_.size(); ++i)
    parameters += std::string(i > 0 ? ", " : "") +
                  "{\"extrinsic\": " + column_by_column(poses_[i].inverse().matrix()) +
                  ", \"intrinsic\": {\"height\": 36, \"width\": 48, \"intrinsic_matrix\": [" +
                  joined({camera(i).fx, 0, 0, 0, camera(i).fy, 0, camera(i).cx, camera(i).cy, 1}) + "]}}";
  fs::remove(nerf / "transforms.json");
  folder_.write("nerf/trajectory.json", "{\"parameters\": [" + parameters + "]}");
  expect_room(seen(nerf), 48 * 36);
}

TEST_F(CameraPaths, DepthMayBeSmallerThanThePicturesAndAnAngleMayBeTheCamera) {
  // Of pictures twice as large: their pixels' edges, not their middles, are at twice the place.
  const CameraIntrinsics large{96, 72, 80, 84, 45.5, 38.5, {}};
  const fs::path nerf = folder("nerf", "depth", [this](std::size_t) { return camera_; });
  folder_.write("nerf/transforms.json", transforms(nerf_camera(large) + ", ", "depth"));
  expect_room(seen(nerf), 48 * 36);
  const double angle = 2 * std::atan(24.0 / 40.0);
  const fs::path blender = folder(
      "blender", "depth", [](std::size_t) { return CameraIntrinsics{48, 36, 40, 40, 23.5, 17.5, {}}; });
  folder_.write("blender/transforms.json",
                transforms("\"camera_angle_x\": " + joined({angle}) + ", ", "depth"));
  expect_room(seen(blender), 48 * 36);
  folder_.write(
      "blender/transforms.json",
      transforms("\"integer_depth_scale\": 0.0001, \"camera_angle_x\": " + joined({angle}) + ", ", "depth"));
  SourceOptions options;
  options.depth.scale = std::nullopt;
  const auto source = open_depth_folder(blender, depth_layout(blender).value(), options);
  const auto frame = source->next();
  ASSERT_TRUE(frame);
  for (const Eigen::Vector3f& point : std::get<CloudFrame>(frame->content).points)
    ASSERT_LT(point.norm(), 8.0F);
  for (const std::string& warning : source->warnings())
    EXPECT_EQ(warning.find("steps of depth"), std::string::npos);
}

/// Pixels are the colour picture's: without its size a focal length in pixels says nothing of the depth.
TEST_F(CameraPaths, PixelsWithoutASizeAreThoseOfTheColourPicture) {
  const std::string frame =
      "{\"fl_x\": 80, \"fl_y\": 84, \"cx\": 45.5, \"cy\": 38.5, \"frames\": [{\"file_path\": \"a.png\", "
      "\"transform_matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}]}";
  const PictureSizes both{ImageSize{48, 36}, ImageSize{96, 72}};
  const auto camera = parse_camera_path(frame, "p", both).shots[0].camera;
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->width, 96);
  EXPECT_EQ(camera->height, 72);
  EXPECT_EQ(camera->cx, 45.0);
  EXPECT_FALSE(parse_camera_path(frame, "p").shots[0].camera);
  const std::string refused = complaint([&] {
    parse_camera_path(frame, "p", PictureSizes{ImageSize{48, 36}, {}});
  });
  EXPECT_NE(refused.find("'fl_x': expected `w` and `h` beside it"), std::string::npos) << refused;
}

TEST_F(CameraPaths, LensesAreOpenCvs) {
  const auto camera = [&](const std::string& more) {
    return parse_camera_path(transforms(nerf_camera(camera_) + ", " + more, "depth"), "p")
        .shots[0]
        .camera.value();
  };
  CameraIntrinsics expected = camera_;
  EXPECT_EQ(camera(""), expected);
  expected.distortion = {0.1, -0.2, 0.003, 0.004};
  EXPECT_EQ(camera("\"camera_model\": \"OPENCV\", \"k1\": 0.1, \"k2\": -0.2, \"p1\": 0.003, \"p2\": 0.004, "),
            expected);
  expected.distortion = {0.1, -0.2, 0.3, 0.4};
  expected.lens = LensModel::fisheye;
  EXPECT_EQ(
      camera("\"camera_model\": \"OPENCV_FISHEYE\", \"k1\": 0.1, \"k2\": -0.2, \"k3\": 0.3, \"k4\": 0.4, "),
      expected);
}

TEST_F(CameraPaths, WhatIsIncompleteOrAmbiguousIsRefusedInOneSentence) {
  const auto refusal = [](const std::string& text) {
    return complaint([&] { parse_camera_path(text, "poses 'p.json'"); });
  };
  const std::string matrix = "\"transform_matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]";
  const std::pair<std::string, const char*> wrong[] = {
      {"{", "poses 'p.json': expected JSON with keys and values"},
      {"[]", "expected JSON with keys and values"},
      {"{\"frames\": [], \"parameters\": []}", "expected either `frames`"},
      {"{\"a\": 1}", "expected either `frames`"},
      {"{\"frames\": []}", "expected at least one frame"},
      {"{\"frames\": 3}", "'frames': expected a list"},
      {"{\"frames\": [{" + matrix + "}]}", "'frames'[0] 'file_path': expected it to be there"},
      {"{\"frames\": [{\"file_path\": \"a.png\"}]}",
       "'frames'[0] 'transform_matrix': expected it to be there"},
      {"{\"frames\": [{\"file_path\": \"a.png\", \"transform_matrix\": "
       "[[2,0,0,0],[0,2,0,0],[0,0,2,0],[0,0,0,1]]}]}",
       "'frames'[0] 'transform_matrix': expected four rows of four numbers, a rigid transform"},
      {"{\"frames\": [{\"file_path\": \"a.png\", \"transform_matrix\": "
       "[[1,0,0,0],[0,1,0,0],[0,0,-1,0],[0,0,0,1]]}]}",
       "a rigid transform"},
      {"{\"frames\": [{\"file_path\": \"a.png\", \"transform_matrix\": [[1,0,0,\"x\"]]}]}",
       "expected a number"},
      {"{\"applied_scale\": 0.5, \"frames\": [{\"file_path\": \"a.png\", " + matrix + "}]}",
       "'applied_scale': expected 1"},
      {"{\"camera_model\": \"EQUIRECTANGULAR\", \"fl_x\": 3, \"w\": 40, \"h\": 30, \"frames\": "
       "[{\"file_path\": "
       "\"a.png\", " +
           matrix + "}]}",
       "'camera_model': expected OPENCV"},
      {"{\"fl_x\": -3, \"w\": 40, \"h\": 30, \"frames\": [{\"file_path\": \"a.png\", " + matrix + "}]}",
       "'fl_x': expected a focal length > 0"},
      {"{\"parameters\": [{\"extrinsic\": [1, 0, 0, 5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}]}",
       "'parameters'[0] 'extrinsic': expected 16 numbers, the columns"},
      {"{\"parameters\": [{\"extrinsic\": [1, 2]}]}", "'extrinsic': expected 16 numbers"},
      {"{\"a\": " + std::string(50, '[') + std::string(50, ']') + "}", "lists at most 16 deep"},
  };
  for (const auto& [text, expected] : wrong) {
    const std::string sentence = refusal(text);
    EXPECT_NE(sentence.find(expected), std::string::npos) << text << ": " << sentence;
    EXPECT_EQ(sentence.find('\n'), std::string::npos);
  }
  const fs::path nerf = folder("nerf", "depth", [this](std::size_t) { return camera_; });
  folder_.write("nerf/transforms.json", transforms(nerf_camera(camera_) + ", ", "depth"));
  folder_.write("nerf/groundtruth.txt", "1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n");
  const auto opened = [&] { return complaint([&] { seen(nerf); }); };
  EXPECT_NE(opened().find("has poses in 'transforms.json' and in 'groundtruth.txt': expected `poses`"),
            std::string::npos)
      << opened();
  // Depth pictures that no frame names are told.
  fs::remove(nerf / "groundtruth.txt");
  folder_.write("nerf/transforms.json", "{" + nerf_camera(camera_) +
                                            ", \"frames\": [{\"file_path\": \"a.png\", \"depth_file_path\": "
                                            "\"depth/frame_00001.png\", " +
                                            matrix + "}]}");
  SourceOptions scaled;
  scaled.depth.scale = 0.001;
  const auto one = open_depth_folder(nerf, depth_layout(nerf).value(), scaled);
  while (one->next()) {
  }
  std::string told;
  for (const std::string& warning : one->warnings()) told += warning + "\n";
  EXPECT_NE(told.find("5 depth pictures are named by no frame of transforms.json"), std::string::npos)
      << told;
  folder_.write("nerf/groundtruth.txt", "1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n");
  // Who names the other file is not told of this one, however it is.
  SourceOptions stated;
  stated.depth.poses = nerf / "groundtruth.txt";
  stated.depth.scale = 0.001;
  stated.depth.camera = camera_;
  folder_.write("nerf/transforms.json",
                "{\"applied_scale\": 0.5, \"frames\": [{\"file_path\": \"a.png\", "
                "\"depth_file_path\": \"b.png\", " +
                    matrix + "}]}");
  EXPECT_THROW(depth_layout(nerf), std::invalid_argument);
  const auto layout = depth_layout(nerf, stated.depth.poses);
  ASSERT_TRUE(layout);
  EXPECT_EQ(layout->depth.size(), 6U);
  EXPECT_EQ(layout->poses.filename(), "groundtruth.txt");
  fs::remove(nerf / "groundtruth.txt");
  folder_.write("nerf/transforms.json", transforms("", "depth"));
  EXPECT_NE(opened().find("expected `camera`"), std::string::npos) << opened();
  folder_.write(
      "nerf/transforms.json",
      "{" + nerf_camera(camera_) + ", \"frames\": [{\"file_path\": \"other.png\", " + matrix + "}]}");
  EXPECT_NE(opened().find("none of its 1 frames is of a depth picture there"), std::string::npos) << opened();
  const std::string frame = "{\"file_path\": \"frame_00001.png\", " + matrix + "}";
  folder_.write("nerf/transforms.json",
                "{" + nerf_camera(camera_) + ", \"frames\": [" + frame + "," + frame + "]}");
  EXPECT_NE(opened().find("two of its frames are of depth picture 'frame_00001.png'"), std::string::npos);
  fs::remove(nerf / "transforms.json");
  folder_.write(
      "nerf/trajectory.json",
      "{\"parameters\": [{\"extrinsic\": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1], \"intrinsic\": "
      "{\"width\": 48, \"height\": 36, \"intrinsic_matrix\": [40, 0, 0, 0, 42, 0, 22.5, 19, 1]}}]}");
  EXPECT_NE(opened().find("it has 1 pose for 6 depth pictures; expected one for each"), std::string::npos)
      << opened();
}

}  // namespace camera_path_test
}  // namespace clearway
