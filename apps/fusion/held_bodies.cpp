#include "apps/fusion/held_bodies.hpp"

#include <algorithm>
#include <cmath>

namespace clearway {
namespace {

constexpr double most_steps = 32;

void add_tags(const BoardSetup& board, std::vector<Capsule>& capsules) {
  for (const TagSetup& tag : board.tags) {
    const Eigen::Vector3d center = tag.board_from_tag.translation();
    capsules.push_back({center, center, 0.75 * std::sqrt(2.0) * tag.size});  // its corners, with their border
  }
}

void add_hand(const std::vector<CapsuleSetup>& hand, std::vector<Capsule>& capsules) {
  for (const CapsuleSetup& part : hand) capsules.push_back({part.from, part.to, part.radius});
}

double largest_tag(const BoardSetup& board) {
  double size = 0.0;
  for (const TagSetup& tag : board.tags) size = std::max(size, tag.size);
  return size;
}

/// None where nothing moves; else an even number, each at most a quarter of the margin long where that many
/// are enough.
int steps_along(double length, double margin) {
  if (!(length > 0.0)) return 0;
  const double wanted = 4.0 * length / std::max(margin, 1e-6);
  return 2 * static_cast<int>(std::ceil(0.5 * std::clamp(wanted, 2.0, most_steps)));
}

}  // namespace

HeldBodies::HeldBodies(const Setup& setup, const BoardPoses& boards, double resolution)
    : options_(setup.hands), margin_(setup.hands.margin.value_or(2.0 * resolution)), boards_(boards) {
  if (setup.probe) {
    Held probe{setup.probe->board,
               {{setup.probe->ball_center, Eigen::Vector3d::Zero(), setup.probe->ball_radius}},
               true};
    add_tags(*setup.board(probe.board), probe.capsules);
    add_hand(setup.probe->hand, probe.capsules);
    held_.push_back(std::move(probe));
  }
  if (setup.gripper) {
    const BoardSetup& board = *setup.board(setup.gripper->board);
    const Eigen::Vector3d tip = setup.gripper->board_from_tip.translation();
    Held gripper{board.name, {{tip, Eigen::Vector3d::Zero(), 0.5 * largest_tag(board)}}, false};
    add_tags(board, gripper.capsules);
    add_hand(setup.gripper->hand, gripper.capsules);
    held_.push_back(std::move(gripper));
  }
}

HeldBodies::Visibility HeldBodies::visibility(const Held& held, double time) const {
  if (boards_.at(held.board, time)) return Visibility::seen;
  const auto [before, after] = boards_.around(held.board, time);
  const bool is_settled = boards_.is_settled(held.board, time, options_.hidden);
  const bool was_near = before && time - *before <= options_.hidden;
  if (was_near && (after ? *after - *before <= options_.hidden : !is_settled)) return Visibility::hidden;
  return boards_.nearest(held.board, time) ? Visibility::seen : Visibility::unseen;
}

HeldBodies::Visibility HeldBodies::visibility(double time) const {
  Visibility worst = Visibility::seen;
  for (const Held& held : held_) {
    const Visibility own = visibility(held, time);
    if (own == Visibility::hidden) return own;
    if (own == Visibility::unseen && held.is_probe) worst = own;
  }
  return worst;
}

bool HeldBodies::is_settled(double time) const {
  return std::all_of(held_.begin(), held_.end(), [&](const Held& held) {
    const auto before = boards_.around(held.board, time).before;
    const bool may_be_hidden = before && time - *before <= options_.hidden;
    return boards_.is_settled(held.board, time + options_.latency, may_be_hidden ? options_.hidden : 0.0);
  });
}

/// Between two images where they show both ends, else where the nearest one saw it.
std::optional<HeldBodies::Place> HeldBodies::place(const Held& held, double time) const {
  if (const auto between = boards_.at(held.board, time)) {
    const auto [before, after] = boards_.around(held.board, time);
    return Place{*between, 0.5 * options_.acceleration * (time - *before) * (*after - time)};
  }
  if (const auto nearest = boards_.nearest(held.board, time)) return Place{*nearest, 0.0};
  return std::nullopt;
}

/// A capsule in steps along its way, each grown by half the way to the next; a ball's way is itself a
/// capsule.
void HeldBodies::add(const Held& held, double time, std::vector<Capsule>& bodies) const {
  const auto first = place(held, time - options_.latency), middle = place(held, time),
             last = place(held, time + options_.latency);
  if (!middle) return;
  for (const Capsule& capsule : held.capsules) {
    const auto moved = [&](const Place& place) {
      return Capsule{place.map_from_board * capsule.a, place.map_from_board * capsule.b,
                     capsule.radius + margin_ + place.growth};
    };
    const auto way = [](const Capsule& from, const Capsule& to) {
      return std::max((from.a - to.a).norm(), (from.b - to.b).norm());
    };
    const Capsule now = moved(*middle);
    const double length = (first ? way(moved(*first), now) : 0.0) + (last ? way(now, moved(*last)) : 0.0);
    const int steps = steps_along(length, margin_);
    std::optional<Capsule> previous;
    for (int step = 0; step <= steps; ++step) {
      const double share = steps == 0 ? 0.0 : 2.0 * step / steps - 1.0;
      const auto there = place(held, time + share * options_.latency);
      if (!there) continue;
      Capsule body = moved(*there);
      const Capsule own = body;
      if (previous) {
        const double half = 0.5 * way(*previous, own);
        bodies.back().radius = std::max(bodies.back().radius, previous->radius + half);
        body.radius += half;
      }
      bodies.push_back(body);
      previous = own;
    }
  }
}

std::vector<Capsule> HeldBodies::bodies(double time) const {
  std::vector<Capsule> bodies;
  for (const Held& held : held_) add(held, time, bodies);
  return bodies;
}

}  // namespace clearway
