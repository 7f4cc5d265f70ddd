#include "tests/worlds/tracked_session.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "planning/geometry/turn_between.hpp"

namespace clearway::scene {
namespace {

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed * 0x9e3779b97f4a7c15ULL + 1) {}
  double between(double low, double high) {
    return low + (high - low) * std::uniform_real_distribution<double>(0.0, 1.0)(random_);
  }
  int below(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }
  bool chance(double probability) { return between(0.0, 1.0) < probability; }
  double normal(double sigma) { return sigma * std::normal_distribution<double>()(random_); }
  Eigen::Vector3d normals(double sigma) {
    const double x = normal(sigma), y = normal(sigma), z = normal(sigma);
    return Eigen::Vector3d(x, y, z);
  }
  /// Of standard deviation `sigma`: Gaussian, even, or one of two values.
  double error(double sigma, int family) {
    if (family == 0) return normal(sigma);
    if (family == 1) return between(-1.7320508, 1.7320508) * sigma;
    return chance(0.5) ? sigma : -sigma;
  }
  /// Noise of a corner: Gaussian, Laplace, or Student's with 4 degrees of freedom; same standard deviation.
  double noise(double sigma, int family) {
    if (family == 0) return normal(sigma);
    if (family == 1)
      return std::exponential_distribution<double>(1.4142136 / sigma)(random_) * (chance(0.5) ? 1 : -1);
    return sigma * 0.70710678 * std::student_t_distribution<double>(4.0)(random_);
  }

 private:
  std::mt19937_64 random_;
};

Eigen::Isometry3d turned(const Eigen::Vector3d& turn, const Eigen::Vector3d& shift) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  if (turn.norm() > 0.0) pose.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  pose.translation() = shift;
  return pose;
}

/// Brown's model, written once more: pixel of a point of the camera frame.
Eigen::Vector2d seen_at(const Camera& c, const Eigen::Vector3d& point) {
  const double x = point.x() / point.z(), y = point.y() / point.z(), s = x * x + y * y;
  const auto& d = c.distortion;
  const double radial = 1 + d[0] * s + d[1] * s * s + d[4] * s * s * s;
  return {c.fx * (x * radial + 2 * d[2] * x * y + d[3] * (s + 2 * x * x)) + c.cx,
          c.fy * (y * radial + 2 * d[3] * x * y + d[2] * (s + 2 * y * y)) + c.cy};
}

Camera draw_camera(Dice& dice) {
  Camera camera;
  const bool large = dice.chance(0.4);
  camera.width = large ? 1280 : 640;
  camera.height = large ? 720 : 480;
  camera.fx = camera.width * dice.between(0.75, 1.4);
  camera.fy = camera.fx * dice.between(0.995, 1.005);
  camera.cx = 0.5 * camera.width + dice.normal(0.01 * camera.width);
  camera.cy = 0.5 * camera.height + dice.normal(0.01 * camera.width);
  if (dice.chance(0.6)) {
    const double k1 = dice.between(-0.2, 0.08);
    camera.distortion = {k1, -0.3 * k1, dice.normal(5e-4), dice.normal(5e-4), 0.0};
  }
  return camera;
}

/// What the camera really is. Distortion errs as coefficients do, `corner` pixels in the image's corner.
Camera spoil(const Camera& stated, double level, Dice& dice) {
  const int family = dice.below(3);
  const bool has_distortion = stated.distortion[0] != 0.0;
  Camera camera = stated;
  const double focal = dice.error(0.003 * level, family), aspect = dice.error(0.0005 * level, family);
  camera.fx *= 1 + focal + 0.5 * aspect;
  camera.fy *= 1 + focal - 0.5 * aspect;
  camera.cx += dice.error(2.0 * level, family);
  camera.cy += dice.error(2.0 * level, family);
  const double half = 0.5 * std::hypot(stated.width, stated.height), reach = half / stated.fx;
  const double corner = level * (has_distortion ? 0.5 : 0.01 * half) / half;  // relative to half the diagonal
  camera.distortion[0] += dice.error(corner, family) / (reach * reach);
  camera.distortion[1] += dice.error(corner, family) / std::pow(reach, 4.0);
  camera.distortion[2] += dice.error(corner, family) / (3.0 * reach);
  camera.distortion[3] += dice.error(corner, family) / (3.0 * reach);
  return camera;
}

TagBody draw_base(double reach, Dice& dice) {
  TagBody base{"base", {}};
  const int counts[] = {1, 2, 3, 4, 6};
  const int count = counts[dice.below(5)];
  const double size = reach * (count == 1 ? dice.between(0.12, 0.2) : dice.between(0.06, 0.12));
  const double pitch = size * dice.between(1.3, 2.2);
  for (int i = 0; i < count; ++i) {
    MountedTag tag{size, Eigen::Isometry3d::Identity()};
    tag.body_from_tag = turned({0, 0, dice.below(4) * M_PI_2},
                               {(i % 3 - 0.5 * (std::min(count, 3) - 1)) * pitch, -(i / 3) * pitch, 0.0});
    base.tags[i] = tag;
  }
  return base;
}

/// One tag, two at an angle, or a cube of five.
PaintingProbe draw_probe(double reach, Dice& dice) {
  PaintingProbe probe;
  probe.body.name = "probe";
  const int kind = dice.below(4);
  const double size = reach * dice.between(0.06, 0.11), half = size * dice.between(0.65, 0.9);
  const Eigen::Vector3d axes[5] = {{0, 0, 1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
  const int count = kind == 0 ? 1 : kind == 1 ? 2 : 5;
  for (int i = 0; i < count; ++i) {
    MountedTag tag{size, Eigen::Isometry3d::Identity()};
    tag.body_from_tag.linear() = turn_between(Eigen::Vector3d::UnitZ(), axes[i]).toRotationMatrix();
    tag.body_from_tag.translation() = half * axes[i];
    probe.body.tags[20 + i] = tag;
  }
  probe.ball_in_probe =
      Eigen::Vector3d(dice.normal(0.01 * reach), dice.normal(0.01 * reach), -reach * dice.between(0.08, 0.3));
  probe.ball_radius = reach * dice.between(0.04, 0.09);
  return probe;
}

TagBody spoil(const TagBody& stated, double level, Dice& dice) {
  const int family = dice.below(3);
  TagBody body = stated;
  const double scale = 1 + dice.error(0.002 * level, family);
  const auto errors = [&](double sigma) {
    const double x = dice.error(sigma, family), y = dice.error(sigma, family), z = dice.error(sigma, family);
    return Eigen::Vector3d(x, y, z);
  };
  for (auto& [id, tag] : body.tags) {
    tag.size *= scale * (1 + dice.error(0.003 * level, family));
    tag.body_from_tag.translation() = scale * tag.body_from_tag.translation() + errors(0.0005 * level);
    tag.body_from_tag.linear() =
        tag.body_from_tag.linear() * turned(errors(0.005 * level), {0, 0, 0}).linear();
  }
  if (body.tags.size() >= 4 && dice.chance(0.1)) {  // one has come loose
    MountedTag& tag = std::next(body.tags.begin(), dice.below(static_cast<int>(body.tags.size())))->second;
    tag.body_from_tag.translation() += dice.normals(0.1 * tag.size);
  }
  return body;
}

struct Corners {
  double noise = 0.0, growth = 0.0, blur = 0.0, outliers = 0.0, hidden = 0.0;
  int family = 0;
};

Corners draw_corners(double severity, Dice& dice) {
  Corners corners;
  corners.noise = severity * dice.between(0.05, 0.35);
  corners.family = dice.below(3);
  corners.growth = dice.normal(0.06 * severity);
  corners.blur = severity * dice.between(0.0, 0.15);
  corners.outliers = dice.chance(0.5) ? 0.0 : severity * dice.between(0.0, 0.02);
  corners.hidden = dice.chance(0.5) ? 0.0 : dice.between(0.0, 0.4);
  return corners;
}

/// A corner, an edge or all of a tag where they are not.
void displace(TagDetection& tag, Dice& dice) {
  const double angle = dice.between(0.0, 2.0 * M_PI);
  const Eigen::Vector2d shift = dice.between(1.0, 10.0) * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  const int kind = dice.below(3), first = dice.below(4);
  for (int i = 0; i < 4; ++i)
    if (kind == 2 || i == first || (kind == 1 && i == (first + 1) % 4)) tag.corners[i] += shift;
}

void see(const Camera& camera, const TagBody& body, const Eigen::Isometry3d& camera_from_body,
         const Corners& corners, const Eigen::Vector2d& blur, Dice& dice, std::vector<TagDetection>& seen) {
  for (const auto& [id, tag] : body.tags) {
    const Eigen::Isometry3d camera_from_tag = camera_from_body * tag.body_from_tag;
    const double facing = -camera_from_tag.linear().col(2).dot(camera_from_tag.translation().normalized());
    if (facing < 0.25 || dice.chance(corners.hidden)) continue;
    TagDetection detection{id, 0, 90.0, {}};
    const double h = 0.5 * tag.size;
    const Eigen::Vector3d points[4] = {{-h, h, 0}, {h, h, 0}, {h, -h, 0}, {-h, -h, 0}};
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    bool is_seen = true;
    for (int i = 0; i < 4; ++i) {
      const Eigen::Vector3d point = camera_from_tag * points[i];
      is_seen = is_seen && point.z() > 0.05;
      detection.corners[i] = seen_at(camera, point);
      is_seen = is_seen && camera.sees(detection.corners[i], 3.0);
      middle += 0.25 * detection.corners[i];
    }
    double side = 1e9;
    for (int i = 0; i < 4; ++i)
      side = std::min(side, (detection.corners[i] - detection.corners[(i + 1) % 4]).norm());
    if (!is_seen || side < 12.0) continue;
    for (Eigen::Vector2d& corner : detection.corners) {
      corner += corners.growth * 1.4142136 * (corner - middle).normalized() + blur;
      corner.x() += dice.noise(corners.noise, corners.family);
      corner.y() += dice.noise(corners.noise, corners.family);
    }
    if (dice.chance(corners.outliers)) displace(detection, dice);
    seen.push_back(detection);
  }
}

/// Looking along -z of a board that is tilted.
Eigen::Isometry3d before_camera(double distance, double tilt, double azimuth, double roll,
                                const Eigen::Vector2d& aside) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d axis(std::cos(azimuth), std::sin(azimuth), 0.0);
  pose.linear() = (Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(tilt, axis) *
                   Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()))
                      .toRotationMatrix();
  pose.translation() = distance * Eigen::Vector3d(aside.x(), aside.y(), 1.0);
  return pose;
}

/// The hand's way: sums of slow waves in place and turn.
struct Hand {
  Eigen::Isometry3d start;
  Eigen::Vector3d way, turn, rate, phase;

  Eigen::Isometry3d at(double time) const {
    const Eigen::Vector3d wave = (rate * time + phase).array().sin();
    Eigen::Isometry3d pose = turned({0, 0, 0}, wave.cwiseProduct(way)) * start;
    return pose * turned(wave.cwiseProduct(turn), {0, 0, 0});
  }
};

Hand draw_hand(double reach, const Camera& camera, Dice& dice) {
  const double span = 0.3 * camera.height / camera.fx;
  Hand hand;
  hand.start = before_camera(reach * dice.between(0.75, 1.0), dice.between(0.0, 1.0), dice.between(0.0, 6.3),
                             dice.between(0.0, 6.3), {dice.between(-span, span), dice.between(-span, span)});
  const double far = reach * dice.between(0.05, 0.15);
  hand.way = far * Eigen::Vector3d(dice.between(0.3, 1.0), dice.between(0.3, 1.0), dice.between(0.1, 0.6));
  hand.turn = dice.between(0.0, 0.25) * Eigen::Vector3d(1.0, 0.7, 0.5);
  const double speed = std::min(0.35 / far, dice.between(0.5, 2.0));
  hand.rate = speed * Eigen::Vector3d(1.0, 0.83, 0.61);
  hand.phase = Eigen::Vector3d(dice.between(0.0, 6.3), dice.between(0.0, 6.3), dice.between(0.0, 6.3));
  return hand;
}

}  // namespace

TrackedSession draw_session(std::uint64_t seed, int frames, double severity) {
  Dice dice(seed);
  TrackedSession session;
  session.camera = draw_camera(dice);
  const double reach = dice.between(0.4, 1.5);  // metres, from the camera to the board
  session.base = draw_base(reach, dice);
  session.probe = draw_probe(reach, dice);
  session.budget.robot = session.budget.modelling = 0.02 * session.probe.ball_radius;
  session.budget.tracking = dice.between(0.1, 0.25) * session.probe.ball_radius;
  const double level = severity * dice.between(1.0 / 3.0, 1.0);
  const Camera camera = spoil(session.camera, level, dice);
  const TagBody base = spoil(session.base, level, dice), probe = spoil(session.probe.body, level, dice);
  const Corners corners = draw_corners(severity, dice);
  const double span = 0.25 * camera.height / camera.fx;
  const Eigen::Isometry3d camera_from_base =
      before_camera(reach, dice.between(0.0, 1.1), dice.between(0.0, 6.3), dice.between(0.0, 6.3),
                    {dice.between(-span, span), dice.between(-span, span)});
  const Hand hand = draw_hand(reach, camera, dice);
  const double rate = dice.chance(0.5) ? 15.0 : 30.0;
  const auto ball = [&](double time) -> Eigen::Vector3d {
    return camera_from_base.inverse() * (hand.at(time) * session.probe.ball_in_probe);
  };
  for (int i = 0; i < frames; ++i) {
    TrackedFrame frame{i / rate, {}, ball(i / rate)};
    const Eigen::Isometry3d camera_from_probe = hand.at(frame.time);
    const Eigen::Vector2d motion = seen_at(camera, hand.at(frame.time + 0.001).translation()) -
                                   seen_at(camera, camera_from_probe.translation());
    const Eigen::Vector2d blur = motion.norm() > 0 ? Eigen::Vector2d(corners.blur * motion.normalized())
                                                   : Eigen::Vector2d(Eigen::Vector2d::Zero());
    see(camera, base, camera_from_base, corners, Eigen::Vector2d::Zero(), dice, frame.detections);
    see(camera, probe, camera_from_probe, corners, blur, dice, frame.detections);
    session.frames.push_back(frame);
    for (int k = 0; k < 10; ++k) session.true_way.push_back(ball((i + 0.1 * k) / rate));
  }
  session.what = "session " + std::to_string(seed) + ": " + std::to_string(base.tags.size()) +
                 " tags on the base, " + std::to_string(probe.tags.size()) + " on the probe, errors " +
                 std::to_string(level);
  return session;
}

}  // namespace clearway::scene
