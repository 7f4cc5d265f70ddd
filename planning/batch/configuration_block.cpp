#include "planning/batch/configuration_block.hpp"

#include <algorithm>
#include <bit>
#include <functional>

namespace clearway {
namespace {

/// Levels of nodes in a tree.
std::size_t depth_of(const SphereTree& tree, int node) {
  const SphereTree::Node& here = tree.nodes[static_cast<std::size_t>(node)];
  std::size_t below = 0;
  for (int i = here.first; i < here.last && !here.holds_leaves; ++i)
    below = std::max(below, depth_of(tree, i));
  return below + 1;
}

/// Packs that looks into two trees at once need: each step goes down in one of them.
std::size_t packs_for(const SphereRobot& robot) {
  std::size_t deepest = 0;
  for (const SphereRobot::Branch& branch : robot.branches)
    deepest = std::max(deepest, depth_of(robot.tree, branch.root));
  return 2 * deepest + 1;
}

}  // namespace

ConfigurationBlock::ConfigurationBlock(const SphereRobot& robot)
    : failed(robot.members, Places{}),
      packs(packs_for(robot)),
      doubts(1),
      joints_(robot.joints),
      frames_(robot.frames.size()),
      branches_(robot.branches.size()) {}

void ConfigurationBlock::add(const Configuration& configuration) {
  const std::size_t row = count / lane_count, lane = count % lane_count;
  if (lane == 0) make_room(row + 1);
  for (std::size_t j = 0; j < joints_; ++j)
    q[row * joints_ + j].at[lane] = configuration[static_cast<Eigen::Index>(j)];
  ++count;
}

void ConfigurationBlock::make_room(std::size_t rows) {
  const auto grow = [rows](auto& numbers, std::size_t a_row) {
    if (numbers.size() < rows * a_row) numbers.resize(rows * a_row);
  };
  grow(q, joints_);
  grow(value, frames_);
  grow(pose, 12 * frames_);
  grow(middle, 3 * branches_);
}

void ConfigurationBlock::forget() {
  for (const int member : members) failed[static_cast<std::size_t>(member)] = {};
  members.clear();
  blocked = {};
}

void ConfigurationBlock::leave_out_blocked() {
  std::erase_if(members, [&](int member) {
    Places& of_member = failed[static_cast<std::size_t>(member)];
    std::transform(of_member.begin(), of_member.end(), blocked.begin(), of_member.begin(),
                   [](std::uint64_t fails, std::uint64_t is_blocked) { return fails & ~is_blocked; });
    return of_member == Places{};
  });
}

ConfigurationBlock::Places ConfigurationBlock::failing() const {
  Places places{};
  for (const int member : members) {
    const Places& of_member = failed[static_cast<std::size_t>(member)];
    std::transform(places.begin(), places.end(), of_member.begin(), places.begin(), std::bit_or<>());
  }
  return places;
}

std::size_t ConfigurationBlock::undecided() const {
  std::size_t count = 0;
  for (const std::uint64_t places : failing()) count += static_cast<std::size_t>(std::popcount(places));
  return count;
}

}  // namespace clearway
