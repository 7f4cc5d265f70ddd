#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "datasets/ros/message_bag.hpp"

namespace clearway {

/// Calls `take` with a bag's messages in the order of their stamps; those of one stamp in the bag's order. A
/// message that comes before its turn is held; where more bytes than `most_held` would be, those whose turn
/// is farthest are let go, and the bag is read once more for them.
/// @param topics as of MessageBag::visit @param stamped of these, the topics whose messages are taken
/// @param stamps s, finite, of their messages in the order in which `visit` gives them
void visit_by_stamp(MessageBag& bag, const std::vector<bool>& topics, const std::vector<bool>& stamped,
                    std::span<const double> stamps, std::size_t most_held,
                    const std::function<void(const BagMessage&)>& take);

}  // namespace clearway
