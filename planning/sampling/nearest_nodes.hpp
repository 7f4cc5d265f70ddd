#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "mapping/system/instruction_set.hpp"

namespace clearway {

/// Points of which the nearest is asked for: all are looked at, a register's width at a time. One answer, bit
/// for bit, on every instruction set.
class NearestNodes {
 public:
  /// Points have that many coordinates.
  explicit NearestNodes(std::size_t dimensions) : dimensions_(dimensions) {}

  void add(const Eigen::VectorXd& point);

  std::size_t size() const { return size_; }

  /// Which point, in the order of adding, is nearest by Euclidean distance; the earliest of equally near
  /// ones.
  /// @pre size() > 0
  std::size_t nearest(const Eigen::VectorXd& to) const;
  std::size_t nearest(const Eigen::VectorXd& to, InstructionSet vectors) const;

 private:
  /// A coordinate of each of eight points; infinite where there is no point.
  struct alignas(64) Eight {
    double at[8];
  };

  std::size_t dimensions_, size_ = 0;
  std::vector<Eight> rows_;  ///< for each eight points a row of each coordinate
};

}  // namespace clearway
