#pragma once

// Not part of the installed library.

#include <optional>
#include <span>
#include <vector>

#include "planning/batch/piece_lanes.hpp"
#include "planning/robot/kinematics.hpp"

namespace clearway {

/// Looks at straight edges piece by piece, many pieces at once (PieceLanes): pieces that are not proved free
/// are cut further until it is not their length that prevents it. What is left is for exact shapes to decide.
/// An object for each thread and robot.
class EdgePieces {
 public:
  enum class Finding { free, blocked, open };
  /// The part [begin, end] of the edge, 0..1, and the members that are open there: first to last - 1 of
  /// open_members().
  struct Piece {
    double begin = 0.0, end = 1.0;
    int first = 0, last = 0;
  };

  explicit EdgePieces(const SphereRobot& robot) : robot_(&robot), lanes_(robot) {}

  /// Both ends are within the joints' limits.
  /// `free`: all is proved free, everywhere on the edge. `blocked`: somewhere on it some body surely touches
  /// something. `open`: open_pieces() says what is not decided.
  /// @param least_share a proved_share() below this may be reported as 0: what is blocked is then found
  /// sooner
  Finding examine(const Configuration& from, const Configuration& to, double least_share = 0.0);

  /// Whether the edge is proved free, sooner: this begins with fewer pieces and ends at the first that is
  /// stuck. Near what blocks, few edges are proved by one of examine() and this alone.
  bool is_free(const Configuration& from, const Configuration& to);

  /// So much of the edge, 0..1, was proved free from its start on before anything was cut further.
  double proved_share() const { return proved_share_; }
  const std::vector<Piece>& open_pieces() const { return open_; }
  const std::vector<int>& open_members() const { return members_; }

 private:
  struct Bounds {
    double motion, bend;  ///< metres
  };
  void begin(const Configuration& from, const Configuration& to, int pieces);
  std::size_t look_at_next(std::size_t next);
  void bound_bends();
  Bounds bounds_of(int frame, int above) const;
  bool is_touching(double least_share);
  double share_in_front() const;
  void place(std::span<const Piece> pieces);
  void ask(std::span<const Piece> pieces);
  void sort_out(std::span<const Piece> pieces);

  const SphereRobot* robot_;
  PieceLanes lanes_;
  const Configuration* from_ = nullptr;
  Eigen::VectorXd step_;
  LaneDoubles middle_, half_;  ///< of the pieces that are asked for, of the edge
  double proved_share_ = 0.0;
  std::vector<double> distance_;         ///< of each frame: |multiplier * step|
  std::vector<float> bend_, pair_bend_;  ///< of each frame, pair of frames: over half the edge, metres
  std::vector<float> approach_;          ///< of each pair of frames, over the whole edge, metres
  std::vector<Piece> queue_, open_;
  std::vector<Piece> asked_;  ///< of the queue
  std::vector<int> members_;
};

}  // namespace clearway
