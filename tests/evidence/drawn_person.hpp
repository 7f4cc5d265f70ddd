#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace clearway::evidence {

/// A thing that stands on the table, upright.
struct Solid {
  bool is_box = true;
  Eigen::Vector3d size;  ///< edges; of a cylinder radius, radius, height
  Eigen::Vector3d center;
  double turn = 0.0;

  /// How deep a point lies inside; below 0 outside, there at most how far.
  double depth(const Eigen::Vector3d& point) const;
  std::string yaml(int number) const;
};

/// What a person at a drawn miniature kitchen does, written as a scene and as events: paints an arc, with a
/// pause or with the probe set down in the middle, shows the robot where to start and end, and asks for a
/// plan. Who is refused reads the sentence and, in the same session, does what it says: paints there, holds
/// the gripper deeper in the paint or farther from what it touches, leads the arc higher.
class DrawnPerson {
 public:
  explicit DrawnPerson(std::uint64_t seed);

  bool leads_through_an_obstacle() const { return is_mistaken_; }
  bool walks() const { return walks_; }
  bool sets_the_probe_down() const { return sets_down_; }
  const std::vector<Solid>& solids() const { return solids_; }

  std::string scene() const;
  std::string setup() const;
  std::string events() const;
  double last_attempt_begins() const { return attempt_begins_; }

  /// What an event of the last attempt was answered with: an `action` and the refusal or remark.
  struct Answer {
    std::string action, sentence;
  };
  /// Goes on after the last attempt was refused. @param answers in their order
  void try_again(const std::vector<Answer>& answers);

 private:
  struct Held {
    double share, out, up;  ///< of the arc; m beyond it, outwards and upwards
  };
  double uniform(double low, double high);
  Eigen::Vector3d ball(double share) const;
  void draw_solids();
  void begin();
  void lead_ball(double time, const Eigen::Vector3d& place);
  void paint_arc();
  void paint_spots(const std::vector<Eigen::Vector3d>& spots);
  void show_and_plan();
  void act(double time, const std::string& rest);
  Eigen::Vector3d clear_of_solids(Eigen::Vector3d place) const;

  std::uint64_t seed_;
  std::mt19937_64 random_;
  double first_ = 0.0, last_ = 0.0, low_ = 0.0, bump_ = 0.0, radius_ = 0.0;
  bool is_mistaken_ = false, walks_ = false, sets_down_ = false;
  std::string exposure_;
  std::vector<Solid> solids_;
  std::vector<Held> held_;
  double now_ = 0.0, attempt_begins_ = 0.0;
  int attempts_ = 0;
  std::string stroke_, gripper_;
  std::vector<std::pair<double, std::string>> events_;
};

}  // namespace clearway::evidence
