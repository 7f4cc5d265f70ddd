#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace clearway {

/// Positions of joints over time, radians or metres, and in between: straight lines (let_wrap aside). Nothing
/// is guessed beyond the first and last reading, nor across a gap.
class JointStream {
 public:
  /// @param max_gap longest time between the two readings around an answer, seconds, > 0
  explicit JointStream(double max_gap = 0.5) : max_gap_(max_gap) {}

  /// A reading of some joints, in any order; a second one at the same time replaces the first.
  /// @throws std::invalid_argument for a number that is not finite, or not one position for each name.
  void add(double time, const std::vector<std::string>& names, const std::vector<double>& positions);

  /// Of a joint that may turn on and on, and whose readings are those of whole turns or wrap: between two
  /// readings it goes the shorter way round.
  void let_wrap(const std::string& name) { wrapping_.insert(name); }

  /// What a joint's speed changes by at most, rad/s² or m/s², > 0; of others 10.
  void let_accelerate(const std::string& name, double acceleration) { accelerations_[name] = acceleration; }

  /// The positions of these joints at `time`; empty when one of them is not known then.
  std::optional<std::vector<double>> at(const std::vector<std::string>& names, double time) const;

  /// How far each joint was from its place at `time`, at most, within `span` seconds before and after it, as
  /// far as readings go on without a gap. @pre at(names, time) has them
  std::vector<double> deviations(const std::vector<std::string>& names, double time, double span) const;

  /// How far each joint may have been from its straight lines, at most, within `span` seconds before and
  /// after `time`: a (t - t0) (t1 - t) / 2 between readings at t0 and t1. Where readings come as they usually
  /// do, a is twice the acceleration that those around show. Where more than one is missing, or there are no
  /// others around, it is at least what the joint can do. @pre at(names, time) has them
  std::vector<double> uncertainties(const std::vector<std::string>& names, double time, double span) const;

  /// Why `at` is empty, as a clause: the gap that is too wide, or that the readings begin later or end
  /// earlier.
  std::string why_unknown(const std::vector<std::string>& names, double time) const;

  std::vector<std::string> names() const;  ///< sorted
  /// A joint's readings: position by time. @pre it is one of names()
  const std::map<double, double>& readings(const std::string& name) const { return readings_.at(name); }
  /// Calls joints by other names: their own ones, by the new. One that had a new name before is forgotten,
  /// unless it has another one now. @pre the own names are some of names()
  void rename(const std::map<std::string, std::string>& own_names);
  /// Takes one of them out. @pre it is there, and not the only one
  void leave_out(const std::string& name, double time) { readings_.at(name).erase(time); }
  /// At which each of these joints was read itself, rising.
  std::vector<double> times(const std::vector<std::string>& names) const;
  bool empty() const { return readings_.empty(); }
  std::optional<double> last_time() const;

 private:
  using Readings = std::map<double, double>;  ///< of one joint
  std::optional<double> position_at(const std::string& name, double time) const;
  double way(const std::string& name, double from, double to) const;
  using Reading = Readings::const_iterator;
  std::optional<double> shown_acceleration(const std::string& name, Reading before, Reading after) const;
  double usual_spacing(const std::string& name, double time) const;
  double acceleration(const std::string& name, Reading before, Reading after, double usual) const;

  double max_gap_;
  std::map<std::string, Readings> readings_;
  std::set<std::string> wrapping_;
  std::map<std::string, double> accelerations_;  ///< by joint
};

/// A table: a first line "time, NAME, NAME, …", then numbers (seconds; radians or metres), apart by commas;
/// `#` starts a comment. @throws std::invalid_argument naming `name`, the line and what was expected.
JointStream parse_joint_states(const std::string& text, const std::string& name, double max_gap);

/// The same from a file of at most 256 MB. @throws std::invalid_argument also when it cannot be read.
JointStream load_joint_states(const std::filesystem::path& file, double max_gap);

}  // namespace clearway
