#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "planning/constraint/control_step.hpp"

namespace clearway {

/// When a live loop stops trusting its map, and how it stops.
struct LiveOptions {
  using Duration = std::chrono::steady_clock::duration;
  /// A map whose frame was taken longer ago than this is too old to move by, > 0. What comes towards the
  /// robot at v has come max_age * v nearer than the map says, and the period's motion: the security distance
  /// has to hold that. It does not hold against voxels that no configuration brings a body to, such as those
  /// of the table below a turning base: they count from when they are within its reach.
  Duration max_age = std::chrono::milliseconds(200);
  /// By how much a braked step is shorter than the one before in the joint that moves most, weighted units:
  /// the deceleration times the period squared, > 0. Infinite: the robot stands at once.
  double brake = std::numeric_limits<double>::infinity();
};

/// Hands what a control loop needs of the newest map from the one thread that maps to the one that controls.
/// The mapping thread brings the space up to date, makes a ControlStep for it and runs it once where the
/// robot was last seen; the loop exchanges a pointer between two steps. It never waits, also not while the
/// mapping thread is stopped half way, and takes nothing apart: what it is done with it gives back, and the
/// mapping thread takes it apart with its next map. Fetching allocates and frees nothing; a step's lists may
/// grow a little where more is near than where the map was made ready. At most three maps live at a time: the
/// loop's, and two that are made, wait for it or were given back.
///
/// The loop goes on with the map it has and knows its age. Without a map, or with one older than max_age,
/// `step` brakes: along the last step, shorter and shorter, still within the constraints of the map it has.
/// It goes on by itself once a newer map has come.
class LiveControl {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Duration = LiveOptions::Duration;

  /// @throws std::invalid_argument unless max_age and brake are above 0.
  LiveControl(DamperOptions damper, const LiveOptions& options);
  /// Call it when both threads are done.
  ~LiveControl();
  LiveControl(const LiveControl&) = delete;
  LiveControl& operator=(const LiveControl&) = delete;

  // The mapping thread's own.

  /// Makes `space` the one that the loop gets next, in place of one that it has not fetched. What the loop
  /// has given back until then is taken apart. Returns the map's number, 1, 2, ...
  /// @param taken when the newest frame in it was taken.
  /// @throws std::invalid_argument, and changes nothing, when the damper does not fit the space's robot, or
  /// its joints are not named as those of the maps before.
  std::uint64_t publish(ConfigurationSpace space, Time taken);

  /// The two halves of it: what takes its time, and the hand-over.
  struct Map;
  /// Deletes a map that was prepared, wherever the type is known by name only.
  struct TakeApart {
    void operator()(Map* map) const;
  };
  using ReadyMap = std::unique_ptr<Map, TakeApart>;
  ReadyMap prepare(ConfigurationSpace space, Time taken);
  /// @pre of this object's `prepare` @throws std::invalid_argument for one that was handed on before
  std::uint64_t publish(ReadyMap map);

  /// Takes apart what was given back, without a new map, and remembers where the robot was. Returns how many.
  std::size_t collect();

  // The loop's own.

  /// Goes over to the newest map, if there is one that it does not have. @param q where the robot is
  /// @throws std::invalid_argument, and changes nothing, unless q is one finite value for each joint
  bool fetch(const Configuration& q);
  bool has_map() const { return current_ != nullptr; }
  std::uint64_t number() const;  ///< of its map; 0: none yet
  Duration age(Time now) const;  ///< since its newest frame was taken; Duration::max() without a map
  /// Older than max_age, or from the future: a clock is wrong.
  bool is_too_old(Time now) const;
  /// Space and step of its map, until the next fetch. @pre has_map()
  const ConfigurationSpace& space() const;
  ControlStep& control();

  /// fetch; control().look; then solve for `wanted`, or for what brakes.
  /// Weighted units, valid until the next call.
  /// @throws std::invalid_argument, and changes nothing, unless `q` and `wanted` are one finite value for
  /// each joint: where the robot is it must know. After a reading that was lost call it with the last one.
  const Eigen::VectorXd& step(const Configuration& q, const Eigen::VectorXd& wanted, Time now);
  /// The second half, for who has added constraints of its own to control() after look. Zero where nobody
  /// has looked since the last fetch.
  const Eigen::VectorXd& solve(const Eigen::VectorXd& wanted, Time now);
  /// Whether the last step was one that brakes.
  bool is_braking() const { return is_braking_; }

 private:
  void require(const Eigen::VectorXd& values, const char* name) const;

  DamperOptions damper_;
  LiveOptions options_;
  std::vector<std::string> joints_;  ///< the mapping thread's: names of those of all its maps
  Configuration expected_;           ///< the mapping thread's: where the loop last said that the robot is
  std::uint64_t published_ = 0;
  std::atomic<Map*> newest_ = nullptr;    ///< published and not fetched
  std::atomic<Map*> returned_ = nullptr;  ///< a list
  Map* current_ = nullptr;                ///< the loop's, like all that follows
  Eigen::VectorXd last_;                  ///< step, weighted units
  Eigen::VectorXd braked_;
  bool is_braking_ = false;
};

}  // namespace clearway
