// A probe and a hand that move and tremble, in scans whose clock and place are off: nothing of them becomes
// an obstacle, and nothing far from them is taken out.
#include "apps/fusion/held_bodies.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "apps/fusion/fusion.hpp"
#include "datasets/descriptions/scene.hpp"
#include "datasets/simulation/simulate.hpp"
#include "mapping/scans/scan_filter.hpp"
#include "tests/worlds/temporary_folder.hpp"
#include "tests/worlds/trials.hpp"

namespace clearway {
namespace held_bodies_test {

/// A cube of 60 mm with five tags, a ball at 0.14 m, a hand with an arm above.
const std::string setup_text = R"(
map: {resolution: 0.01, max_range: 2.0}
camera: {width: 640, height: 480, fx: 600, fy: 600, cx: 319.5, cy: 239.5}
errors:
  camera: {focal: 0.003, aspect: 0.0005, center_px: 2, distortion_px: 0.5}
  boards: {scale: 0.002, size: 0.003, place: 0.0005, turn: 0.004}
boards:
  - name: base
    map_from_board: [0, 0, 0.001, 0, 0, 0]
    tags:
      - {id: 0, size: 0.10, pose_deg: [-0.05, 0.25, 0, 0, 0, -90]}
      - {id: 1, size: 0.10, pose_deg: [0.15, 0.25, 0, 0, 0, -90]}
      - {id: 2, size: 0.10, pose_deg: [-0.05, -0.25, 0, 0, 0, -90]}
      - {id: 3, size: 0.10, pose_deg: [0.15, -0.25, 0, 0, 0, -90]}
  - name: probe
    tags:
      - {id: 10, size: 0.045, pose_deg: [0, 0, 0.03, 0, 0, -90]}
      - {id: 11, size: 0.045, pose_deg: [-0.03, 0, 0, 90, 0, -90]}
      - {id: 12, size: 0.045, pose_deg: [0, -0.03, 0, 90, 0, 0]}
      - {id: 13, size: 0.045, pose_deg: [0.03, 0, 0, 90, 0, 90]}
      - {id: 14, size: 0.045, pose_deg: [0, 0.03, 0, 90, 0, 180]}
probe:
  board: probe
  ball_center: [0, 0, -0.14]
  ball_radius: 0.03
  hand: [{from: [0.04, 0, -0.06], to: [0.09, 0, -0.04], radius: 0.03}, {from: [0.09, 0, -0.04], to: [0.3, 0, 0.1], radius: 0.04}]
acceptance: {max_reprojection_px: 3, min_tags: 1, max_speed: 2}
hands: {margin: 0.02, latency: 0.02}
)";

/// Things on a table; a hand that leads the probe to and fro at about 0.4 m/s, a camera that is carried, and
/// a depth camera whose clock, place and ranges are wrong.
std::string scene_text(int seed) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  char text[600];
  std::string stroke;
  for (int i = 0; i <= 5; ++i) {
    std::snprintf(text, sizeof text, "    - {time: %.2f, ball: [%.4f, %.4f, %.4f]}\n", 0.35 * i,
                  0.05 + 0.04 * unit(random), (i % 2 == 0 ? -1 : 1) * (0.08 + 0.03 * unit(random)),
                  0.16 + 0.05 * unit(random));
    stroke += text;
  }
  std::snprintf(text, sizeof text,
                "errors: {clock_offset: %.4f, pose_shift: 0.0015, pose_turn: 0.002, mount_shift: 0.001, "
                "mount_turn: 0.001, depth_scale: %.4f}\n",
                0.018 * unit(random), 0.003 * unit(random));
  return "setup: setup.yaml\nseed: " + std::to_string(seed) + R"(
shapes:
  - {name: table, box: [1.2, 1.2, 0.02], pose: [0.05, 0, -0.01, 0, 0, 0], grey: 170}
  - {name: block, box: [0.08, 0.08, 0.06], pose: [0.05, 0, 0.03, 0, 0, 0.4], grey: 90}
  - {name: can, cylinder: [0.04, 0.12], pose: [0.25, 0.1, 0.06, 0, 0, 0], grey: 60}
camera:
  path:
    - {time: 0, look_at: {eye: [-0.5, 0.15, 0.75], target: [0.05, 0, 0.1]}}
    - {time: 3, look_at: {eye: [-0.5, -0.15, 0.75], target: [0.05, 0, 0.1]}}
  sway: {shift: 0.001, turn_deg: 0.1}
  rate_hz: 12
  noise_sigma: 1.5
  family: industrial
stroke:
  person: any
  orientation_deg: [0, -12, 20]
  waypoints:
)" + stroke +
         R"(hands:
  cover_share: 0.15
depth:
  intrinsics: {width: 160, height: 120, fx: 130, fy: 130, cx: 79.5, cy: 59.5}
  poses: [{look_at: {eye: [-0.45, 0.5, 0.6], target: [0.05, 0, 0.1]}}]
  unit: 0.0002
  interval: 0.13
  max_range: 2.0
  noise: {range_scale: 0.3}
  beside_pictures: true
  )" + text;
}

/// Every point of the scans, in its place.
struct AllPoints : FusionObserver {
  std::vector<std::pair<double, Eigen::Vector3d>> points;  ///< with the scan's time
  void see(const Sighting&) override {}
  void see(const Scan& scan) override {
    for (const Eigen::Vector3f& point : scan.points)
      points.emplace_back(scan.time, scan.map_from_sensor * point.cast<double>());
  }
};

double distance_to(const CapsuleSetup& capsule, const Eigen::Vector3d& point) {
  const Eigen::Vector3d way = capsule.to - capsule.from;
  const double squared = way.squaredNorm();
  const double along = squared > 0.0 ? std::clamp((point - capsule.from).dot(way) / squared, 0.0, 1.0) : 0.0;
  return (point - capsule.from - along * way).norm() - capsule.radius;
}

/// From the nearest thing that stands still.
double distance_to_things(const Scene& scene, const Eigen::Vector3d& point) {
  double nearest = HUGE_VAL;
  for (const SceneShape& shape : scene.shapes) {
    const Eigen::Vector3d p = shape.map_from_shape.inverse() * point;
    Eigen::Vector3d beyond;
    if (const auto* box = std::get_if<BoxShape>(&shape.geometry)) {
      beyond = p.cwiseAbs() - 0.5 * box->size;
    } else {
      const auto& can = std::get<CylinderShape>(shape.geometry);
      beyond = {p.head<2>().norm() - can.radius, std::abs(p.z()) - 0.5 * can.length, -1.0};
    }
    nearest = std::min(nearest, beyond.cwiseMax(0.0).norm() + std::min(0.0, beyond.maxCoeff()));
  }
  return nearest;
}

TEST(HeldBodies, OfAMovingHandHardlyAnyPointBecomesAnObstacle) {
  std::size_t on_hand = 0, obstacles = 0, on_things = 0, kept = 0, hidden = 0, scans = 0;
  for (int seed = 1; seed <= trials(1, 2); ++seed) {
    const TemporaryFolder folder;
    write_file(folder / "setup.yaml", setup_text);
    const Scene scene = parse_scene(scene_text(seed), "scene.yaml", folder / "");
    simulate(scene, folder / "r.rawlog");
    AllPoints all;
    const Fusion fusion = fuse(folder / "r.rawlog", {.observer = &all}, [](double) {});
    EXPECT_GT(fusion.counts.spheres, 10U) << seed;
    hidden += fusion.counts.scans_probe_hidden;
    scans += fusion.counts.scans;
    const Snapshot map = fusion.map.snapshot();
    for (const auto& [time, point] : all.points) {
      const double from_things = distance_to_things(scene, point);
      const VoxelState state = map.state(point);
      const bool is_obstacle = state == VoxelState::occupied || state == VoxelState::conflict;
      if (from_things > 0.05) {
        ++on_hand;
        obstacles += is_obstacle;
      } else if (from_things < 0.01) {
        ++on_things;
        kept += is_obstacle;
      }
    }
  }
  RecordProperty("points_on_hands", static_cast<int>(on_hand));
  RecordProperty("obstacles", static_cast<int>(obstacles));
  RecordProperty("scans", static_cast<int>(scans));
  RecordProperty("hidden", static_cast<int>(hidden));
  ASSERT_GT(on_hand, 4000U);
  EXPECT_LE(obstacles, on_hand / 1000) << "of " << on_hand;
  EXPECT_GT(kept, on_things * 9 / 10) << "of " << on_things;  // what stands still is an obstacle
  EXPECT_LT(hidden, scans / 2);
}

/// The probe swings by 0.1 m and turns to and fro, with at most 2 m/s^2 and 2 rad/s^2.
Eigen::Isometry3d map_from_probe_at(double time) {
  Eigen::Isometry3d pose(Eigen::Translation3d(0.1 * std::sin(4.0 * time), 0.08 * std::cos(3.0 * time), 0.3));
  pose.rotate(Eigen::AngleAxisd(0.3 * std::sin(2.0 * time), Eigen::Vector3d(1, 2, 1).normalized()));
  return pose;
}

/// What exact images at those times say of the boards.
void show_boards(BoardPoses& boards, const Setup& setup, const std::vector<double>& times) {
  for (const double time : times) {
    TrackedImage tracked;
    tracked.detections.resize(1);
    BodyPose base, probe;
    base.freedom = probe.freedom = 16;
    const Eigen::Isometry3d camera_from_map(Eigen::Translation3d(0.1, 0.2, 1.0));
    base.camera_from_body.pose = camera_from_map * *setup.board("base")->map_from_board;
    probe.camera_from_body.pose = camera_from_map * map_from_probe_at(time);
    tracked.sample.base = base;
    tracked.sample.probe = probe;
    ImageFrame image;
    image.intrinsics = *setup.camera;
    boards.take({time, "camera", image}, image, {}, &tracked);
  }
}

/// All that is held, as a capsule each, board frame.
std::vector<CapsuleSetup> parts_of(const Setup& setup) {
  std::vector<CapsuleSetup> parts = setup.probe->hand;
  parts.push_back({setup.probe->ball_center, Eigen::Vector3d::Zero(), setup.probe->ball_radius});
  for (const TagSetup& tag : setup.board("probe")->tags) {
    const Eigen::Vector3d center = tag.board_from_tag.translation();
    parts.push_back({center, center, 0.75 * std::sqrt(2.0) * tag.size});
  }
  return parts;
}

CapsuleSetup moved(const CapsuleSetup& part, const Eigen::Isometry3d& pose) {
  return {pose * part.from, pose * part.to, part.radius};
}

class TrackedHands : public ::testing::Test {
 protected:
  TrackedHands() : setup_(parse_setup(setup_text, "s.yaml")), boards_(setup_), held_(setup_, boards_, 0.01) {}

  const clearway::Setup setup_;
  BoardPoses boards_;
  HeldBodies held_;
};

constexpr double stated_acceleration = 3.0;

TEST_F(TrackedHands, FillAllThatTheyMayTrulyFillWithinLatencyAndMargin) {
  std::vector<double> times;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (double time = 10.0; time < 20.0; time += 0.05 + 0.2 * std::abs(unit(random))) times.push_back(time);
  show_boards(boards_, setup_, times);
  const std::vector<CapsuleSetup> parts = parts_of(setup_);
  for (int trial = 0; trial < 20000; ++trial) {
    const double time = 14.5 + 4.0 * unit(random);
    const double taken = time + setup_.hands.latency * unit(random);
    const CapsuleSetup part =
        moved(parts[static_cast<std::size_t>(trial) % parts.size()], map_from_probe_at(taken));
    const Eigen::Vector3d way(unit(random), unit(random), unit(random));
    const Eigen::Vector3d point = part.from + 0.5 * (1.0 + unit(random)) * (part.to - part.from) +
                                  (part.radius + 0.99 * *setup_.hands.margin) * way.normalized();
    const std::vector<Capsule> bodies = held_.bodies(time);
    EXPECT_TRUE(std::any_of(bodies.begin(), bodies.end(), [&](const Capsule& body) {
      return contains(body, point);
    })) << trial;
  }
}

TEST_F(TrackedHands, FillNothingBeyondTheStatedGrowth) {
  std::vector<double> times;
  for (double time = 10.0; time < 20.0; time += 0.1) times.push_back(time);
  show_boards(boards_, setup_, times);
  const std::vector<CapsuleSetup> parts = parts_of(setup_);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  // Twice an eighth of a gap's square: the true way and the straight one may each be so far off.
  const double growth = 1.125 * *setup_.hands.margin + 2.0 * stated_acceleration * 0.1 * 0.1 / 8.0;
  std::size_t filled = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const double time = 14.5 + 4.0 * unit(random);
    const std::vector<Capsule> bodies = held_.bodies(time);
    const Eigen::Vector3d middle = map_from_probe_at(time) * Eigen::Vector3d(0.05, 0, -0.02);
    const Eigen::Vector3d point = middle + 0.2 * Eigen::Vector3d(unit(random), unit(random), unit(random));
    if (std::none_of(bodies.begin(), bodies.end(),
                     [&](const Capsule& body) { return contains(body, point); }))
      continue;
    ++filled;
    double nearest = HUGE_VAL;
    for (int step = -20; step <= 20; ++step)
      for (const CapsuleSetup& part : parts)
        nearest = std::min(
            nearest,
            distance_to(moved(part, map_from_probe_at(time + step * setup_.hands.latency / 20.0)), point));
    EXPECT_LE(nearest, growth + 1e-4) << trial;
  }
  EXPECT_GT(filled, 200U);
}

TEST_F(TrackedHands, AreHiddenWhileNoImageSeesThemForAMomentAndUnseenFarFromAll) {
  using Visibility = HeldBodies::Visibility;
  EXPECT_EQ(held_.visibility(5.0), Visibility::unseen);
  show_boards(boards_, setup_, {10.0, 10.1, 10.2, 11.5, 11.6, 20.0, 20.1});
  EXPECT_EQ(held_.visibility(10.15), Visibility::seen);
  EXPECT_EQ(held_.visibility(10.3), Visibility::hidden);  // from 10.2 to 11.5 a hand was before the tags
  EXPECT_EQ(held_.visibility(11.4), Visibility::hidden);
  EXPECT_EQ(held_.visibility(11.8), Visibility::seen);  // for longer than a moment: where it was last
  EXPECT_EQ(held_.visibility(15.0), Visibility::unseen);
  EXPECT_EQ(held_.visibility(20.3), Visibility::hidden);  // it may be seen again
  EXPECT_FALSE(held_.is_settled(20.3));
  boards_.finish();
  EXPECT_TRUE(held_.is_settled(20.3));
  EXPECT_EQ(held_.visibility(20.3), Visibility::seen);
  EXPECT_EQ(held_.visibility(21.0), Visibility::unseen);
}

TEST(HeldBodies, AreNoneWithoutAProbe) {
  const clearway::Setup setup = parse_setup("map: {resolution: 0.01}", "s.yaml");
  const BoardPoses boards(setup);
  const HeldBodies held(setup, boards, 0.01);
  EXPECT_TRUE(held.is_settled(1.0));
  EXPECT_EQ(held.visibility(1.0), HeldBodies::Visibility::seen);
  EXPECT_TRUE(held.bodies(1.0).empty());
}

}  // namespace held_bodies_test
}  // namespace clearway
